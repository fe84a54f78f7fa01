"""Quadratic forms of time series in a Toeplitz matrix, by transforms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from softid.uncertainty.factored_rows import FactoredRows

Array = npt.NDArray[np.float64]


CHUNK = 8192
"""Points of a transform that are weighted at a time: they stay in the processor's cache, and no
second array of the transform's length is made."""


@dataclass(frozen=True, eq=False)
class LagForm:
    """Σ_s W_sᵀ T W_s for one set of series and many Toeplitz matrices T.

    Attributes
    ----------
    rows, mix
        What the series are made of, W_s = rows @ mix, of shapes (n_s, M) and (M, K); ``mix`` may be
        None for W_s itself.
    squares
        Σ_s W_sᵀ W_s, shape (K, K).
    lags
        Samples of the longest series: lags that T must have.
    size
        Points of the transform, so many that nothing wraps around.
    """

    rows: tuple[Array | FactoredRows, ...]
    mix: Array | None
    squares: Array
    lags: int
    size: int

    @classmethod
    def of(
        cls,
        rows: Sequence[Array | FactoredRows],
        mix: Array | None = None,
        *,
        gram: Array | None = None,
    ) -> LagForm:
        """Keep the series; they are made and transformed when a T that is no diagonal asks.

        Parameters
        ----------
        rows, mix
            What they are made of.
        gram
            Σ_s rowsᵀ rows where it is known already, shape (M, M).
        """
        if gram is None:
            own = [w.gram if isinstance(w, FactoredRows) else w.T @ w for w in rows]
            gram = np.sum(own, axis=0)
        squares = np.asarray(gram, np.float64)
        if mix is not None:
            squares = mix.T @ squares @ mix
        lags = max(w.shape[0] for w in rows)
        return cls(tuple(rows), mix, squares, lags, _quick_size(2 * lags - 1))

    @cached_property
    def series(self) -> tuple[Array, ...]:
        """The series W_s, each of shape (n_s, K)."""
        if self.mix is not None:
            return tuple(w @ self.mix for w in self.rows)
        return tuple(w.dense if isinstance(w, FactoredRows) else w for w in self.rows)

    def diagonal(self, toeplitz: Array) -> Array:
        """Diagonal of the form for T_tu = toeplitz[|t − u|]; of one T or of B of them.

        Shape (K,) or (B, K) for ``toeplitz`` of shape (lags,) or (B, lags).
        """
        if not toeplitz[..., 1:].any():
            return np.asarray(toeplitz[..., :1] * np.diag(self.squares), np.float64)
        return np.asarray(toeplitz @ self._products.T, np.float64)

    def matrix(self, toeplitz: Array) -> Array:
        """The form, shape (K, K), for T_tu = toeplitz[|t − u|], shape (lags,)."""
        if not toeplitz[1:].any():
            return float(toeplitz[0]) * self.squares
        weights = np.repeat(self._weights(toeplitz), 2)
        total = np.zeros(self.squares.shape)
        for parts in self._spectra:
            for begin in range(0, weights.size, CHUNK):
                part = slice(begin, begin + CHUNK)
                total += (parts[:, part] * weights[part]) @ parts[:, part].T
        return total

    @cached_property
    def _spectra(self) -> tuple[Array, ...]:
        """Transforms of the series as real and imaginary parts in turn, shape (K, 2 F)."""
        rows = (np.ascontiguousarray(w.T) for w in self.series)
        return tuple(np.fft.rfft(row, self.size, axis=1).view(np.float64) for row in rows)

    @cached_property
    def _products(self) -> Array:
        """Σ_s Σ_t W_t W_{t+l} of every column, twice for l > 0, shape (K, lags)."""
        twice = np.empty((self.squares.shape[0], self.lags))
        for k, row in enumerate(twice):  # one at a time, for the transforms of long logs are large
            squares = np.sum([parts[k] ** 2 for parts in self._spectra], axis=0)
            row[:] = 2.0 * np.fft.irfft(squares[::2] + squares[1::2], self.size)[: self.lags]
        twice[:, 0] /= 2.0
        return twice

    def _weights(self, toeplitz: Array) -> Array:
        circulant = np.zeros(self.size)
        circulant[: self.lags] = toeplitz
        circulant[self.size - self.lags + 1 :] += toeplitz[:0:-1]
        twice = np.full(self.size // 2 + 1, 2.0)
        twice[[0, -1]] = 1.0
        weights: Array = np.fft.rfft(circulant).real * twice / self.size
        return weights


def _quick_size(least: int) -> int:
    """The smallest even number of the form 2ᵃ·3ᵇ·5ᶜ that is not below, quick to transform.

    scipy.fft.next_fast_len finds the like, but importing scipy.fft takes 0.14 s, three fits' worth.
    """
    best = 1 << max(1, (least - 1).bit_length())
    for odd in (3, 5, 9, 15, 25, 27, 45, 75, 81, 125):
        size = odd * 2 ** max(1, (-(-least // odd) - 1).bit_length())
        best = min(best, size)
    return best
