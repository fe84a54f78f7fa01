"""The fit of the model that is to be extended, what is held out, and the sizes of the motion."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from softid.diagnosis.refit.candidates import Candidate, advance, prior_about
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.held_out import HeldOut, HeldOutBlocks, HeldOutLogs, hold_out_blocks
from softid.effects.scale import Scale
from softid.errors import IdentificationError, InputError, UsageError
from softid.excitation import second_difference_noise, segment_excitation
from softid.fitters.levenberg_marquardt import Minimum, NormalEquations
from softid.fitters.problem import Problem
from softid.identification.gauge_errors import GaugeErrors
from softid.identification.preparation import named_model
from softid.identification.workflow import Identification, identify
from softid.log import Log, LogSet
from softid.models import MODELS
from softid.models.base import Model
from softid.parameters import ParameterSet

if TYPE_CHECKING:
    import lmfit

Progress = Callable[[str, float], None]

RESTORING_ROUND = 15
"""Evaluations from where a fit without a term ended to the optimum with it."""

FEWEST_SAMPLES = 100
"""With fewer, seven terms of a base and an effect explain most of any noise, and a block to hold
out has next to none."""

LEAST_MOVE = 0.05
"""Held-out logs judge when their input moves by this share of what the fitted ones' does."""

CLEARLY = 20.0
"""An input that ranges over so many standard deviations of its noise moves: noise ranges over ten
in millions of samples."""

NEGLIGIBLE = 3e-4
"""Share of the output's range below which a misfit is none: steps of the integrator, and what the
input does between its samples, leave as much of a log without any noise."""

HIDDEN_PERIODS = 0.1
"""A restored term dies out within a tenth of the sampling interval."""


def require_enough(logs: LogSet, hold_out: Sequence[Log] = ()) -> None:
    """Refuse logs that are too short to tell a cause from noise, or to judge one.

    Parameters
    ----------
    logs
        Logs to explain.
    hold_out
        Logs that judge.

    Raises
    ------
    IdentificationError
        All outputs of either together have fewer than `FEWEST_SAMPLES`.
    """
    if _usable(logs) < FEWEST_SAMPLES:
        raise IdentificationError(
            "there are too few samples of the output to tell a cause from noise",
            where=", ".join(log.name for log in logs),
            value=_usable(logs),
            remedy=f"record {FEWEST_SAMPLES} or more, or use softid fit",
        )
    if hold_out and _usable(hold_out) < FEWEST_SAMPLES:
        raise IdentificationError(
            "there are too few samples of the output to judge a cause by",
            where=", ".join(log.name for log in hold_out),
            value=_usable(hold_out),
            remedy=f"hold out {FEWEST_SAMPLES} or more, or none: then blocks of the logs judge",
        )


def require_moving(logs: LogSet, hold_out: Sequence[Log]) -> None:
    """Refuse to judge by logs at rest, which say nothing of what acts on a motion.

    Parameters
    ----------
    logs
        Logs to explain.
    hold_out
        Logs that judge.

    Raises
    ------
    IdentificationError
        The input of none that is held out moves.
    """
    moves = max((_move(log) for log in hold_out), default=np.inf)
    fitted = max(_move(log) for log in logs)
    if moves < LEAST_MOVE * fitted:
        unit = logs.input_unit
        raise IdentificationError(
            "the input of what is held out hardly moves, so it cannot judge a cause",
            where=", ".join(log.name for log in hold_out),
            value=f"a range of {moves:.3g} {unit}, and of {fitted:.3g} {unit} in what is fitted",
            remedy="check that its unit is the right one, and hold out a log that moves, or none: "
            "then blocks of the logs judge",
        )


def require_driven(logs: LogSet) -> None:
    """Refuse logs in which nothing drives the actuator.

    Parameters
    ----------
    logs
        Logs to explain, as they were recorded.

    Raises
    ------
    InputError
        The input of none moves beyond its noise.
    """
    if not any(_is_driven(log) for log in logs):
        first = logs.logs[0]
        raise InputError(
            "the input does not move beyond its noise, so nothing can be told of what acts on it",
            where=", ".join(log.name for log in logs),
            value=f"a range of {_move(first):.3g} {first.channels[first.input].unit}",
            remedy="record a log in which it moves, or choose another --input",
        )


