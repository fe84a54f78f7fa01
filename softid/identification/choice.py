"""Which model the logs call for, decided on contiguous blocks that were not fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from softid.errors import UsageError
from softid.fitters.output_error import output_error
from softid.fitters.problem import Problem
from softid.identification.preparation import adapted_model
from softid.log import Log, LogSet
from softid.models import MODELS
from softid.models.base import Model

N_BLOCKS = 12
HELD_OUT_EVERY = 4
MIN_SAMPLES = 120
WORTH_MORE_PARAMETERS = 0.95
"""A model with more parameters is taken only if it lowers the held-out error below 95 %."""


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
        Candidate name → rms error on the held-out blocks, canonical unit of the first output.
    """

    model: Model
    reason: str
    held_out_rmse: dict[str, float]


def choose_model(logs: LogSet, *, rng: np.random.Generator) -> ModelChoice:
    """Fit every model that takes these channels and keep the one that predicts best.

    Every log is cut into twelve contiguous blocks; every fourth is left out of the residuals and
    scores the fit. A model with more parameters must lower the held-out error by 5 %.

    Parameters
    ----------
    logs
        Logs to be fitted.
    rng
        Draws the restarts.

    Raises
    ------
    UsageError
        No model takes these channels.
    """
    candidates = _candidates(logs)
    if not candidates:
        raise UsageError(
            f"no model explains {', '.join(logs.outputs)} from {logs.input}",
            remedy="choose other --input and --output channels",
        )
    if len(candidates) == 1:
        only = candidates[0]
        return ModelChoice(only, f"{only.name}: the only model that takes these channels", {})
    if sum(len(log) for log in logs) < MIN_SAMPLES:
        simplest = candidates[0]
        return ModelChoice(
            simplest, f"{simplest.name}: too few samples to compare models by held-out blocks", {}
        )
    training = tuple(log.with_masked(_held_out(len(log))) for log in logs)
    errors = {m.name: _held_out_error(m, training, logs.logs, rng) for m in candidates}
    best = candidates[0]
    for model in candidates[1:]:
        if errors[model.name] < WORTH_MORE_PARAMETERS * errors[best.name]:
            best = model
    return ModelChoice(best, _reason(best, candidates, errors, logs), errors)


def _candidates(logs: LogSet) -> list[Model]:
    """Models that take the channels, fewest free parameters first."""
    usable = []
    for name in MODELS:
        try:
            usable.append(adapted_model(name, logs))
        except UsageError:
            continue
    return sorted(usable, key=lambda m: len(m.parameters().free))


def _held_out(n: int) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    block = np.arange(n) * N_BLOCKS // n
    return block % HELD_OUT_EVERY == HELD_OUT_EVERY - 2


def _held_out_error(
    model: Model, training: Sequence[Log], logs: Sequence[Log], rng: np.random.Generator
) -> float:
    problem = Problem(model, model.parameters(), training)
    guesses = model.guess(problem.segments, problem.outputs[0])
    starts = [g.values_dict() for g in guesses] or [model.parameters().values_dict()]
    optimum = output_error(problem, starts, rng=rng, rounds=0)
    if not np.isfinite(optimum.cost):
        return float("inf")
    whole = Problem(model, model.parameters(), logs)
    if whole.size != problem.size:
        return float("inf")
    squares, count = 0.0, 0
    for block in whole.blocks(optimum.unknowns, derivatives=False):
        if block.channel != problem.outputs[0]:
            continue
        everywhere = whole.segments[block.segment].used[block.channel]
        held = ~problem.segments[block.segment].used[block.channel][everywhere]
        squares += float(np.sum(block.residual[held] ** 2))
        count += int(held.sum())
    return float(np.sqrt(squares / count)) if count else float("inf")


def _reason(
    best: Model, candidates: Sequence[Model], errors: dict[str, float], logs: LogSet
) -> str:
    channel = logs.logs[0].channels[logs.outputs[0]]

    def shown(model: Model) -> str:
        return f"{errors[model.name] * channel.display_factor:.3g} {channel.display_unit}"

    others = " and ".join(f"{shown(m)} ({m.name})" for m in candidates if m.name != best.name)
    return f"{best.name}: error on blocks left out of the fit {shown(best)}, against {others}"
