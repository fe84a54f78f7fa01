"""Reflection coefficients by Burg's recursion, over the samples or over their lagged products."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from softid.kernels.burg_recursion import raise_order
from softid.kernels.lagged_products import add_lagged_products

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]

MIN_LEFT = 1e-6
"""Share of the residual's power below which no prediction is believed: a thousandth of its size is
quantisation, rounding or the smoothness of a noise-free simulation, and no memory of a noise."""

LONG_RUN = 50_000
"""Samples of the shortest stretch from which the recursion goes by lags: its errors would not stay
in the processor's cache from order to order."""


def burg(runs: Sequence[Array], max_order: int) -> Array:
    """Reflection coefficients k_1 … k_max of several stretches; zero once `MIN_LEFT` is left.

    k_m = 2 Σ f_t b_{t−1} / Σ (f_t² + b_{t−1}²) with the forward and backward errors f, b of order
    m − 1, summed over all stretches.

    Parameters
    ----------
    runs
        Stretches, each of shape (n_s,).
    max_order
        How many coefficients.

    Examples
    --------
    >>> burg([np.array([1.0, 1.0, 1.0, 1.0])], 1).round(3).tolist()
    [1.0]
    """
    if min((run.size for run in runs), default=0) >= max(LONG_RUN, 4 * max_order):
        return _by_lags(runs, max_order)
    pairs = [(np.array(run, np.float64), np.array(run, np.float64)) for run in runs]
    out, left, k = np.zeros(max_order), 1.0, 0.0
    for m in range(max_order):
        sums = [raise_order(f, b, k) for f, b in pairs]
        found = _coefficient(sum(c for c, _ in sums), sum(p for _, p in sums), left)
        if found is None:
            break
        out[m] = k = found
        left *= 1.0 - k * k
        pairs = [(f[1:], b[:-1]) for f, b in pairs]
    return out


def _coefficient(cross: float, power: float, left: float) -> float | None:
    """One coefficient that leaves `MIN_LEFT` at least; None where no more is left already."""
    if power <= 0.0 or left <= 2.0 * MIN_LEFT:
        return None
    most = float(np.sqrt(1.0 - MIN_LEFT / left))
    return min(max(2.0 * cross / power, -most), most)


def _by_lags(runs: Sequence[Array], max_order: int) -> Array:
    """`burg` from lagged products, so that every lag of long stretches is looked at once.

    The errors of order m − 1 are filters of the samples, f_t = Σ a_i r_{t−i} and
    b_{t−1} = Σ a_i r_{t−m+i}, so that their products are forms in Σ_{t ≥ m} r_{t−i} r_{t−j}.
    """
    moments = np.sum([_lagged_moments(run, max_order) for run in runs], axis=0)
    out, left, error = np.zeros(max_order), 1.0, np.ones(1)
    for m in range(max_order):
        ahead, behind = np.append(error, 0.0), np.append(0.0, error[::-1])
        table = moments[m, : m + 2, : m + 2]
        power = float(ahead @ table @ ahead + behind @ table @ behind)
        k = _coefficient(float(ahead @ table @ behind), power, left)
        if k is None:
            break
        out[m], left = k, left * (1.0 - k * k)
        error = ahead - k * behind
    return out


def _lagged_moments(run: Array, max_order: int) -> Array:
    """Σ_{t > m} r_{t−i} r_{t−j} for m from 0 and i, j up to m + 1, shape (p, p + 1, p + 1).

    Of the sum over all products at a lag, those at the begin and the end that are beyond are taken
    away.
    """
    size = max_order + 1
    first, last = run[: 2 * size], run[-2 * size :]
    whole = np.zeros(size)
    add_lagged_products(run, run, 0.0, whole)
    begin, end = np.zeros((size, size + 1)), np.zeros((size, size + 1))
    for d in range(size):
        begin[d, 1:] = first[d : d + size] * first[:size]
        end[d, 1:] = (last[d:] * last[: last.size - d])[: -size - 1 : -1]
    begin, end = np.cumsum(begin, axis=1), np.cumsum(end, axis=1)
    lag, before, behind = _places(max_order)
    moments: Array = whole[lag] - begin[lag, before] - end[lag, behind]
    return moments


@lru_cache(maxsize=64)
def _places(max_order: int) -> tuple[Index, Index, Index]:
    """Lag, and products that are too many at the begin and the end, of every entry of the moments.

    Entries beyond i, j ≤ m + 1 mean nothing.
    """
    m, i, j = np.ogrid[:max_order, : max_order + 1, : max_order + 1]
    later = np.maximum(i, j)
    lag = np.broadcast_to(np.abs(i - j), (max_order, max_order + 1, max_order + 1))
    before = np.maximum(m + 1 - later, 0) + np.zeros_like(lag)
    behind = np.minimum(i, j) + np.zeros_like(lag)
    return lag, before, behind
