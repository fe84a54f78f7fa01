"""Quadratic forms of time series in a Toeplitz matrix, by transforms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LagForm:
    """Σ_s W_sᵀ T W_s for one set of series and many Toeplitz matrices T.

    Attributes
    ----------
    spectra
        Transforms of the series, padded so that nothing wraps around.
    power
        Σ_s |W_s|² of every column, shape (frequencies, K).
    lags
        Samples of the longest series: lags that T must have.
    size
        Points of the transform.
    """

    spectra: tuple[npt.NDArray[np.complex128], ...]
    power: Array
    lags: int
    size: int

    @classmethod
    def of(cls, series: Sequence[Array]) -> LagForm:
        """Transform series of shape (n_s, K)."""
        lags = max(w.shape[0] for w in series)
        size = 1 << max(1, (2 * lags - 1).bit_length())
        spectra = tuple(np.fft.rfft(w, size, axis=0) for w in series)
        power = np.sum([np.abs(f) ** 2 for f in spectra], axis=0)
        return cls(spectra, power, lags, size)

    def diagonal(self, toeplitz: Array) -> Array:
        """Diagonal of the form, shape (K,), for T_tu = toeplitz[|t − u|], shape (lags,)."""
        out: Array = self._weights(toeplitz) @ self.power
        return out

    def matrix(self, toeplitz: Array) -> Array:
        """The form, shape (K, K), for T_tu = toeplitz[|t − u|], shape (lags,)."""
        weights = self._weights(toeplitz)[:, None]
        total = np.sum([np.conj(f).T @ (weights * f) for f in self.spectra], axis=0)
        return np.asarray(total.real, dtype=np.float64)

    def _weights(self, toeplitz: Array) -> Array:
        circulant = np.zeros(self.size)
        circulant[: self.lags] = toeplitz
        circulant[self.size - self.lags + 1 :] += toeplitz[:0:-1]
        twice = np.full(self.size // 2 + 1, 2.0)
        twice[[0, -1]] = 1.0
        weights: Array = np.fft.rfft(circulant).real * twice / self.size
        return weights
