"""Single samples that are far off those beside them, and no corner of a motion either."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.excitation import NORMAL_QUARTILE

Array = npt.NDArray[np.float64]

AS_FAR = 0.5
"""A spike is this much as far off the course on one side of it as off that on the other."""

SHARP = 0.5
"""A spike is this share as far off those lines, and to the same side, as off its neighbours: what a
filter has smoothed turns round within several samples, however small its fast noise is."""

SPIKE = 6.0
"""A sample so many deviations of the fast noise off both neighbours is a fault of the sensor."""


def spikes_in(residual: Array) -> npt.NDArray[np.bool_]:
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
    usual = residual - 0.5 * (beside[0] + beside[1])
    deviation = float(np.median(np.abs(usual))) / (NORMAL_QUARTILE * 1.5**0.5)
    least = SPIKE * deviation if deviation > 0.0 else np.inf
    off_course = np.sign(off) * _off_course(residual)
    found: npt.NDArray[np.bool_] = (np.abs(off) > least) & (
        off_course > np.maximum(least, SHARP * np.abs(off))
    )
    return found


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
