"""How sure the gain on held-out samples is."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.uncertainty.student import student_quantile

Array = npt.NDArray[np.float64]

BOOTSTRAP_BLOCKS = 24
"""Blocks into which the samples fall: residuals within one may be of any colour."""

DRAWS = 999
"""Draws of as many blocks, which leave the ends uncertain by 4 % of the half of the interval."""

FEWEST_SAMPLES = 8
"""Of a block; with fewer its colour is not held within it."""


def gain_interval(
    before: Array, after: Array, rng: np.random.Generator
) -> tuple[float, float] | None:
    """95 % interval of 1 − rms(after)/rms(before) by a block bootstrap over the same blocks.

    Stretched by Student's t for the number of blocks; None for fewer than eight samples a block,
    and where one of the models has no finite response.

    Parameters
    ----------
    before, after
        Residuals at the same held-out samples, each of shape (n,).
    rng
        Source of randomness.
    """
    size = before.size // BOOTSTRAP_BLOCKS
    if size < FEWEST_SAMPLES or after.size != before.size:
        return None
    n = size * BOOTSTRAP_BLOCKS
    squares = np.stack((before[:n], after[:n])) ** 2
    if not np.isfinite(squares).all():
        return None
    sums = squares.reshape(2, BOOTSTRAP_BLOCKS, size).sum(axis=2)
    drawn = sums[:, rng.integers(0, BOOTSTRAP_BLOCKS, (DRAWS, BOOTSTRAP_BLOCKS))].sum(axis=2)
    gains = 1.0 - np.sqrt(drawn[1] / np.maximum(drawn[0], 1e-300))
    middle = 1.0 - float(np.sqrt(sums[1].sum() / max(sums[0].sum(), 1e-300)))
    low, high = np.quantile(gains, [0.025, 0.975])
    stretch = student_quantile(BOOTSTRAP_BLOCKS - 1.0, 0.975) / 1.96
    return float(middle - stretch * (middle - low)), float(middle + stretch * (high - middle))
