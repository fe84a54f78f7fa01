"""Start values of the equilibrium model from data alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from softid.kernels.bending import fastest_rates, rest_angle
from softid.parameters import ParameterSet
from softid.segment import Segment

if TYPE_CHECKING:
    from softid.models.equilibrium import Equilibrium

Array = npt.NDArray[np.float64]

STIFFNESSES: Array = np.geomspace(0.05, 20.0, 61)
MASSES: Array = np.geomspace(0.05, 20.0, 31)
"""Stiffness scales and constant C_m that are tried, 10 and 22 % apart. Either would be 1 if the
geometry were right; a factor of 20 is more than it can be wrong, a judgement."""

DAMPING_RATIO = 0.3
"""Damping ratio with which all masses are tried first: one that swings, and dies out in a hold."""

OTHER_DAMPING_RATIOS = (0.03, 0.1, 1.0, 3.0)
"""Damping ratios that are tried with the best masses, a factor of three apart: from a motion that
swings throughout a hold to one that creeps."""

STATIC_POINTS = 200
"""Samples of a segment, about, at which the static curve is compared: one parameter is sought, and
every stiffness costs a rest angle at each of them."""

N_STARTS = 4
"""Starts that are handed on at most, a judgement: each costs a run of the optimiser."""

BEST_MASSES = 8
"""Masses, the best ones, that are tried with all dampings: how fast a motion swings is seen with
any."""

MOST_SAMPLES = 1600
"""Samples at which a simulation of the grid is compared; of more, every k-th is taken."""

ROUGH_PHASE = 0.6
"""Largest product of step and natural frequency in a simulation of the grid: the swing is then late
by a hundredth of a period in each, and the grid is far coarser."""


def equilibrium_starts(
    model: Equilibrium, segments: Sequence[Segment], output: str
) -> tuple[ParameterSet, ...]:
    """Stiffness from the static curve, then C_d and c from a grid of simulations.

    Parameters
    ----------
    model
        The model with its options.
    segments
        All segments of all fitted logs.
    output
        The angle.
    """
    declared = model.parameters()
    theta = declared.values_vector()
    theta[4] = _stiffness(model, theta, segments, output)
    swing_angle = _largest_rest(model, theta, segments)
    thinned = _thinned(segments)
    masses = MASSES if not declared["c"].fixed else np.array([theta[3]])

    def scored(grid: Iterable[tuple[float, float]]) -> list[tuple[float, Array]]:
        found = []
        for mass, ratio in grid:
            at = theta.copy()
            at[0], at[3] = 1.0, mass
            swing, fading = fastest_rates(np.array([swing_angle]), at, model.compiled_body)
            at[0] = 2.0 * ratio * swing / fading
            score = _score(model, at, thinned, output)
            if np.isfinite(score):
                found.append((score, at))
        return sorted(found, key=lambda row: row[0])

    first = scored((mass, DAMPING_RATIO) for mass in masses.tolist())
    best = [float(at[3]) for _, at in first[:BEST_MASSES]]
    again = scored(product(best or masses.tolist(), OTHER_DAMPING_RATIOS))
    ranked = sorted([*first, *again], key=lambda row: row[0])
    names = declared.names
    starts = []
    for _, at in ranked[:N_STARTS]:
        named = dict(zip(names, at.tolist(), strict=True))
        starts.append(
            declared.with_values({k: v for k, v in named.items() if not declared[k].fixed})
        )
    return tuple(starts)


def _stiffness(model: Equilibrium, theta: Array, segments: Sequence[Segment], output: str) -> float:
    """The scale at which the static curve comes closest to the record, oscillation and all."""
    best, found = np.inf, 1.0
    for scale in STIFFNESSES:
        at = theta.copy()
        at[4] = scale
        total = 0.0
        for segment in segments:
            few = np.flatnonzero(segment.used[output])
            few = few[:: max(1, few.size // STATIC_POINTS)]
            if few.size == 0:
                continue
            rest = model.static_output(at, segment.input[few], output)
            total += _left_over(model, segment.time_s[few], segment.outputs[output][few] - rest)
        if np.isfinite(total) and total < best:
            best, found = total, float(scale)
    return found


def _largest_rest(model: Equilibrium, theta: Array, segments: Sequence[Segment]) -> float:
    """The rest angle at the largest pressure."""
    level = max((float(p) for s in segments for p in (s.input.min(), s.input.max())), key=abs)
    angle = float(rest_angle(level, theta, model.compiled_body))
    return angle if np.isfinite(angle) else 0.0


def _thinned(segments: Sequence[Segment]) -> list[Segment]:
    """About `MOST_SAMPLES` in all; an input with knots between its samples stays as it is."""
    every = -(-sum(s.time_s.size for s in segments) // MOST_SAMPLES)
    return [s.part(slice(None, None, every)) if s.is_sample is None else s for s in segments]


def _score(model: Equilibrium, theta: Array, segments: Sequence[Segment], output: str) -> float:
    total = 0.0
    for segment in segments:
        used = segment.used[output]
        if not used.any():
            continue
        plan = model.plan_for(theta, segment, ROUGH_PHASE)
        response = model.response(
            theta, segment, (output,), start=None, derivatives=False, plan=plan
        )
        residual = (segment.outputs[output] - response.outputs[output])[used]
        total += _left_over(model, segment.time_s[used], residual)
    return total


def _left_over(model: Equilibrium, time_s: Array, residual: Array) -> float:
    """Sum of squares without the mean, and without the trend where a drift is estimated."""
    left = residual - residual.mean()
    if model.drift == "linear" and left.size > 2:
        centred = time_s - time_s.mean()
        left = left - centred * float(centred @ left) / float(centred @ centred)
    return float(left @ left)
