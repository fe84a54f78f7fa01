"""Sums of products of residual and derivatives: all that the normal equations need."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Keep:
    """What is kept of the columns that products are summed of.

    Attributes
    ----------
    stretch
        Samples that the columns are means of, 1 for every sample, 0 where none are kept.
    residual
        Whether the residual is kept at every sample, which columns at every sample hold anyway.
    """

    stretch: int = 0
    residual: bool = False


NO_COLUMNS, ALL_COLUMNS = Keep(), Keep(1)
"""Products alone, and the columns at every sample."""


@dataclass(frozen=True, eq=False)
class Products:
    """Σ cᵢcⱼ over the used samples of one output channel of one segment.

    Attributes
    ----------
    gram
        The sums for P inner parameters, S₀ inner states, one, and the residual measured − simulated
        without sensor zero, shape (P + S₀ + 2, P + S₀ + 2).
    by_theta
        Weights with which the first P columns make up ∂y/∂θ, shape (P, K).
    by_state
        Weights with which the next S₀ make up ∂y/∂(initial state), shape (S₀, S).
    columns
        The columns at every sample, zero where it is not used, shape (P + S₀ + 2, n), or their
        means over the used samples of every stretch; None where they are not kept.
    counts
        Number of used samples in every stretch, shape (m,); None where no means are kept.
    left
        The residual at every sample, zero where it is not used, shape (n,); None where it is not
        kept.
    """

    gram: Array
    by_theta: Array
    by_state: Array
    columns: Array | None
    counts: Array | None
    left: Array | None
