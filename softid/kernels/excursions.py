"""How far values lie off both of their neighbours."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import bare_kernel

Array = npt.NDArray[np.float64]


@bare_kernel
def measure_depths(values: Array, depths: Array) -> None:
    """The lesser move to a value from its two neighbours; 0 where it lies between them.

    Parameters
    ----------
    values
        Finite values, shape (n,).
    depths
        Receives those of all inner ones, shape (n − 2,).
    """
    for i in range(depths.size):
        before, after = values[i + 1] - values[i], values[i + 1] - values[i + 2]
        depths[i] = min(abs(before), abs(after)) if before * after > 0.0 else 0.0
