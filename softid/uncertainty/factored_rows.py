"""Derivatives at every sample as a product of two factors, which is made when it is asked for."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FactoredRows:
    """J = columnsᵀ weights, of which sums over samples need only sums of the columns.

    Attributes
    ----------
    columns
        Values at every sample, zero where it is not used, shape (C, n).
    weights
        With which they make up the derivatives by K parameters, shape (C, K).
    gram
        JᵀJ, which is known already, shape (K, K).

    Examples
    --------
    >>> c, w = np.arange(6.0).reshape(2, 3), np.array([[1.0], [2.0]])
    >>> rows = FactoredRows(c, w, (c.T @ w).T @ (c.T @ w))
    >>> rows.shape, rows.sums(3).tolist(), rows.along(np.ones(3)).tolist()
    ((3, 1), [[27.0]], [27.0])
    """

    columns: Array
    weights: Array
    gram: Array

    @property
    def shape(self) -> tuple[int, int]:
        """(n, K)."""
        return self.columns.shape[1], self.weights.shape[1]

    @cached_property
    def dense(self) -> Array:
        """J, shape (n, K)."""
        product: Array = self.columns.T @ self.weights
        return product

    def __matmul__(self, mix: Array) -> Array:
        """J times a matrix of shape (K, M), shape (n, M)."""
        product: Array = self.columns.T @ (self.weights @ mix)
        return product

    def along(self, values: Array) -> Array:
        """Jᵀ times a series of shape (n,), shape (K,)."""
        product: Array = (self.columns @ values) @ self.weights
        return product

    def sums(self, length: int) -> Array:
        """Sums over consecutive stretches of samples, of which the last may be short, (m, K)."""
        count = self.columns.shape[1] // length
        # never a copy, and no -1, which means nothing where there is no whole stretch
        whole = self.columns[:, : count * length].reshape(len(self.columns), count, length)
        parts = [whole @ np.ones(length)]
        if count * length < self.columns.shape[1]:
            parts.append(self.columns[:, count * length :].sum(axis=1, keepdims=True))
        joined = parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)
        product: Array = joined.T @ self.weights
        return product
