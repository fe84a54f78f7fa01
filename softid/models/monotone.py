"""Inversion of a strictly monotone function for many values at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

MAX_ITERATIONS = 200
"""Rounds at most, more than any takes: a Newton step that is taken halves the one before at least,
a step to the midpoint halves the bracket, and a double has 53 bits."""

_RESOLUTION = 4.0 * float(np.finfo(np.float64).eps)
"""Step relative to the solution that is rounding: smaller ones go to and fro for ever."""


def invert_monotone(
    function: Callable[[Array], Array],
    slope: Callable[[Array], Array],
    target: Array,
    low: float,
    high: float,
) -> Array:
    """Solve ``function(x) = target`` on ``[low, high]`` by Newton's method within a bracket.

    Parameters
    ----------
    function, slope
        A strictly monotone function and its derivative, vectorised.
    target
        Values between ``function(low)`` and ``function(high)``, shape (m,).
    low, high
        Ends of the monotone stretch.

    Returns
    -------
    ndarray
        The x of each target, shape (m,), to the resolution of a double.

    Notes
    -----
    A Newton step that leaves the bracket, or that shrinks less than by half, is replaced by the
    bracket's midpoint, so the solution is reached however flat the function is at its ends.

    Examples
    --------
    >>> invert_monotone(lambda x: x**3, lambda x: 3 * x**2, np.array([8.0]), 0.0, 5.0)
    array([2.])
    """
    ends = function(np.array([low, high]))
    sign = 1.0 if ends[1] > ends[0] else -1.0
    below, above = np.full(target.shape, low), np.full(target.shape, high)
    x: Array = 0.5 * (below + above)
    last_step = np.full(target.shape, high - low)
    for _ in range(MAX_ITERATIONS):
        error = sign * (function(x) - target)
        above = np.where(error >= 0, x, above)
        below = np.where(error <= 0, x, below)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = x - error / (sign * slope(x))
        inside = (newton >= below) & (newton <= above)
        shrinking = np.abs(newton - x) <= 0.5 * np.abs(last_step)
        new = np.where(inside & shrinking, newton, 0.5 * (below + above))
        last_step, x = new - x, new
        if np.all(np.abs(last_step) <= _RESOLUTION * np.maximum(np.abs(x), 1e-3 * (high - low))):
            break
    return x
