"""Bounded Levenberg–Marquardt on the normal equations, for exact Jacobians.

One evaluation gives the cost, Jᵀr and JᵀJ, so that large data are never factorised. The trust
region is a ball in units of each unknown's plausible move rather than of its Jacobian column: a
long flat valley is walked in long strides. The damping follows Nielsen (1999). A coordinate on a
bound whose gradient points outward is held there (Kanzow, Yamashita and Fukushima, J. Comput. Appl.
Math. 172, 2004). A non-finite trial point is a rejected step. Sums of exponentials have narrow
curved valleys; the geodesic acceleration of Transtrum and Sethna (arXiv:1201.5885) follows the bend
of the valley instead of stopping at its wall.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.kernels.damped_systems import bounded_step, find_movable, is_still, solve_damped

Array = npt.NDArray[np.float64]

CURVATURE_STEP = 0.1
"""Fraction of a step at which the second derivative along it is measured."""

SHORT_STEP = 0.1
"""Steps shorter than this share of what is plausible hardly bend: the correction would be a tenth
of the step or less, which the next one makes good, and to measure it takes a simulation."""

MOST_ACCELERATION = 0.75
"""A step whose acceleration is larger than this share of its velocity is too long to trust."""

LESS_ACCELERATION = 0.9
"""A step that bent too much is shortened to this share of what `MOST_ACCELERATION` allows: the
share grows with the length of the step, but turns with its direction too."""

MOST_SHORTENED = 0.1
"""Share of a step that is left at least: what bends without end may be one place only."""

INITIAL_DAMPING = 1e-12
"""Damping of the first step, as a share of the largest diagonal entry of JᵀJ in units of the reach:
next to none, so that a run begins with a Gauss–Newton step, bounded by `LARGEST_STEP`. The largest
entry is that of a zero or an initial state, which may move so far that it is a million times those
of the parameters."""

CAUTIOUS_DAMPING = 1e-9
"""The same for what a diagnosis fits, whose parameters it damps by a thousandth: a nearly free step
carries a law that begins at a guess of its size to where it is another one, so that a friction
which falls with the speed ends as a plain one."""

# What begins a run is many calls away from what knows how sure its start is.
_first_damping: ContextVar[float] = ContextVar("first_damping", default=INITIAL_DAMPING)

LARGEST_DECREASE = 0.1
"""Factor by which an accepted step lowers the damping at most. Nielsen's is 1/3; a tenth, a
judgement, forgets a rejected step sooner."""

MOST_DAMPING = 1e30
"""Damping above which a rejected step ends the run, so that it cannot go on for ever: the growth
doubles from rejection to rejection, and from the first damping about fifteen lead there."""

LARGEST_STEP = 3.0
"""Longest step of any unknown, in units of its reach: a factor of e⁶ = 400 on a logarithmic scale.
A judgement: so far away the linearised response says where to, not how far."""

SMALLEST_STEP = 1e-11
"""Relative move of every unknown below which the iteration stops: 50,000 times a double's rounding,
and far below any standard error."""

STALL_EVALUATIONS = 30
"""Evaluations between two looks at whether the cost still falls; a judgement."""

STALL_GAIN = 1e-3
"""Fall of the cost from look to look, in residual variances, below which the iteration creeps:
along a valley in which the parameters make up for each other it would go on so without end."""

STALL_OFFSET = 5e-2
"""Largest `attainable_offset`, in standard errors, at which an iteration that creeps is stopped. It
is what a fit calls reached, so that a run which creeps far from an optimum goes on."""

DOUBLINGS = 40
"""Doublings of the damping that are tried to shorten a step: a factor of 1e12 in all. Where none
makes it short enough, the last is taken."""

_SCALE_FLOOR = 1e-12
"""Least scale, as a share of the largest: keeps the division by it finite where a reach is infinite
or very long."""

_LEAST_DIAGONAL = 1e-300
"""Stands for a diagonal of zero: close to the smallest number there is."""


@dataclass(frozen=True, eq=False)
class NormalEquations:
    """Cost and normal equations at one point.

    Attributes
    ----------
    point
        The point, shape (U,): the one asked for, or better along unknowns that enter linearly.
    cost
        ½‖r‖²; infinite where the model is not finite.
    gradient
        Jᵀr with J = ∂(simulated)/∂z and r = measured − simulated: the direction of descent,
        shape (U,).
    matrix
        JᵀJ, shape (U, U).
    n
        Number of residuals.
    """

    point: Array
    cost: float
    gradient: Array
    matrix: Array
    n: int


@dataclass(frozen=True, eq=False)
class Minimum:
    """Where the iteration ended.

    Attributes
    ----------
    point
        Unknowns, shape (U,).
    normal
        Cost and normal equations there.
    evaluations
        Number of evaluations.
    offset
        `attainable_offset` at the end.
    damping
        Damping at the end, with which another run would go on; None before the first run.
    used_up
        Whether the limit of evaluations ended it.
    """

    point: Array
    normal: NormalEquations
    evaluations: int
    offset: float
    damping: float | None = None
    used_up: bool = False


@contextmanager
def cautiously() -> Iterator[None]:
    """Have all runs inside the ``with`` block or decorated function begin cautiously.

    Threads that are started inside begin as usual.
    """
    token = _first_damping.set(CAUTIOUS_DAMPING)
    try:
        yield
    finally:
        _first_damping.reset(token)


def minimise(
    evaluate: Callable[[Array], NormalEquations],
    start: Array,
    lower: Array,
    upper: Array,
    reach: Array,
    *,
    evaluations: int,
    tolerance: float,
    second_derivative: Callable[[Array, Array, NormalEquations], Array | None] | None = None,
    damping: float | None = None,
) -> Minimum:
    """Minimise ½‖r(z)‖² within bounds.

    Parameters
    ----------
    evaluate
        Cost and normal equations at a point.
    start, lower, upper
        Start and bounds, each of shape (U,).
    reach
        How far each unknown may plausibly still move, shape (U,); see `attainable_offset`. A step
        is shortened to at most `LARGEST_STEP` of it.
    evaluations
        Limit of evaluations.
    tolerance
        Stop when `attainable_offset` falls below it.
    second_derivative
        (z, v, normal) → Jᵀ∂²ŷ/∂v², the second derivative of the simulated response along v seen
        from the parameters, shape (U,); None, or a None result, for no acceleration.
    damping
        That of a run that goes on; None begins anew.
    """
    z = within(start, lower, upper)
    now = evaluate(z)
    z = now.point
    used = 1
    growth = 2.0
    progress = _Progress()
    scale = 1.0 / reach
    unit = _floored(scale)
    squared_unit = unit**2
    if damping is None:
        damping = _first_damping.get() * float(np.max(np.diag(now.matrix) * reach**2, initial=0.0))
    while used < evaluations and math.isfinite(now.cost) and z.size:
        moving = movable(z, now.gradient, lower, upper)
        offset = attainable_offset(now, moving, reach)
        if offset <= tolerance or progress.stalls(used, now, offset):
            break  # nothing moves where the offset is 0
        ridge = damping * squared_unit
        step = _solved(now.matrix, ridge, now.gradient, moving)
        trial = np.empty(z.size)
        places = lower, upper, now.matrix, now.gradient, trial
        longest, predicted = bounded_step(z, step, reach, LARGEST_STEP, *places)
        if second_derivative is not None and longest > SHORT_STEP:
            pull = second_derivative(z, step, now)
            used += 1
            if pull is not None:
                correction = -0.5 * _solved(now.matrix, ridge, pull, moving)
                with np.errstate(over="ignore"):  # a correction beyond all numbers is too large
                    share = _length(scale * correction) / _length(scale * step)
                if 2.0 * share <= MOST_ACCELERATION:
                    trial = within(z + step + correction, lower, upper)
                else:
                    length = _length((scale * step)[moving])
                    least = LESS_ACCELERATION * MOST_ACCELERATION / (2.0 * share)
                    shorter = max(least, MOST_SHORTENED) * length
                    damping = _damping_for(now, moving, unit, damping, shorter)
                    growth = 2.0
                    continue
        if is_still(z, trial, SMALLEST_STEP):
            break
        then = evaluate(trial)
        used += 1
        gained = now.cost - then.cost
        if math.isfinite(then.cost) and gained > 0 and predicted > 0:
            ratio = gained / predicted
            damping *= max(LARGEST_DECREASE, 1.0 - (2.0 * min(ratio, 1.5) - 1.0) ** 3)
            growth = 2.0
            z, now = then.point, then
        elif damping > MOST_DAMPING:
            break
        else:
            damping, growth = damping * growth, growth * 2.0
    offset = offset_within(now, lower, upper, reach)
    return Minimum(z, now, used, offset, damping, used_up=used >= evaluations)


def offset_within(normal: NormalEquations, lower: Array, upper: Array, reach: Array) -> float:
    """`attainable_offset` over what may move between bounds; infinite where nothing is finite."""
    if not np.isfinite(normal.cost):
        return float("inf")
    moving = movable(normal.point, normal.gradient, lower, upper)
    return attainable_offset(normal, moving, reach)


def next_point(found: Minimum, lower: Array, upper: Array, reach: Array) -> Array:
    """Where the next step of a run that has ended would lead, shape (U,)."""
    moving = movable(found.point, found.normal.gradient, lower, upper)
    ridge = (found.damping or 0.0) * _floored(1.0 / reach) ** 2
    step = _solved(found.normal.matrix, ridge, found.normal.gradient, moving)
    return within(found.point + step, lower, upper)


def whole_gain(normal: NormalEquations) -> float:
    """½ gᵀ(JᵀJ)⁻¹g: by how much the step of all unknowns without damping should lower the cost."""
    free, every = np.zeros(normal.gradient.size), np.ones(normal.gradient.size, np.bool_)
    step = _solved(normal.matrix, free, normal.gradient, every)
    return 0.5 * float(step @ normal.gradient)


def within(point: Array, lower: Array, upper: Array) -> Array:
    """The nearest point within bounds, shape (U,)."""
    found: Array = np.minimum(np.maximum(point, lower), upper)
    return found


def movable(z: Array, gradient: Array, lower: Array, upper: Array) -> npt.NDArray[np.bool_]:
    """Which unknowns are inside their bounds or pulled inward, shape (U,)."""
    moving = np.empty(z.size, np.bool_)
    find_movable(z, gradient, lower, upper, moving)
    return moving


def attainable_offset(
    normal: NormalEquations, moving: npt.NDArray[np.bool_], reach: Array, *, floor: float = 0.0
) -> float:
    """How far the estimate is from the optimum, in its own standard errors.

    The relative offset of Bates and Watts (Technometrics 23, 1981), √(gᵀ(JᵀJ + Λ)⁻¹g / P) / s with
    s² = ‖r‖²/(n − P). The ridge Λ = s²/reach² is the only difference: a parameter whose move by its
    whole reach changes the response by less than the residual's standard deviation cannot be called
    far from its optimum, however its column points.

    Parameters
    ----------
    normal
        Cost and normal equations.
    moving
        Which unknowns count, shape (U,).
    reach
        How far each unknown may plausibly move, shape (U,).
    floor
        Smallest residual standard deviation that counts, for data without noise.
    """
    count = int(np.count_nonzero(moving))
    if count == 0:
        return 0.0
    if not math.isfinite(normal.cost):
        return float("inf")
    variance = max(2.0 * normal.cost / max(normal.n - count, 1), floor**2, 1e-300)
    ridge = variance / reach**2
    solution = _solved(normal.matrix, ridge, normal.gradient, moving)
    gain = max(float(solution @ normal.gradient), 0.0)
    return math.sqrt(gain / count / variance)


class _Progress:
    """Remembers the cost of some evaluations ago."""

    def __init__(self) -> None:
        self._next = STALL_EVALUATIONS
        self._cost = np.inf

    def stalls(self, used: int, now: NormalEquations, offset: float) -> bool:
        """Whether the optimum is near and the last evaluations have hardly brought it nearer."""
        if used < self._next:
            return False
        variance = 2.0 * now.cost / max(now.n - now.point.size, 1)
        slow = self._cost - now.cost < STALL_GAIN * variance
        self._next, self._cost = used + STALL_EVALUATIONS, now.cost
        return slow and offset <= STALL_OFFSET


def _length(vector: Array) -> float:
    return math.sqrt(float(vector @ vector))


def _floored(scale: Array) -> Array:
    """Scales of which none is so small that a step would go without bounds, shape (U,)."""
    found: Array = np.maximum(scale, _SCALE_FLOOR * float(scale.max(initial=0.0)))
    return found


def _damping_for(
    normal: NormalEquations,
    moving: npt.NDArray[np.bool_],
    unit: Array,
    damping: float,
    length: float,
) -> float:
    """The least damping, in doublings, at which the step is no longer than ``length``."""
    d = unit[moving]
    values, vectors = np.linalg.eigh(_among(normal.matrix, moving) / d / d[:, None])
    along = (normal.gradient[moving] / d) @ vectors
    trials = max(damping, 1e-300) * 2.0 ** np.arange(1.0, DOUBLINGS + 1.0)
    steps = along / (np.maximum(values, 0.0) + trials[:, None])
    short = np.sum(steps**2, axis=1) <= length**2
    return float(trials[int(np.argmax(short)) if short.any() else -1])


def _among(matrix: Array, moving: npt.NDArray[np.bool_]) -> Array:
    """Rows and columns of the unknowns that move."""
    return matrix if moving.all() else matrix[np.ix_(moving, moving)]


def _solved(matrix: Array, ridge: Array, vector: Array, moving: npt.NDArray[np.bool_]) -> Array:
    """Solution of (matrix + diag(ridge))·x = vector over the unknowns that move, shape (U,).

    Where rounding leaves it singular, the one that is least in units of its diagonal.
    """
    solution = np.empty(vector.size)
    if solve_damped(matrix, ridge, vector, moving, solution):
        return solution
    damped = _among(matrix + np.diag(ridge), moving)
    unit = 1.0 / np.sqrt(np.maximum(damped.diagonal(), _LEAST_DIAGONAL))
    solution[:] = 0.0
    with np.errstate(over="ignore"):  # what the logs do not see may go as far as its reach
        solution[moving] = unit * _solve(damped * unit * unit[:, None], unit * vector[moving])
    return solution


def _solve(matrix: Array, vector: Array) -> Array:
    """Solution of a symmetric semidefinite system; least-norm where it is singular."""
    try:
        solution = np.linalg.solve(matrix, vector)
    except np.linalg.LinAlgError:
        solution = np.linalg.lstsq(matrix, vector, rcond=None)[0]
    return np.asarray(solution, dtype=np.float64)
