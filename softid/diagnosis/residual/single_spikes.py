"""Single samples or two that are far off those beside them, and no corner of a motion either."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.excitation import NORMAL_QUARTILE

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

AS_FAR = 0.5
"""A spike is this much as far off the course on one side of it as off that on the other."""

SHARP = 0.5
"""A spike is this share as far off those lines, and to the same side, as off its neighbours: what a
filter has smoothed turns round within several samples, however small its fast noise is."""

SPIKE = 6.0
"""A sample so many deviations of the fast noise off both neighbours is a fault of the sensor."""


PAIR = 30.0
"""Two samples side by side so many deviations of the fast noise off both neighbours are faults,
too: what a motion leaves where it begins at once may last as long, and is no such jump and back."""

PAIR_RETURNS = 0.2
"""Most that the neighbours of a pair differ, in how far it is off them."""


def spikes_in(residual: Array) -> BoolArray:
    """Which samples are far off both of their neighbours, shape (n,).

    Parameters
    ----------
    residual
        What is left of samples that follow each other, shape (n,).

    Examples
    --------
    >>> rest = 0.01 * (-1.0) ** np.arange(9)
    >>> np.flatnonzero(spikes_in(np.where(np.arange(9) == 4, 1.0, rest))).tolist()
    [4]
    """
    if residual.size < 3:
        return np.zeros(residual.size, np.bool_)
    beside = np.concatenate((residual[1:2], residual[:-1])), np.append(residual[1:], residual[-2])
    off = residual - np.clip(residual, np.minimum(*beside), np.maximum(*beside))
    deviation = _fast_deviation(residual)
    least = SPIKE * deviation if deviation > 0.0 else np.inf
    off_course = np.sign(off) * _off_course(residual)
    found: BoolArray = (np.abs(off) > least) & (off_course > np.maximum(least, SHARP * np.abs(off)))
    return found


def pairs_in(residual: Array, still: BoolArray) -> BoolArray:
    """Which samples are one of two side by side that are far off both of their neighbours.

    Parameters
    ----------
    residual
        What is left of samples that follow each other, shape (n,).
    still
        Whether the input does not jump near them, which could leave as much, shape (n,).

    Examples
    --------
    >>> rest = 0.01 * (-1.0) ** np.arange(9)
    >>> pair = np.where(np.isin(np.arange(9), (4, 5)), 1.0, rest)
    >>> np.flatnonzero(pairs_in(pair, np.ones(9, np.bool_))).tolist()
    [4, 5]
    """
    found = np.zeros(residual.size, np.bool_)
    deviation = _fast_deviation(residual)
    if residual.size < 4 or not deviation > 0.0:
        return found
    before, one, other, behind = (residual[k : residual.size - 3 + k] for k in range(4))
    middle = 0.5 * (before + behind)
    off = np.minimum(np.abs(one - middle), np.abs(other - middle))
    returns = np.abs(before - behind) < PAIR_RETURNS * off
    is_pair = (off > PAIR * deviation) & ((one > middle) == (other > middle)) & returns
    first = np.flatnonzero(is_pair & still[1:-2]) + 1
    found[first] = found[first + 1] = True
    return found


def _fast_deviation(residual: Array) -> float:
    """Standard deviation of the noise that neighbours do not share, by what lies off their mean."""
    beside = (
        np.concatenate((residual[1:2], residual[:-1])),
        np.append(residual[1:], residual[-2:-1]),
    )
    usual = residual - 0.5 * (beside[0] + beside[1])
    return float(np.median(np.abs(usual)) / (NORMAL_QUARTILE * np.sqrt(1.5)))


def _off_course(residual: Array) -> Array:
    """How far samples are off the line through those before them and off that through those behind.

    None where these disagree: a motion that begins at once makes a corner, whose sample is the last
    on one line or the first on the other. At the peak of a wave both lines end beyond the sample,
    and those of a cusp near it: neither has the size of a spike.
    """
    near = np.pad(residual, 2, mode="reflect")
    before = residual - (2.0 * near[1:-3] - near[:-4])
    behind = residual - (2.0 * near[3:-1] - near[4:])
    least, most = np.sort(np.abs((before, behind)), axis=0)
    agree = (least > AS_FAR * most) & (before * behind > 0.0)
    return np.where(agree, np.sign(before) * least, 0.0)
