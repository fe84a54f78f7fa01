"""Whether one model does for all logs: what they leave together, and each by itself.

A model whose parameters lie between those of several logs may leave little enough in each to look
like noise. The BIC of as many models as there are logs says whether they ask for their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.base.intersample_selection import independent_share
from softid.diagnosis.changes.changed_numbers import squares_of, standing_over
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.parts_of_logs import (
    REFIT_EVALUATIONS,
    refitted,
    white_standard_errors,
)
from softid.errors import IdentificationError, InputError
from softid.log import Log
from softid.parallel import in_parallel

Array = npt.NDArray[np.float64]

LEAST_FALL = 10.0
"""The BIC of models of their own must be so much lower, which speaks very strongly for them (Kass
and Raftery, J. Am. Stat. Assoc. 90, 1995)."""

LEAST_DIFFERENCE = 4.0
"""A parameter is told where its values are so many standard errors apart."""


@dataclass(frozen=True)
class OwnParameters:
    """That logs ask for parameters of their own.

    Attributes
    ----------
    together, apart
        Root mean square of the first output that one model leaves, and models of their own.
    name
        The parameter that differs most; empty where none differs clearly by itself.
    changes
        By which share its value differs from that in the first log, one for each of the others.
    """

    together: float
    apart: float
    name: str
    changes: tuple[float, ...]


def own_parameters(base: BaseFit) -> OwnParameters | None:
    """What logs ask for by themselves; None where one model does for all.

    Parameters
    ----------
    base
        The base fit.
    """
    logs, model = base.whole_logs, base.candidate
    if len(logs) < 2:
        return None

    def both(log: Log) -> tuple[float, Candidate | None]:
        pooled = squares_of(*standing_over((log,), model))
        try:
            return pooled, refitted(model, base.sigma, [log], REFIT_EVALUATIONS)
        except (IdentificationError, InputError):  # it is too short, or nothing moves in it
            return pooled, None

    found = in_parallel(both, logs)
    alone = [one for _, one in found if one is not None]
    if len(alone) < len(logs):
        return None
    n = sum(one.problem.n_samples for one in alone) / len(model.problem.outputs)
    together = sum(pooled for pooled, _ in found)
    apart = sum(squares_of(one.problem, one.minimum.point) for one in alone)
    if not 0.0 < apart < together:
        return None
    fall = n * float(np.log(together / apart)) * independent_share(model)
    cost = (len(logs) - 1) * len(model.problem.free) * float(np.log(n))
    if fall - cost <= LEAST_FALL:
        return None
    rms = (together / n) ** 0.5, (apart / n) ** 0.5
    return OwnParameters(*rms, *_most_different(alone))


def _most_different(alone: Sequence[Candidate]) -> tuple[str, tuple[float, ...]]:
    """The parameter whose values are the most standard errors apart, and its changes."""
    free = alone[0].problem.free
    z = np.array([one.minimum.point[: len(free)] for one in alone])
    errors = np.array([white_standard_errors(one)[: len(free)] for one in alone])
    pairs = [(a, b) for b in range(len(alone)) for a in range(b)]
    apart = [np.abs(z[a] - z[b]) / np.hypot(errors[a], errors[b]) for a, b in pairs]
    most = np.nan_to_num(np.max(apart, axis=0))
    name = free[int(most.argmax())]
    first, *others = (one.parameters[name] for one in alone)
    if not (most.max() > LEAST_DIFFERENCE and first):
        return "", ()
    return name, tuple(value / first - 1.0 for value in others)