def _is_driven(log: Log) -> bool:
    """Whether a log's input moves beyond its noise."""
    return any(
        np.ptp(segment.input) > CLEARLY * second_difference_noise(segment.input)
        or any(s.kind != "rest" for s in segment_excitation(segment.time_s, segment.input))
        for segment in log.segments()
    )


def _move(log: Log) -> float:
    """Range of a log's input, over all its segments: one may hold a single level each."""
    inputs = [segment.input for segment in log.segments()]
    return float(np.ptp(np.concatenate(inputs))) if inputs else 0.0


def _usable(logs: Iterable[Log]) -> int:
    """Samples of all outputs that count."""
    return sum(
        int(np.count_nonzero(used))
        for log in logs
        for segment in log.segments()
        for used in segment.used.values()
    )


@dataclass(frozen=True, eq=False)
class BaseFit:
    """The fit of the base model, and what is judged by it.

    Attributes
    ----------
    identified
        The fit as `softid.fit` makes it.
    candidate
        The same as the candidate without effects.
    scale
        Sizes of its motion.
    held_out
        What is held out.
    instead_of
        The fit of the model that was asked for, where this one takes its place.
    gauges
        Log → errors of the input that was recorded.
    is_intersample_open
        Whether nobody said what the input does between its samples.
    """

    identified: Identification
    candidate: Candidate
    scale: Scale
    held_out: HeldOut
    instead_of: BaseFit | None = None
    gauges: Mapping[str, GaugeErrors] = field(default_factory=dict)
    is_intersample_open: bool = False

    def judged_by(self, logs: Sequence[Log]) -> BaseFit:
        """The same fit with other held-out logs, such as those with another intersample behaviour.

        Parameters
        ----------
        logs
            The held-out logs.
        """
        identified = replace(self.identified, hold_out=tuple(logs))
        held_out = HeldOutLogs(identified.hold_out, self.gauges, self.is_intersample_open)
        return replace(self, identified=identified, held_out=held_out)

    @property
    def asked_for(self) -> BaseFit:
        """The fit that a user compares with."""
        return self.instead_of or self

    @property
    def whole_logs(self) -> tuple[Log, ...]:
        """The fitted logs, with the blocks that are held out of them."""
        logs = self.candidate.problem.logs
        return self.held_out.put_back(logs) if isinstance(self.held_out, HeldOutBlocks) else logs

    @property
    def judges(self) -> tuple[Log, ...]:
        """The logs that are held out; none where blocks of the fitted ones are."""
        return self.held_out.logs if isinstance(self.held_out, HeldOutLogs) else ()

    @property
    def is_negligible(self) -> bool:
        """Whether the misfit of the first output is too small to be looked into."""
        return self.rms < NEGLIGIBLE * self.scale.y_span

    @property
    def rms(self) -> float:
        """Root mean square misfit of the fitted logs, in the first output's unit."""
        problem = self.candidate.problem
        per_sample = self.candidate.squares / max(problem.n_samples, 1)
        return self.sigma[problem.outputs[0]] * float(np.sqrt(per_sample))

    @property
    def sigma(self) -> dict[str, float]:
        """Output channel → scale that its residual is divided by.

        The span of a single output; of several, the standard deviation of each one's residual.
        """
        return dict(self.identified.found.optimum.sigma)


@dataclass(frozen=True)
class Recordings:
    """Logs to explain and logs that judge.

    Attributes
    ----------
    logs, hold_out
        As in `diagnose`.
    """

    logs: LogSet
    hold_out: tuple[Log, ...]

    def each(self, change: Callable[[Log], Log]) -> Recordings:
        """Fitted and held-out logs, each with the change; the same object where none differs."""
        logs, hold_out = [change(log) for log in self.logs], [change(log) for log in self.hold_out]
        pairs = zip((*self.logs, *self.hold_out), (*logs, *hold_out), strict=True)
        if all(before is after for before, after in pairs):
            return self
        return Recordings(LogSet(tuple(logs)), tuple(hold_out))


