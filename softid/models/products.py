"""Sums of products of residual and derivatives: all that the normal equations need."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

Keep = int | Literal["residual"]
"""Which columns are kept: number of samples over which all are summed, 1 for every sample and 0 for
none, or the residual alone at every sample."""


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
        The columns at every sample, zero where it is not used, shape (P + S₀ + 2, n), their sums
        over stretches of samples, or the last of them, shape (1, n); None where nothing was kept.
    """

    gram: Array
    by_theta: Array
    by_state: Array
    columns: Array | None
