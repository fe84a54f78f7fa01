"""Noise that remembers: autoregressive noise of the first order, of unit variance throughout."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

Array = npt.NDArray[np.float64]


def ar1(rng: np.random.Generator, n: int, rho: float) -> Array:
    """Neighbours that correlate by ``rho``; the first sample is as large as all others."""
    kicks = rng.standard_normal(n)
    kicks[1:] *= np.sqrt(1.0 - rho**2)
    found: Array = lfilter([1.0], [1.0, -rho], kicks)
    return found


def coloured(rng: np.random.Generator, n: int, time_s: float, period_s: float) -> Array:
    """Samples ``period_s`` apart that correlate by 1/e after ``time_s``; white for no time."""
    return ar1(rng, n, float(np.exp(-period_s / time_s)) if time_s else 0.0)
