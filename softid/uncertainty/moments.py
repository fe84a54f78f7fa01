"""Lagged products of residuals and of what the parameters can reach, summed once.

The likelihood of every autoregression up to an order follows from them, without the samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from softid.uncertainty.autoregression import run_slices
from softid.uncertainty.burg import MIN_LEFT

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]

NUGGET = 1e-12
"""White variance added to every column, relative to its mean square: rounding in the moments of
smooth regressors is some 1e-14 of it and may not turn a square negative."""


@dataclass(frozen=True, eq=False)
class Moments:
    """Lagged products from which the likelihood of any autoregression follows.

    Attributes
    ----------
    products
        products[t, i, j] = Σ y_{s−i} y_{s−j}ᵀ over the samples s that have exactly t predecessors
        in their stretch (t = p: at least p), shape (p + 1, p + 1, p + 1, m, m); the last column of
        y is the residual, the others a basis of what the parameters can reach.
    counts
        Number of those samples, shape (p + 1,).
    longest
        Samples in the longest stretch.
    """

    products: Array
    counts: Array
    longest: int

    @property
    def n(self) -> int:
        """Samples used."""
        return int(self.counts.sum())

    @cached_property
    def terms(self) -> tuple[Index, Index, Index]:
        """The t, i and j of `packed`: a sample with t predecessors has no lag beyond t."""
        size = self.counts.size
        rows = [(t, i, j) for t in range(size) for i in range(t + 1) for j in range(i + 1)]
        when, first, second = np.array(rows).T.copy()
        return when, first, second

    @cached_property
    def packed(self) -> Array:
        """``products`` of every pair of lags with those of the pair turned round.

        What they sum to is symmetric: of each the lower triangle, shape (terms, m·(m + 1)/2).
        """
        when, first, second = self.terms
        there = self.products[when, first, second]
        both = there + np.where((first > second)[:, None, None], there.transpose(0, 2, 1), 0.0)
        return np.ascontiguousarray(both[:, np.tri(both.shape[1], dtype=bool)])

    @property
    def reachable(self) -> int:
        """Directions that the parameters can reach."""
        return int(self.products.shape[-1]) - 1


def gather_moments(
    residuals: Sequence[Array],
    reach: Sequence[Array],
    max_order: int,
    *,
    known: tuple[Array, Array] | None = None,
) -> Moments:
    """Sum the lagged products of residuals and basis over all stretches.

    Parameters
    ----------
    residuals
        Segments of shape (n_s,); NaN where a sample is not used.
    reach
        Basis of what the parameters can do to each segment, shape (n_s, m − 1).
    max_order
        Highest order p of an autoregression that will be asked for.
    known
        Products of the basis over all samples in use with itself and with the residuals, of shapes
        (m − 1, m − 1) and (m − 1,), where they will do: for order 0.
    """
    width = (reach[0] if known is None else known[0]).shape[1] + 1
    size = max_order + 1
    products = np.zeros((size, size, size, width, width))
    counts = np.zeros(size)
    longest = 0
    for k, residual in enumerate(residuals):
        for span in run_slices(np.isfinite(residual)):
            longest = max(longest, span.stop - span.start)
            if known is not None:
                products[0, 0, 0, -1, -1] += residual[span] @ residual[span]
                counts[0] += span.stop - span.start
                continue
            y = np.column_stack((reach[k][span], residual[span]))
            _add_start(products, counts, y[:max_order])
            if y.shape[0] > max_order:
                products[max_order] += _bulk(y, max_order)
                counts[max_order] += y.shape[0] - max_order
    if known is not None:
        products[0, 0, 0, :-1, :-1], cross = known
        products[0, 0, 0, :-1, -1] = products[0, 0, 0, -1, :-1] = cross
    scale = np.einsum("taakk->k", products[:, :1, :1]) / max(counts.sum(), 1.0)
    floor = np.diag(np.append(NUGGET * scale[:-1], MIN_LEFT * scale[-1]))
    for i in range(size):
        products[i:, i, i] += counts[i:, None, None] * floor
    return Moments(products, counts, longest)


def _add_start(products: Array, counts: Array, start: Array) -> None:
    """Add the first samples of a stretch, each with the predecessors that it has."""
    outer = np.einsum("ia,jb->ijab", start, start)
    for t in range(start.shape[0]):
        products[t, : t + 1, : t + 1] += outer[t::-1, t::-1][: t + 1, : t + 1]
        counts[t] += 1.0


def _bulk(y: Array, p: int) -> Array:
    """Σ_{s ≥ p} y_{s−i} y_{s−j}ᵀ for i, j = 0 … p, each product from its neighbour by two ends."""
    n, width = y.shape
    out = np.zeros((p + 1, p + 1, width, width))
    for j in range(p + 1):
        out[0, j] = y[p:].T @ y[p - j : n - j]
        out[j, 0] = out[0, j].T
    first, last = y[:p][::-1], y[n - p :][::-1]
    gained, lost = (np.einsum("ia,jb->ijab", ends, ends) for ends in (first, last))
    for i in range(p):
        out[i + 1, 1:] = out[i, :p] + gained[i] - lost[i]
    return out
