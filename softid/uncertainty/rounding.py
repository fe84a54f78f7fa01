"""What the rounding of readings, which no noise blurs, makes of the estimates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.uncertainty.factored_rows import FactoredRows
from softid.uncertainty.linearisation import ResidualBlock

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

WELL_KNOWN = 1e6
"""Degrees of freedom of a variance that is known."""


@dataclass(frozen=True, eq=False)
class Rounding:
    """Readings on a grid; as long as one stays, so does what was rounded away.

    Attributes
    ----------
    step
        Distance of neighbouring grid points, in the channel's unit.
    starts
        First sample of every run of equal readings, one array for each segment of a block.
    """

    step: float
    starts: tuple[IntArray, ...]


def rounding_covariance(
    blocks: Sequence[ResidualBlock], roundings: Sequence[Rounding | None], inverse: Array
) -> Array:
    """Covariance of least-squares estimates whose errors are those of rounded readings.

    H⁻¹ (Σ_k w⁴ g_k g_kᵀ q²/12) H⁻¹ with g_k = Σ_t J_t over the samples of run k: all of them are
    off by one number, anywhere within half a step q. An actuator that stands still for half of a
    log brings one such number, however many samples it fills.

    Parameters
    ----------
    blocks
        As in `sandwich_covariance`.
    roundings
        One for each block, None where noise blurs it.
    inverse
        H⁻¹, shape (K, K).

    Returns
    -------
    Array
        Shape (K, K); of nothing where no block is rounded.
    """
    found = np.zeros_like(inverse)
    for block, rounding in zip(blocks, roundings, strict=True):
        if rounding is None:
            continue
        for rows, starts in zip(block.factors, rounding.starts, strict=True):
            dense = rows.dense if isinstance(rows, FactoredRows) else rows
            sums = block.weight**2 * np.add.reduceat(dense, starts, axis=0) @ inverse
            found += rounding.step**2 / 12.0 * (sums.T @ sums)
    return found
