"""Fingerprint of recorded samples, by which a log is known however it was given."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def data_fingerprint(time_s: Array, measured: Mapping[str, Array]) -> str:
    """sha256 of times and measured samples, whatever the order of the channels.

    Parameters
    ----------
    time_s
        Times, shape (n,).
    measured
        Output channel → samples, shape (n,), in its canonical unit; NaN where there is none.

    Examples
    --------
    >>> time_s, angle = np.array([0.0, 0.1]), np.array([0.0, 0.5])
    >>> data_fingerprint(time_s, {"angle": angle})[:8]
    'd6ee4012'
    """
    digest = hashlib.sha256(_bytes(time_s))
    for name in sorted(measured):
        digest.update(b"\0" + name.encode() + b"\0")
        digest.update(_bytes(measured[name]))
    return digest.hexdigest()


def _bytes(values: Array) -> bytes:
    """The same for equal values: there are two zeros and many numbers that are none."""
    plain = np.asarray(values, "<f8") + 0.0
    return np.where(np.isnan(plain), np.nan, plain).tobytes()