@dataclass(frozen=True)
class Request:
    """What the user asked for.

    Attributes
    ----------
    model, parameters, seed, progress
        As in `diagnose`.
    instead_of
        The fit of the model that the user asked for, where ``model`` is another.
    preferred
        As in `diagnose`.
    gauges, is_intersample_open
        As in `BaseFit`.
    """

    model: Model | str | None
    parameters: ParameterSet | lmfit.Parameters | None
    seed: int
    progress: Progress
    instead_of: BaseFit | None = None
    preferred: Sequence[Model | str] = ()
    gauges: Mapping[str, GaugeErrors] = field(default_factory=dict)
    is_intersample_open: bool = False

    def fit_base(self, logs: LogSet, hold_out: Sequence[Log], *, thorough: bool) -> BaseFit:
        """Fit the base.

        Parameters
        ----------
        logs
            Logs to explain; blocks of them are held out when no log is.
        hold_out
            Logs that judge.
        thorough
            As in `identify`.

        Raises
        ------
        UsageError
            The model is static.
        """
        _require_motion(self.model)
        trained, held = (logs, None) if hold_out else hold_out_blocks(logs)
        identified = identify(
            trained.logs,
            model=self.model,
            hold_out=hold_out,
            parameters=self.parameters,
            preferred=self.preferred,
            seed=self.seed,
            thorough=thorough,
            moving=True,
            progress=self.progress,
        )
        candidate = _candidate(identified, self.model)
        scale = scale_of(candidate.problem, candidate.minimum.point)
        is_open = self.is_intersample_open
        held_out = held or HeldOutLogs(identified.hold_out, self.gauges, is_open)
        return BaseFit(
            identified,
            candidate,
            scale,
            held_out,
            self.instead_of,
            self.gauges,
            is_open,
        )


def _require_motion(model: Model | str | None) -> None:
    if model is None or named_model(model).states:
        return
    raise UsageError(
        "a static model has no motion that an effect could act on",
        value=named_model(model).name,
        remedy="choose a model with one, such as muscle or oscillator",
    )


def _candidate(identified: Identification, asked: Model | str | None) -> Candidate:
    """The fit as the candidate without effects, with every term that its limit had dropped.

    A term that cannot be seen behind a misfit may be seen once its cause is in the model: without
    it another effect would take its place. What the user asked to drop stays dropped.
    """
    optimum = identified.found.optimum
    problem, z = _whole_problem(identified, asked), optimum.unknowns
    if problem is not identified.found.problem:
        z = problem.unknowns(_whole_values(identified, problem))
    size = problem.size
    empty = NormalEquations(z, optimum.cost, np.zeros(size), np.eye(size), problem.n_samples)
    variance = 2.0 * optimum.cost / max(problem.n_samples - size, 1)
    prior = prior_about(problem, z, problem.free, variance)
    candidate = Candidate((), problem, Minimum(z, empty, 0, 0.0), prior)
    return advance(
        candidate, dict(optimum.sigma), RESTORING_ROUND if z is not optimum.unknowns else 1
    )


def _whole_problem(identified: Identification, asked: Model | str | None) -> Problem:
    """The problem of the model of full order, or of the order that was asked for."""
    problem = identified.found.problem
    options = dict(problem.model.spec().options)
    wanted = asked.spec().options if isinstance(asked, Model) else {}
    order = wanted.get("order", "second")
    if options.get("order", order) == order:
        return problem
    whole: Model = MODELS[problem.model.name](**(options | {"order": order}))
    return Problem(
        whole, identified.found.constraints.over(whole.parameters()), identified.logs.logs
    )


def _whole_values(identified: Identification, problem: Problem) -> dict[str, float]:
    """Fitted values, with a restored term as large as it may be without being seen."""
    fitted = identified.found.problem
    theta = fitted.theta(identified.found.optimum.unknowns)
    values = fitted.values(identified.found.optimum.unknowns)
    law = fitted.model.motion_law(theta)
    if law is None:
        return values
    u = np.concatenate([segment.input for segment in problem.segments])
    damping, stiffness, _ = (float(np.median(c)) for c in law.coefficients(u))
    hidden_s = HIDDEN_PERIODS * float(np.median([log.period_s for log in identified.logs]))
    slow = damping if damping > 0.0 else hidden_s * stiffness
    hidden = problem.model.hidden_terms(slow, hidden_s)
    for name in problem.free:
        if values.get(name, 0.0) == 0.0 and name in hidden:
            values[name] = hidden[name]
    return values
