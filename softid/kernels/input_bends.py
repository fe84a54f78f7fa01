"""Where a course bends within its intervals, and how far a cubic lies above the straight line."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@njit(nogil=True, error_model="numpy", forceinline=True)
def _divided_differences(time_s, values, k):  # type: ignore[no-untyped-def]
    """The second divided differences at both ends of interval k, and the third one over it."""
    t0, t1, t2, t3 = time_s[k - 1], time_s[k], time_s[k + 1], time_s[k + 2]
    first = (values[k] - values[k - 1]) / (t1 - t0)
    middle = (values[k + 1] - values[k]) / (t2 - t1)
    last = (values[k + 2] - values[k + 1]) / (t3 - t2)
    before, after = (middle - first) / (t2 - t0), (last - middle) / (t3 - t1)
    return before, after, (after - before) / (t3 - t0)


@kernel
def third_steps(time_s: Array, values: Array, found: Array) -> None:
    """Size of the third divided difference times the interval cubed.

    Parameters
    ----------
    time_s, values
        The course, each of shape (n,), times rising.
    found
        Room for the sizes of samples k to k + 3, times the cube of the middle interval, shape
        (n − 3,).
    """
    for k in range(found.size):
        _, _, third = _divided_differences(time_s, values, k + 1)
        found[k] = abs(third * (time_s[k + 2] - time_s[k + 1]) ** 3)


@njit(nogil=True, error_model="numpy", forceinline=True)
def _bend(time_s, values, k):  # type: ignore[no-untyped-def]
    """Second divided differences at both ends of interval k, and the bend in its middle."""
    before, after, third = _divided_differences(time_s, values, k)
    half = 0.5 * (time_s[k + 1] - time_s[k])
    # Newton's form on four samples, half way between the inner two.
    return before, after, -(before + third * ((time_s[k] - time_s[k - 1]) + half)) * half**2


@njit(nogil=True, error_model="numpy", forceinline=True)
def _counts(before, after, found, resolved, least):  # type: ignore[no-untyped-def]
    """Whether both ends bend alike, and far enough."""
    smaller, larger = min(abs(before), abs(after)), max(abs(before), abs(after))
    is_alike = (before * after > 0.0) & (larger <= resolved * smaller)
    return is_alike & (abs(found) >= least)


@kernel
def bends_in_the_middle(
    time_s: Array, values: Array, resolved: float, least: float, at: IntArray, bend: Array
) -> int:
    """Bends of the cubic through four samples, half way between the inner two; how many there are.

    Parameters
    ----------
    time_s, values
        The course, each of shape (n,), times rising.
    resolved
        Largest ratio of the second divided differences at both ends of an interval.
    least
        Smallest bend that counts.
    at, bend
        Receive the sample k before each interval that bends, and by how much; of shape (0,) to
        count alone.
    """
    count = 0
    if at.size == 0:
        for k in range(1, time_s.size - 2):  # no branch, so that several are looked at at a time
            before, after, found = _bend(time_s, values, k)
            count += 1 if _counts(before, after, found, resolved, least) else 0
        return count
    for k in range(1, time_s.size - 2):
        before, after, found = _bend(time_s, values, k)
        if _counts(before, after, found, resolved, least):
            at[count], bend[count] = k, found
            count += 1
    return count
