"""Sizes of a fitted motion, by which the bounds and starts of effects go."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from softid.effects.scale import Scale
from softid.fitters.problem import Problem

if TYPE_CHECKING:
    from softid.models.base import Model
    from softid.models.second_order import Law

Array = npt.NDArray[np.float64]

LONGEST_SHARE = 0.1
"""An output is late by a tenth of its log at most."""

TRIED_SHIFTS = 200
"""Shifts of an input in time that are tried, up to `LONGEST_SHARE` of its log."""

FASTEST = 0.05
"""The motion may be faster still at the inputs of so large a share of the samples."""

FAST_QUANTILE = 0.99
"""The largest speed is what is exceeded for a hundredth of the time only."""

SMALLEST_SPAN = 1e-12
"""What does not move at all has a span that can be divided by."""

SPAN_PLACES = 9
"""Positions between which the elastic force of a law that is not affine has its span."""


def scale_of(problem: Problem, unknowns: Array) -> Scale:
    """Take the sizes from the logs and from the base model that fits them.

    Parameters
    ----------
    problem
        The base model and its logs.
    unknowns
        Where its fit ended, shape (U,).
    """
    theta = problem.theta(unknowns)
    law = problem.model.motion_law(theta)
    paths = [_path(problem, unknowns, k) for k in range(len(problem.segments))]
    u = np.concatenate([s.input for s in problem.segments])
    x = np.concatenate([path[0] for path in paths])
    v = np.concatenate([path[1] for path in paths])
    first = problem.outputs[0]
    y_low, y_high = range_without_zeros(problem, unknowns)
    x_span = max(float(np.ptp(x)), SMALLEST_SPAN)
    units = {name: problem.logs[0].channels[name].unit for name in (first, problem.logs[0].input)}
    return Scale(
        u_low=float(u.min()),
        u_high=float(u.max()),
        x_low=float(x.min()),
        x_high=float(x.min()) + x_span,
        v_max=max(float(np.quantile(np.abs(v), FAST_QUANTILE)), 1e-9 * x_span),
        force=elastic_force(problem.model, theta, u, (float(x.min()), float(x.max()))),
        y_low=y_low,
        y_high=y_high,
        period_s=float(np.median(np.concatenate([np.diff(s.time_s) for s in problem.segments]))),
        duration_s=max(float(log.time_s[-1] - log.time_s[0]) for log in problem.logs),
        motion_s=_slowness(law, u, problem),
        travel=max(
            _travel(path[1], s.time_s) for path, s in zip(paths, problem.segments, strict=True)
        ),
        u_unit=units[problem.logs[0].input],
        x_unit=str(getattr(problem.model, "x_unit", units[first])),
        force_unit=_force_unit(problem),
        y_unit=units[first],
        a_turn=_turning(paths, [s.time_s for s in problem.segments]),
    )


def _turning(paths: Sequence[tuple[Array, Array]], times: Sequence[Array]) -> float:
    """Median size of the acceleration in the intervals in which the speed changes its sign."""
    found = [
        np.abs(np.diff(v) / np.diff(time_s))[v[1:] * v[:-1] < 0.0]
        for (_, v), time_s in zip(paths, times, strict=True)
    ]
    turns = np.concatenate(found)
    return float(np.median(turns)) if turns.size else 0.0


def range_without_zeros(problem: Problem, unknowns: Array) -> tuple[float, float]:
    """Smallest and largest value of the first output, less the sensor zeros of its logs.

    Parameters
    ----------
    problem, unknowns
        A fit, which holds the zeros.
    """
    segments = range(len(problem.segments))
    y = np.concatenate([_without_zero(problem, unknowns, k) for k in segments])
    return float(y.min()), float(y.max())


def _without_zero(problem: Problem, unknowns: Array, k: int) -> Array:
    """The first output over one segment, less the sensor zero of its log, as the model gives it."""
    segment, first = problem.segments[k], problem.outputs[0]
    y = segment.outputs[first][segment.used[first]]
    return y - unknowns[problem.zero_position(problem.owner[k], first)] if problem.zeros else y


def _path(problem: Problem, unknowns: Array, k: int) -> tuple[Array, Array]:
    """Position and velocity of the base model over one segment."""
    response = problem.response(unknowns, k)
    if response.x is None or response.v is None:
        y = response.outputs[problem.outputs[0]]
        return y, np.gradient(y, problem.segments[k].time_s)
    return response.x, response.v


def elastic_force(model: Model, theta: Array, u: Array, places: tuple[float, float]) -> float:
    """Typical span of the elastic force; that of the drive where there is no spring.

    Parameters
    ----------
    model
        The model, whose effects do not count; one without a motion has a force of 1.
    theta
        Its parameters.
    u
        Inputs.
    places
        Smallest and largest position.
    """
    law, term = model.motion_law(theta), model.motion_term(theta)
    low, high = places
    if law is not None:
        _, stiffness, drive = law.coefficients(u)
        elastic = float(np.median(stiffness)) * max(high - low, SMALLEST_SPAN)
        return elastic if elastic > 0.0 else max(float(np.ptp(drive)), SMALLEST_SPAN)
    if term is None:
        return 1.0
    elastic = float(np.ptp([term.elastic(x) for x in np.linspace(low, high, SPAN_PLACES)]))
    return elastic if 0.0 < elastic < np.inf else 1.0


def _slowness(law: Law | None, u: Array, problem: Problem) -> float:
    """Typical time constant of the motion, or how late the output comes where a law has none."""
    period_s = min(float(np.median(np.diff(s.time_s))) for s in problem.segments)
    late_s = 0.0
    if law is not None:
        damping, stiffness, _ = (float(np.median(c)) for c in law.coefficients(u))
        if stiffness > 0.0:
            late_s = damping / stiffness
        elif damping > 0.0:
            late_s = law.mass / damping
    if late_s <= period_s:
        late_s = max(_lateness(problem, k) for k in range(len(problem.segments)))
    return max(late_s, period_s)


def fastest_time(problem: Problem, unknowns: Array) -> float:
    """Time constant of the motion at the inputs at which it is fastest, infinite if none is known.

    Parameters
    ----------
    problem, unknowns
        The base fit.
    """
    law = problem.model.motion_law(problem.theta(unknowns))
    if law is None:
        return np.inf
    u = np.concatenate([segment.input for segment in problem.segments])
    damping, stiffness, _ = law.coefficients(u)
    with np.errstate(all="ignore"):
        late_s = np.maximum(damping / stiffness, np.sqrt(law.mass / stiffness))
    late_s = late_s[np.isfinite(late_s)]
    return float(np.quantile(late_s, FASTEST)) if late_s.size else np.inf


def _lateness(problem: Problem, k: int) -> float:
    """Shift of the input at which the output follows it best, in seconds."""
    segment = problem.segments[k]
    first = problem.outputs[0]
    used = segment.used[first]
    time_s, y = segment.time_s[used], segment.outputs[first][used]
    longest_s = LONGEST_SHARE * float(np.ptp(segment.time_s))
    shifts = np.linspace(0.0, longest_s, TRIED_SHIFTS)
    moved = [np.interp(time_s - s, segment.time_s, segment.input) for s in shifts]
    with np.errstate(all="ignore"):
        alike = [abs(np.corrcoef(shifted, y)[0, 1]) for shifted in moved]
    return float(shifts[int(np.argmax(np.nan_to_num(alike)))])


def _travel(v: Array, time_s: Array) -> float:
    return max(float(np.sum(np.abs(v[:-1]) * np.diff(time_s))), 1e-12)


def _force_unit(problem: Problem) -> str:
    """Unit of the stiffness times that of the position; a pure number where there is none."""
    model = problem.model
    if model.stiffness_parameter is None:
        return model.force_unit
    x_unit = str(getattr(model, "x_unit", ""))
    return problem.parameters[model.stiffness_parameter].unit.removesuffix(f"/{x_unit}") or "1"
