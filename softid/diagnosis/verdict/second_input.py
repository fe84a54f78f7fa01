"""Whether a misfit goes with another channel, which drives the actuator beside the input."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.residual.motion import mean_square, residual_context
from softid.diagnosis.residual.structure import predicted_beyond_chance
from softid.diagnosis_results import Diagnosis
from softid.even_times import even_interval_s
from softid.log import Log
from softid.quality.second_inputs import independent_inputs

Array = npt.NDArray[np.float64]

LAG_TIMES = (0.0, 0.3, 1.0, 3.0)
"""Time constants of the lags behind which the other channel is looked for, in units of the
motion's."""

LEAST_SHARE = 0.1
"""A channel of which less of the misfit follows is not told."""

AS_MUCH = 0.5
"""Causes are no more than descriptions where a linear function of the channel alone accounts for so
much of what they explain: a law of the motion would account for more. A judgement."""


def second_inputs(
    answer: Diagnosis, base: BaseFit, recorded: Sequence[Log], seed: int
) -> dict[str, float]:
    """Channels that may be all that is missing, and the share of the misfit that follows each.

    There are none where causes account for more than a linear function of them does.

    Parameters
    ----------
    answer
        The diagnosis.
    base
        The base fit that it extends.
    recorded
        The logs as they came, with all of their channels.
    seed
        Of the draws of what chance does.
    """
    names = list(dict.fromkeys(n for log in recorded for n in independent_inputs(log)))
    shares = {n: _share_of(n, base, recorded, seed) for n in names}
    told = {n: s for n, s in shares.items() if s >= LEAST_SHARE}
    if told and answer.causes and max(told.values()) < AS_MUCH * _explained(answer, base):
        return {}
    return told


def _share_of(name: str, base: BaseFit, recorded: Sequence[Log], seed: int) -> float:
    """Share of the base's residual that follows from a channel through lags; 0 if chance does."""
    whole = {log.name: log for log in recorded if name in log.channels}
    candidate, columns, residuals, times = base.candidate, [], [], []
    owners = [candidate.problem.logs[k].name for k in candidate.problem.owner]
    for part, owner in zip(residual_context(candidate), owners, strict=True):
        used = np.isfinite(part.residual)
        if not used.any() or owner not in whole:
            continue
        other = _lagged(whole[owner], name, part.time_s, base.scale.motion_s)
        columns.append(other[used])
        residuals.append(part.residual[used])
        times.append(part.time_s[used])
    if not times:
        return 0.0
    rows = np.concatenate(residuals)
    share, limit = predicted_beyond_chance(
        np.concatenate(columns), rows - rows.mean(), times, rng=np.random.default_rng(seed)
    )
    return share if share > limit else 0.0


def _lagged(log: Log, name: str, time_s: Array, motion_s: float) -> Array:
    """A channel behind first-order lags at given times, a column for each of `LAG_TIMES`."""
    from scipy.signal import lfilter  # slow to import, and few logs need it

    values = log.channels[name].values
    finite = np.isfinite(values)
    step_s = even_interval_s(log.time_s)
    grid = np.arange(log.time_s[0], log.time_s[-1] + step_s, step_s)
    regular = np.interp(grid, log.time_s[finite], values[finite])
    rows = []
    for lag in LAG_TIMES:
        decay = np.exp(-step_s / (lag * motion_s)) if lag else 0.0
        start = [decay * regular[0]]
        lagged, _ = lfilter([1.0 - decay], [1.0, -decay], regular, zi=start)
        rows.append(np.interp(time_s, grid, lagged))
    return np.column_stack(rows)


def _explained(answer: Diagnosis, base: BaseFit) -> float:
    """Share of the base's residual that the causes take away."""
    before = mean_square(residual_context(base.candidate))
    return 1.0 - answer.remainder.rms**2 / max(before, np.finfo(float).tiny)
