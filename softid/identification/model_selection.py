"""Which model the logs call for, decided on blocks of the logs that were not fitted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, UsageError
from softid.fitters.objective import SCOUT_EVALUATIONS, Objective
from softid.fitters.output_error import Optimum, draft_fit
from softid.fitters.problem import Problem
from softid.fitters.rest import REST_MIN_SAMPLES, REST_WINDOW_S
from softid.identification.preparation import adapted_model, named_model, require_channels
from softid.log import Log, LogSet
from softid.models import MODELS
from softid.models.base import Model
from softid.sentences import listed

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

N_BLOCKS = 48
"""Blocks per log: few enough to be longer than the memory of sensor noise, so many that every rise
and fall of the input lies partly in what is fitted. With 12 blocks the only fall of a 6 s recording
was left out whole, and the richest model lost for want of it."""

ONE_BLOCK_IN = 4
"""One block in four is left out at a time. The first of every four always stays in: a log's first
samples tell its initial state and nothing else does."""

MIN_SAMPLES = 120
"""Samples of all logs together, below which models are not compared: the blocks of a log then hold
two or three samples, and noise with a memory of as many reaches across."""

WORTH_MORE_PARAMETERS = 0.95
"""A model with more parameters is taken only if it lowers the held-out error below 95 %."""

MEAN_LENGTHS = (4, 16, 64)
"""Samples in the means by which a residual is tested for a smooth part, a factor of four apart, so
that a part that lasts from some samples to some dozens is seen by one of them."""

MIN_MEANS = 20
"""Means that a length needs: their variance is then known to √(2/20) = 32 %, and the share that it
gives at four samples to 0.1, as much as what is asked of it."""


@dataclass(frozen=True)
class ModelChoice:
    """The model chosen for a set of logs.

    Attributes
    ----------
    model
        The model, adapted to the logs.
    reason
        Why, in a sentence.
    held_out_rmse
        Label of a candidate → rms error of the first output on the held-out blocks, in its
        canonical unit.
    starts
        Start values for the fit of the model: parameter name → value.
    plainer
        Models with fewer parameters that predicted worse, or that predicted better than a preferred
        one by less than 5 %.
    richer
        Models with more parameters that predicted better by less than 5 %, or worse.
    """

    model: Model
    reason: str
    held_out_rmse: Mapping[str, float] = field(default_factory=dict)
    starts: tuple[Mapping[str, float], ...] = ()
    plainer: tuple[Model, ...] = ()
    richer: tuple[Model, ...] = ()


@dataclass(frozen=True, eq=False)
class _Draft:
    """A model fitted roughly, and its errors on the blocks left out of refits.

    They are those of the first output, one array per segment.
    """

    model: Model
    values: Mapping[str, float]
    errors: tuple[Array, ...]

    @property
    def rmse(self) -> float:
        joined = np.concatenate(self.errors)
        held = joined[np.isfinite(joined)]
        return float(np.sqrt(np.mean(held**2))) if held.size else float("inf")


_OTHERS = (
    "choose other --input and --output channels (input= and outputs= in Python), or name a --model "
    "with its options"
)
_SEVERAL = (
    "fit one --output at a time (outputs= in Python): several go together only where the geometry "
    "of a muscle links them, as an angle and a length, and --model muscle then needs its options"
)


def choose_model(
    logs: LogSet,
    *,
    inverted: bool = False,
    preferred: Sequence[Model | str] = (),
    moving: bool = False,
) -> ModelChoice:
    """Fit every model that takes these channels and keep the one that predicts best.

    Every log is cut into 48 blocks. Three times, every fourth block is left out, the draft of a
    model is refitted to the others, and its error on those left out is taken: that of the first
    output, for errors in radians and in millimetres cannot be compared. A model with more
    parameters must lower that error by 5 %, and is not even tried when what is left over is white.

    Parameters
    ----------
    logs
        Logs to be fitted.
    inverted
        Whether the output falls as the input rises.
    preferred
        Models or names that come first, whatever their number of parameters: the user described
        them.
    moving
        Whether static models are left out.

    Raises
    ------
    UsageError
        No model takes these channels, or a preferred one is none.
    IdentificationError
        No model could be fitted.
    """
    candidates, refused = _candidates(logs, inverted=inverted, preferred=preferred)
    if moving:
        candidates = [model for model in candidates if model.states]
    if not candidates:
        raise UsageError(
            f"no model explains {listed(logs.outputs)} from {logs.input} as it stands",
            value="; ".join(refused) or None,
            remedy=_SEVERAL if len(logs.outputs) > 1 else _OTHERS,
        )
    if len(candidates) == 1:
        only = candidates[0]
        return ModelChoice(
            only, "; ".join((f"{only.label}: the only model that takes these channels", *refused))
        )
    if sum(len(log) for log in logs) < MIN_SAMPLES:
        simplest = candidates[0]
        return ModelChoice(
            simplest, f"{simplest.label}: too few samples to compare models by held-out blocks"
        )
    return _best(candidates, refused, logs)


def _candidates(
    logs: LogSet, *, inverted: bool, preferred: Sequence[Model | str]
) -> tuple[list[Model], list[str]]:
    """Models that take the channels, preferred and simple ones first, and what hinders others."""
    usable: list[Model] = []
    refused: list[str] = []
    variants = [v for name in MODELS for v in MODELS[name]().variants(logs.input)]
    described = _models_of(preferred)
    for variant in (*described, *(v for v in variants if v not in described)):
        try:
            require_channels(variant, logs)
        except UsageError:
            continue
        try:
            usable.append(adapted_model(variant, logs, inverted=inverted))
        except UsageError as error:
            refused.append(f"{variant.label} was not tried: {error.what}")
    names = {model.name for model in described}
    usable.sort(key=lambda m: (m.name not in names, _terms(m)))
    return usable, refused


def _models_of(preferred: Sequence[Model | str]) -> list[Model]:
    if isinstance(preferred, (str, Model)):
        raise UsageError(
            "this is not a list of models",
            where="preferred",
            value=preferred if isinstance(preferred, str) else preferred.name,
            remedy="put it in square brackets",
        )
    return [named_model(given) for given in preferred]


def _best(candidates: Sequence[Model], refused: Sequence[str], logs: LogSet) -> ModelChoice:
    drafts: list[_Draft] = []
    untold = list(refused)
    best: _Draft | None = None
    for k, model in enumerate(candidates):
        if best is not None and is_unpredictable(best.errors):
            names = listed(m.label for m in candidates[k:])
            untold.append(f"what {best.model.label} leaves over is white, so {names} cannot gain")
            break
        try:
            draft = _draft(model, logs)
        except IdentificationError as error:
            untold.append(f"{model.label} was not tried: {error.what}")
            continue
        drafts.append(draft)
        if best is None or draft.rmse < WORTH_MORE_PARAMETERS * best.rmse:
            best = draft
    if best is None:
        raise IdentificationError(
            "no model could be fitted",
            where=", ".join(log.place for log in logs),
            value="; ".join(untold),
            remedy="name a --model (model= in Python), or record a log with more levels",
        )
    return ModelChoice(
        best.model,
        _reason(best, drafts, untold, logs),
        {draft.model.label: draft.rmse for draft in drafts},
        (best.values,),
        tuple(d.model for d in drafts if _terms(d.model) < _terms(best.model)),
        tuple(d.model for d in drafts if _terms(d.model) > _terms(best.model)),
    )


def _terms(model: Model) -> int:
    return len(model.parameters().free)


def _draft(model: Model, logs: LogSet) -> _Draft:
    """Fit to all samples roughly, then refit from there without every fourth block in turn."""
    problem = Problem(model, model.parameters(), logs.logs)
    guesses = model.guess(problem.plain_segments, logs.outputs[0])
    starts = [g.values_dict() for g in guesses] or [model.parameters().values_dict()]
    optimum = draft_fit(problem, starts)
    if not np.isfinite(optimum.cost):
        raise IdentificationError(
            optimum.status.value, remedy="choose another --model (model= in Python)"
        )
    values = dict(
        zip(problem.parameters.names, problem.theta(optimum.unknowns).tolist(), strict=True)
    )
    errors = tuple(np.full(segment.time_s.size, np.nan) for segment in problem.segments)
    for fold in range(ONE_BLOCK_IN - 1):
        held = [left_out(log, k + fold) for k, log in enumerate(logs)]
        _score(errors, held, problem, optimum)
    return _Draft(model, values, errors)


def left_out(log: Log, shift: int) -> BoolArray:
    """Every fourth block of a log, other blocks for another shift, never the first samples."""
    n = len(log)
    block = np.arange(n) * N_BLOCKS // n
    out: BoolArray = block % ONE_BLOCK_IN == 1 + shift % (ONE_BLOCK_IN - 1)
    head = int(np.searchsorted(log.time_s, log.time_s[0] + REST_WINDOW_S))
    out[: max(head, REST_MIN_SAMPLES)] = False
    return out


def _score(
    errors: Sequence[Array], held: Sequence[BoolArray], whole: Problem, draft: Optimum
) -> None:
    """Refit without the samples held out and enter measured − simulated of the first output."""
    training = Problem(
        whole.model,
        whole.parameters,
        [log.with_masked(out) for log, out in zip(whole.logs, held, strict=True)],
    )
    if training.size != whole.size:  # a start that is at rest in all samples but not in these
        return
    objective = Objective(training, draft.sigma)
    objective.set_prior(draft.unknowns, objective.solve(draft.unknowns, 1))
    found = objective.solve(draft.unknowns, SCOUT_EVALUATIONS)
    for block in whole.blocks(found.point, derivatives=False):
        if block.channel != whole.outputs[0]:
            continue
        used = whole.segments[block.segment].used[block.channel]
        fitted = training.segments[block.segment].used[block.channel]
        errors[block.segment][used & ~fitted] = block.residual[~fitted[used]]


def is_unpredictable(errors: Sequence[Array]) -> bool:
    """Whether no model could lower an error to 95 %, since what is left is white noise.

    Means over m samples of white noise have 1/m of its variance; a part that a better model could
    explain is smooth and keeps its variance. So (m·var(means)/var − 1)/(m − 1) estimates the share
    of the power that is smooth; white is what has less of it than 1 − 0.95² at every m.

    Parameters
    ----------
    errors
        One array per segment, shape (n,); NaN where there is no error.

    Examples
    --------
    >>> noise = np.random.default_rng(0).normal(size=2000)
    >>> is_unpredictable([noise]), is_unpredictable([np.convolve(noise, np.ones(9) / 9)])
    (True, False)
    """
    joined = np.concatenate(errors)
    held = joined[np.isfinite(joined)]
    power = float(np.mean(held**2)) if held.size else 0.0
    if power == 0.0:
        return held.size > 0
    tested = 0
    for length in MEAN_LENGTHS:
        means = np.concatenate([_means(e[np.isfinite(e)], length) for e in errors])
        if means.size < MIN_MEANS:
            break
        share = (length * float(np.mean(means**2)) / power - 1.0) / (length - 1.0)
        if share > 1.0 - WORTH_MORE_PARAMETERS**2:
            return False
        tested += 1
    return tested > 0


def _means(values: Array, length: int) -> Array:
    whole = values.size // length * length
    means: Array = values[:whole].reshape(-1, length).mean(axis=1)
    return means


def _reason(best: _Draft, drafts: Sequence[_Draft], untold: Sequence[str], logs: LogSet) -> str:
    channel = logs.logs[0].channels[logs.outputs[0]]

    def shown(draft: _Draft) -> str:
        return f"{draft.rmse * channel.display_factor:.3g} {channel.display_unit}"

    others = listed(f"{shown(d)} ({d.model.label})" for d in drafts if d is not best)
    told = f"{best.model.label}: error on blocks left out of the fit {shown(best)}"
    return "; ".join((f"{told}, against {others}" if others else told, *untold))
