"""What is left of an output after a fit: its memory and its ties to the input.

Plain arrays in, frozen results out. A NaN is a sample that was not used; every sum runs over the
pairs of samples that are there. The residuals of real logs are autocorrelated, so each correlation
comes with a band that allows for it next to the band for white noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.chi_square import chi_square_tail
from softid.errors import InputError, UsageError
from softid.kernels.lagged_products import add_lagged_products

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

FEW_LAGS = 32
"""Below so many lags their sums are taken one by one."""

NORMAL_95 = 1.959963984540054
"""Two-sided 95 % quantile of the normal law."""

WHITENESS_LEVEL = 0.01
"""p-value below which a residual is called coloured: by chance one white one in a hundred is."""

WHITENESS_LAGS, SAMPLES_PER_LAG = 20, 5
"""Lags of `whiteness` at most, and samples that each of them needs."""


@dataclass(frozen=True, eq=False)
class Autocorrelation:
    """Correlation of a residual with its own past.

    Attributes
    ----------
    lags
        Lags in samples, 0 … max_lag.
    values
        Autocorrelation at each lag; 1 at lag 0.
    white_band
        95 % of the values lie within ± this if the residual is white.
    bartlett_band
        95 % half-width at each lag if the true correlation ends before it, shape (max_lag + 1,).
    n
        Samples used.
    """

    lags: npt.NDArray[np.int64]
    values: Array
    white_band: float
    bartlett_band: Array
    n: int


@dataclass(frozen=True, eq=False)
class CrossCorrelation:
    """Correlation of a residual with the input.

    Attributes
    ----------
    lags
        Lags in samples, −max_lag … max_lag; at a positive lag the residual follows the input.
    values
        Correlation at each lag.
    band
        95 % half-width if residual and input are unrelated, each with the memory it shows.
    white_band
        The narrower half-width if one of the two were white.
    n
        Samples used.
    """

    lags: npt.NDArray[np.int64]
    values: Array
    band: float
    white_band: float
    n: int


@dataclass(frozen=True)
class WhitenessTest:
    """Outcome of a portmanteau test.

    Attributes
    ----------
    statistic
        Q, to be compared with χ² of ``degrees_of_freedom``.
    p_value
        Chance of a larger Q from white noise.
    degrees_of_freedom
        Lags less fitted noise coefficients.
    """

    statistic: float
    p_value: float
    degrees_of_freedom: int

    @property
    def is_white(self) -> bool:
        """Whether white noise has so large a Q oftener than once in a hundred times."""
        return self.p_value >= WHITENESS_LEVEL


def autocorrelation(residual: Array, max_lag: int) -> Autocorrelation:
    """Autocorrelation of a residual with white and Bartlett bands.

    r_k = (1 − k/n) · mean over pairs of (x_t x_{t+k}) / mean of x_t², x without its mean; for a
    record without gaps this is the usual estimate Σ x_t x_{t+k} / Σ x_t². Bartlett's band at lag k
    is 1.96 √[(1 + 2 Σ_{0<j<k} r_j²)/n].

    Parameters
    ----------
    residual
        Samples, shape (n,); NaN where not used.
    max_lag
        Largest lag, below the number of samples.

    Returns
    -------
    Autocorrelation

    Raises
    ------
    InputError
        Fewer than two samples are used, or all are equal.
    UsageError
        The largest lag is not within the record.

    Notes
    -----
    M. S. Bartlett, J. R. Stat. Soc. Suppl. 8 (1946) 27.

    Examples
    --------
    >>> autocorrelation(np.array([1.0, -1.0, 1.0, -1.0]), 1).values.tolist()
    [1.0, -0.75]
    """
    _check_lag(max_lag, residual.size)
    centred, used = _centred(residual, "residual")
    n = int(used.sum())
    sums = _lagged_sums(centred, centred, max_lag)
    pairs = _lagged_pairs(used, used, max_lag)
    lags = np.arange(max_lag + 1)
    mean = np.divide(sums, pairs, out=np.zeros_like(sums), where=pairs > 0)
    values = np.clip(1.0 - lags / n, 0.0, None) * mean * n / sums[0]
    before = np.concatenate(([0.0, 0.0], np.cumsum(values[1:-1] ** 2)))[: max_lag + 1]
    band = NORMAL_95 * np.sqrt((1.0 + 2.0 * before) / n)
    return Autocorrelation(lags, values, NORMAL_95 / np.sqrt(n), band, n)


def cross_correlation(residual: Array, input: Array, max_lag: int) -> CrossCorrelation:
    """Correlation of a residual with the input, with a band that knows the memory of both.

    r_k = (1 − |k|/n) · mean over pairs of (e_t u_{t−k}) / (s_e s_u). If the two are unrelated,
    var r_k ≈ (1/n) Σ_j ρ_e(j) ρ_u(j) (Bartlett), here with |j| up to half the record and never
    below 1/n.

    Parameters
    ----------
    residual
        Samples, shape (n,); NaN where not used.
    input
        Samples at the same times, shape (n,).
    max_lag
        Largest lag, below the number of samples.

    Returns
    -------
    CrossCorrelation

    Raises
    ------
    InputError
        Shapes differ, fewer than two samples are used, or one of the two is constant.
    UsageError
        The largest lag is not within the record.

    Notes
    -----
    M. S. Bartlett, J. R. Stat. Soc. 98 (1935) 536.

    Examples
    --------
    >>> u = np.array([0.0, 1.0, 0.0, -1.0] * 8)
    >>> c = cross_correlation(np.roll(u, 1), u, 2)
    >>> int(c.lags[np.argmax(c.values)])
    1
    """
    if residual.shape != input.shape:
        raise InputError(
            "residual and input differ in length",
            value=(residual.size, input.size),
            remedy="give one input sample per residual",
        )
    _check_lag(max_lag, residual.size)
    e, used_e = _centred(residual, "residual")
    u, used_u = _centred(input, "input")
    n = int((used_e & used_u).sum())
    later = _mean_product(u, e, used_u, used_e, max_lag)
    earlier = _mean_product(e, u, used_e, used_u, max_lag)
    lags = np.arange(-max_lag, max_lag + 1)
    spread = np.sqrt((e @ e) / used_e.sum() * (u @ u) / used_u.sum())
    taper = np.clip(1.0 - np.abs(lags) / max(n, 1), 0.0, None)
    values = taper * np.concatenate((earlier[:0:-1], later)) / spread
    half = max(1, residual.size // 2)
    rho_e, rho_u = autocorrelation(residual, half).values, autocorrelation(input, half).values
    factor = max(1.0, 1.0 + 2.0 * float(rho_e[1:] @ rho_u[1:]))
    white = NORMAL_95 / np.sqrt(max(n, 1))
    return CrossCorrelation(lags, values, float(white * np.sqrt(factor)), float(white), n)


def ljung_box(residual: Array, lags: int, fitted_parameters: int = 0) -> WhitenessTest:
    """Test whether a residual is white.

    Q = n(n + 2) Σ_k r_k²/m_k with r_k = Σ x_t x_{t+k}/Σ x_t² over the m_k available pairs, m_k =
    n − k without gaps. Under whiteness Q follows χ² with ``lags − fitted_parameters`` degrees of
    freedom.

    Parameters
    ----------
    residual
        Samples, shape (n,); NaN where not used. Join several segments with ``lags`` NaN between.
    lags
        Number of lags.
    fitted_parameters
        Coefficients of a noise model that made this residual (an autoregression of order p: p).
        The parameters of a simulated response do not count here.

    Returns
    -------
    WhitenessTest
        Of a constant residual: Q = 0, p = 1.

    Raises
    ------
    InputError
        Fewer than two samples are used.
    UsageError
        There are no more lags than fitted parameters, or more than the record has.

    Notes
    -----
    G. M. Ljung and G. E. P. Box, Biometrika 65 (1978) 297; D. S. Stoffer and C. M. C. Toloi,
    Stat. Probab. Lett. 13 (1992) 391, for missing samples.

    Examples
    --------
    >>> ljung_box(np.array([1.0, -1.0] * 50), 5).p_value < 1e-9
    True
    """
    _check_lag(lags, residual.size)
    if lags <= fitted_parameters:
        raise UsageError(
            "the whiteness test has no degrees of freedom left",
            value=(lags, fitted_parameters),
            remedy="use more lags than the noise model has coefficients",
        )
    used = np.isfinite(residual)
    n = int(used.sum())
    if n < 2:
        raise InputError("fewer than two residuals are used", value=n, remedy="mask fewer samples")
    freedom = lags - fitted_parameters
    span, level = _span_and_mean(residual if n == residual.size else residual[used])
    if span == 0.0:
        return WhitenessTest(0.0, 1.0, freedom)
    if n == residual.size:
        sums = np.zeros(lags + 1)
        add_lagged_products(residual, residual, level, sums)
    else:
        centred = residual - level
        centred[~used] = 0.0
        sums = _lagged_sums(centred, centred, lags)
    pairs = _lagged_pairs(used, used, lags)
    any_pair = pairs[1:] > 0
    q = float(n * (n + 2.0) * np.sum((sums[1:][any_pair] / sums[0]) ** 2 / pairs[1:][any_pair]))
    return WhitenessTest(q, chi_square_tail(q, freedom), freedom)


def whiteness(residuals: Sequence[Array]) -> WhitenessTest:
    """Test whether what a fit leaves is white: `ljung_box` at 20 lags, of few samples at fewer.

    Parameters
    ----------
    residuals
        One residual per segment, shape (n_s,); NaN where a sample is not used. No pair of samples
        is taken across two of them.

    Returns
    -------
    WhitenessTest
        At as many lags as a fifth of the samples where that is less than 20, and at one at least.

    Raises
    ------
    InputError
        Fewer than two samples are used.

    Examples
    --------
    >>> whiteness([np.array([1.0, -1.0] * 50)]).is_white
    False
    """
    n = sum(int(np.count_nonzero(np.isfinite(residual))) for residual in residuals)
    gap = np.full(WHITENESS_LAGS, np.nan)
    apart = [part for residual in residuals for part in (residual, gap)][:-1]
    joined = np.concatenate(apart) if len(apart) > 1 else apart[0]
    return ljung_box(joined, max(1, min(WHITENESS_LAGS, n // SAMPLES_PER_LAG)))


def _span_and_mean(values: Array) -> tuple[float, float]:
    return float(np.ptp(values)), float(values.mean())


def _check_lag(max_lag: int, n: int) -> None:
    if not 1 <= max_lag < n:
        raise UsageError(
            "the largest lag is not within the record",
            value=max_lag,
            remedy=f"choose one from 1 to {n - 1}",
        )


def _centred(values: Array, name: str) -> tuple[Array, BoolArray]:
    """Values without their mean, zero where missing, and which are there."""
    used = np.isfinite(values)
    if not used.any() or float(np.ptp(values[used])) == 0.0:
        raise InputError(
            f"the {name} does not vary, so it has no correlation",
            value=int(used.sum()),
            remedy="use a longer or livelier record",
        )
    return np.where(used, values - values[used].mean(), 0.0), used


def _mean_product(
    first: Array, second: Array, used_first: BoolArray, used_second: BoolArray, max_lag: int
) -> Array:
    """Mean of first_t second_{t+k} over the available pairs, k = 0 … max_lag."""
    sums = _lagged_sums(first, second, max_lag)
    pairs = _lagged_pairs(used_first, used_second, max_lag)
    return np.divide(sums, pairs, out=np.zeros_like(sums), where=pairs > 0)


def _lagged_sums(first: Array, second: Array, max_lag: int) -> Array:
    """Σ_t first_t second_{t+k}, k = 0 … max_lag, by a zero-padded transform unless k are few."""
    if max_lag < min(first.size, FEW_LAGS):
        sums = np.zeros(max_lag + 1)
        add_lagged_products(first, second, 0.0, sums)
        return sums
    size = 1 << int(first.size + max_lag).bit_length()
    spectrum = np.conj(np.fft.rfft(first, size)) * np.fft.rfft(second, size)
    return np.fft.irfft(spectrum, size)[: max_lag + 1]


def _lagged_pairs(first: BoolArray, second: BoolArray, max_lag: int) -> Array:
    """How many samples of the first have one of the second k later, k = 0 … max_lag."""
    if first.size == second.size and first.all() and second.all():
        return first.size - np.arange(max_lag + 1.0)
    if max_lag < min(first.size, FEW_LAGS):
        there = (first[: first.size - k] & second[k:] for k in range(max_lag + 1))
        return np.array([float(np.count_nonzero(each)) for each in there])
    return np.rint(_lagged_sums(first.astype(float), second.astype(float), max_lag))
