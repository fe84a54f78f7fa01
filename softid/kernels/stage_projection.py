"""Times within integration steps, and the parabolas nearest to what arrives at them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]
Counts = npt.NDArray[np.int16]


@kernel
def spread(
    time_s: Array, u: Array, counts: Counts, nodes: int, node_s: Array, node_u: Array
) -> None:
    """Equidistant nodes within every step, at which the input is straight between samples.

    Parameters
    ----------
    time_s, u
        Samples, each of shape (n,).
    counts
        Steps per sampling interval, shape (n − 1,).
    nodes
        Nodes per step, the last at its end.
    node_s, node_u
        Receive times and input, each of shape (1 + nodes·L,) for L steps; the first is the first
        sample.
    """
    node_s[0], node_u[0] = time_s[0], u[0]
    at = 1
    for k in range(counts.size):
        pieces = counts[k] * nodes
        length, rise = (time_s[k + 1] - time_s[k]) / pieces, (u[k + 1] - u[k]) / pieces
        for i in range(1, pieces):
            node_s[at] = time_s[k] + length * i
            node_u[at] = u[k] + rise * i
            at += 1
        node_s[at], node_u[at] = time_s[k + 1], u[k + 1]
        at += 1


@kernel
def gather(node_u: Array, weights: Array, stage_u: Array) -> None:
    """Weighted sums of the values at the nodes of every step, its first included.

    Parameters
    ----------
    node_u
        Values, shape (1 + nodes·L,).
    weights
        Shape (1 + nodes, 3).
    stage_u
        Receives the sums, shape (L, 3).
    """
    nodes = weights.shape[0] - 1
    for k in range(stage_u.shape[0]):
        first, second, third = 0.0, 0.0, 0.0
        for i in range(nodes + 1):
            value = node_u[nodes * k + i]
            first += weights[i, 0] * value
            second += weights[i, 1] * value
            third += weights[i, 2] * value
        stage_u[k, 0], stage_u[k, 1], stage_u[k, 2] = first, second, third
