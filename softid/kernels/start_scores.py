"""How well many parameters explain a motion whose gain and zero are free."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels import affine, affine_steps, exponential, lanes
from softid.kernels.affine import move
from softid.kernels.decorators import kernel
from softid.kernels.lanes import MUSCLE, RADAU
from softid.kernels.sources import follow_sources

Array = npt.NDArray[np.float64]
Counts = npt.NDArray[np.int16]
BoolArray = npt.NDArray[np.bool_]


@kernel
def add_products(
    thetas: Array,
    time_s: Array,
    u: Array,
    counts: Counts,
    y: Array,
    used: BoolArray,
    sums: Array,
) -> None:
    """Products of simulated and measured motion about their means, for muscles that start at rest.

    Parameters
    ----------
    thetas
        As `move` takes them, one row each, shape (G, 8).
    time_s, u, counts
        As in `move`; steps are implicit.
    y, used
        Measured motion and whether it counts, each of shape (n,).
    sums
        Σxy, Σxx and Σyy are added, shape (G, 3); where a motion is not finite nothing is.
    """
    law, rule = int(MUSCLE), int(RADAU)  # bare constants would compile `move` once more
    x, v, state = np.empty(u.size), np.empty(u.size), np.zeros(2)
    n, y_mean, y_power = 0, 0.0, 0.0
    for i in range(u.size):
        if used[i]:
            n += 1
            y_mean += y[i]
    if n == 0:
        return
    y_mean /= n
    for i in range(u.size):
        if used[i]:
            y_power += (y[i] - y_mean) ** 2
    for g in range(thetas.shape[0]):
        force = np.exp(thetas[g, 2] * u[0])
        state[0] = force / (thetas[g, 1] * force + thetas[g, 3])
        move(law, rule, thetas[g], time_s, u, counts, state, x, v)
        mean, cross, power = 0.0, 0.0, 0.0
        for i in range(u.size):
            if used[i]:
                mean += x[i]
        mean /= n
        for i in range(u.size):
            if used[i]:
                cross += (x[i] - mean) * (y[i] - y_mean)
                power += (x[i] - mean) ** 2
        if np.isfinite(mean):
            sums[g, 0] += cross
            sums[g, 1] += power
            sums[g, 2] += y_power


follow_sources(add_products, (affine, affine_steps, exponential, lanes))
