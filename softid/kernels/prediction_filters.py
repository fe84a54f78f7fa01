"""How autoregressions weigh the lagged products of a series in their likelihood."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]


@kernel
def weigh_products(
    reflection: Array, when: Index, first: Index, second: Index, weights: Array, ratio: Array
) -> None:
    """Products of the prediction-error filters 1, −φ^{(t)}, over their error variances.

    The filters of orders 0 … p follow by Levinson's recursion; orders above q repeat order q.

    Parameters
    ----------
    reflection
        Reflection coefficients of B autoregressions, shape (B, q) with q at most p.
    when, first, second
        Order t, and two places i and j in its filter, each of shape (T,).
    weights
        Receives f_i f_j/v of every such term, shape (B, T).
    ratio
        Receives the error variances v over the innovation's, shape (B, p + 1).
    """
    order, size = reflection.shape[1], ratio.shape[1]
    filters = np.zeros((size, size))
    filters[0, 0] = 1.0
    for b in range(reflection.shape[0]):
        ratio[b, order:] = 1.0
        for t in range(order, 0, -1):
            k = reflection[b, t - 1]
            ratio[b, t - 1] = ratio[b, t] / ((1.0 - k) * (1.0 + k))
        for t in range(1, size):
            k = reflection[b, t - 1] if t <= order else 0.0
            for i in range(t + 1):
                filters[t, i] = filters[t - 1, i] - k * filters[t - 1, t - i]
        for row in range(when.size):
            t = when[row]
            weights[b, row] = filters[t, first[row]] * filters[t, second[row]] / ratio[b, t]
