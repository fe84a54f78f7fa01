"""The residual of a block of steps, and the products of all its columns.

See `softid.kernels.affine_blocks` for the block and its workspace ``w``.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.affine_blocks import (
    BY,
    LANES,
    N_PADDED,
    N_PARAMETERS,
    N_STATES,
    ONE,
    POINTS,
    RESIDUAL,
    X,
)
from softid.kernels.exponential import NO_REORDERING

Array = npt.NDArray[np.float64]

SUMMING = {"contract", "arcp", "nsz", "reassoc"}
"""What summing may rearrange. It is part of its caller always: a function that is also compiled by
itself sums in another order there, and a run that compiles would differ from later ones in the last
digits."""


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def select_ends(w: Array, gain: float, level: float) -> None:
    """Residual y − (gain·x + level) at the ends of the steps, and zero rows where none counts."""
    for i in range(LANES, POINTS):
        w[RESIDUAL + i] = w[ONE + i] * (w[RESIDUAL + i] - level - gain * w[X + i])
    for p in range(N_PARAMETERS + N_STATES):
        for i in range(LANES, POINTS):
            w[BY + p * POINTS + i] *= w[ONE + i]


@njit(nogil=True, error_model="numpy", fastmath=SUMMING, forceinline=True)
def add_gram(w: Array, gram: Array) -> None:
    """Add all products of two columns, shape (12, 12), blocks on and below the diagonal."""
    for a in range(0, N_PADDED, 2):
        for b in range(0, a + 1, 2):
            t00, t01, t10, t11 = 0.0, 0.0, 0.0, 0.0
            for i in range(LANES, POINTS):
                a0, a1 = w[BY + a * POINTS + i], w[BY + (a + 1) * POINTS + i]
                b0, b1 = w[BY + b * POINTS + i], w[BY + (b + 1) * POINTS + i]
                t00 += a0 * b0
                t01 += a0 * b1
                t10 += a1 * b0
                t11 += a1 * b1
            gram[a, b] += t00
            gram[a, b + 1] += t01
            gram[a + 1, b] += t10
            gram[a + 1, b + 1] += t11
