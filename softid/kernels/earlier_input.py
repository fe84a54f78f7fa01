"""A straight-line course read at other times that rise as its own do, in one pass over both."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]


@kernel
def read_at(at_s: Array, time_s: Array, values: Array, found: Array) -> None:
    """The straight line through the values at each time; beyond their ends the outermost value.

    The formula is that of `numpy.interp`, which searches for each time anew.

    Parameters
    ----------
    at_s
        Where it is wanted, shape (m,), rising.
    time_s, values
        The course, each of shape (n,), times rising.
    found
        Room for the result, shape (m,).
    """
    last = time_s.size - 1
    k = 0
    for i in range(at_s.size):
        t = at_s[i]
        while k < last and time_s[k + 1] <= t:
            k += 1
        if t <= time_s[0]:
            found[i] = values[0]
        elif k == last:
            found[i] = values[last]
        else:
            slope = (values[k + 1] - values[k]) / (time_s[k + 1] - time_s[k])
            found[i] = slope * (t - time_s[k]) + values[k]


@kernel
def means_between(edges_s: Array, time_s: Array, values: Array, found: Array) -> None:
    """Mean of the straight line through the values from each edge to the next.

    Beyond its ends the course goes on at its outermost values.

    Parameters
    ----------
    edges_s
        Where the means begin and end, shape (m + 1,), rising.
    time_s, values
        The course, each of shape (n,), times rising.
    found
        Room for the means, shape (m,).
    """
    last = time_s.size - 1
    k, area = 0, 0.0
    before = 0.0
    for i in range(edges_s.size):
        t = edges_s[i]
        while k < last and time_s[k + 1] <= t:
            area += 0.5 * (values[k] + values[k + 1]) * (time_s[k + 1] - time_s[k])
            k += 1
        since = t - time_s[k]
        whole = area + values[k] * since
        if k < last and since > 0.0:
            slope = (values[k + 1] - values[k]) / (time_s[k + 1] - time_s[k])
            whole += 0.5 * slope * since * since
        if i > 0:
            found[i - 1] = (whole - before) / (t - edges_s[i - 1])
        before = whole


@kernel
def largest_between(from_s: Array, to_s: Array, time_s: Array, values: Array, found: Array) -> None:
    """Largest value of the straight line through the values from one time to another.

    Beyond its ends the course goes on at its outermost values.

    Parameters
    ----------
    from_s, to_s
        Where each stretch begins and ends, shape (m,), both rising.
    time_s, values
        The course, each of shape (n,), times rising.
    found
        Room for the values, shape (m,).
    """
    read_at(from_s, time_s, values, found)
    ends = np.empty(to_s.size)
    read_at(to_s, time_s, values, ends)
    first = 0
    for i in range(from_s.size):
        largest = max(found[i], ends[i])
        while first < time_s.size and time_s[first] < from_s[i]:
            first += 1
        k = first
        while k < time_s.size and time_s[k] <= to_s[i]:
            largest = max(largest, values[k])
            k += 1
        found[i] = largest
