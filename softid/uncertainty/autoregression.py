"""Autoregressions: fit, autocovariance, whitening and likelihood.

An autoregression counts samples, not seconds; on an irregularly sampled log it describes the
residual per sample.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, UsageError
from softid.kernels.autocovariances import fill_autocovariances
from softid.long_series import innovation_power
from softid.uncertainty.burg import burg

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

MAX_ORDER = 8
"""Highest order tried: enough for a slow wander plus white sensor noise at the orders measured in
``tests/benchmarks/coverage_of_intervals.py``."""

_FADED = 1e-18
"""Share of the variance below which autocovariances count as zero: even a hundred of them are lost
in the rounding of the variance."""


@dataclass(frozen=True)
class AutoRegression:
    """A stable autoregression r_k = Σ φ_j r_{k−j} + e_k.

    Attributes
    ----------
    phi
        Coefficients φ_1 … φ_p; empty for white noise.
    sigma_innovation
        Standard deviation of e, in the unit of the residual.
    sigma
        Standard deviation of r that the model implies.
    n
        Samples used.
    aicc, bic
        Criteria of this order, by which it was chosen.
    """

    phi: tuple[float, ...]
    sigma_innovation: float
    sigma: float
    n: int
    aicc: float
    bic: float

    @property
    def order(self) -> int:
        """Number of coefficients."""
        return len(self.phi)


def contiguous_runs(values: Array) -> list[Array]:
    """Split at unused samples.

    Parameters
    ----------
    values
        Samples, shape (n,); NaN where the sample is not used.

    Returns
    -------
    list of array
        Stretches without NaN, in order.

    Examples
    --------
    >>> [run.tolist() for run in contiguous_runs(np.array([1.0, 2.0, np.nan, 3.0]))]
    [[1.0, 2.0], [3.0]]
    """
    return [values[span] for span in run_slices(np.isfinite(values))]


def run_slices(used: BoolArray) -> list[slice]:
    """Slices of the stretches in which ``used``, shape (n,), is True."""
    if used.all():
        return [slice(0, used.size)] if used.size else []
    edges = np.flatnonzero(np.diff(np.concatenate(([False], used, [False])).astype(np.int8)))
    return [slice(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def fit_ar(residuals: Sequence[Array], *, max_order: int = MAX_ORDER) -> AutoRegression:
    """Fit one autoregression to several stretches by Burg's recursion, of the order of least AICc.

    Reflection coefficient m from forward and backward errors f, b of order m − 1, summed over all
    stretches: k_m = 2 Σ f_t b_{t−1} / Σ (f_t² + b_{t−1}²), so |k_m| < 1 and the model is stable.
    The mean square of the data is kept exactly, so a persistent residual cannot blow up, and the
    recursion ends when a millionth of it is left. No mean is removed: a bias of the model is part
    of what it leaves over.

    Parameters
    ----------
    residuals
        Stretches of shape (n_s,) in one unit; NaN where a sample is not used.
    max_order
        Highest order tried; kept below a quarter of the longest stretch.

    Returns
    -------
    AutoRegression
        The model of the chosen order.

    Raises
    ------
    IdentificationError
        Fewer than three samples are used.
    UsageError
        The order is negative.

    Notes
    -----
    J. P. Burg, *Maximum Entropy Spectral Analysis*, thesis, Stanford 1975; summed over stretches
    as in S. de Waele and P. M. T. Broersen, IEEE Trans. Signal Process. 48 (2000) 2876.
    C. M. Hurvich and C.-L. Tsai, Biometrika 76 (1989) 297, for AICc.

    Examples
    --------
    >>> walk = np.cumsum(np.random.default_rng(0).normal(size=500))
    >>> fit_ar([walk - walk.mean()]).phi[0] > 0.9
    True
    """
    if max_order < 0:
        raise UsageError(
            "no such autoregression", value=max_order, remedy="give an order of at least 0"
        )
    runs = [run for residual in residuals for run in contiguous_runs(residual)]
    n = sum(run.size for run in runs)
    if n < 3:
        raise IdentificationError(
            "a noise model needs at least three residuals",
            value=n,
            remedy="use a longer log or mask fewer samples",
        )
    longest = max(run.size for run in runs)
    power = sum(float(run @ run) for run in runs) / n
    reflection = burg(runs, min(max_order, max(0, longest // 4 - 1)))
    if power == 0.0:
        return AutoRegression((), 0.0, 0.0, n, -np.inf, -np.inf)
    criteria = order_criteria(reflection, power, n)
    order = int(np.argmin(criteria["aicc"]))
    innovation = np.sqrt(power * np.prod(1.0 - reflection[:order] ** 2))
    return AutoRegression(
        phi=tuple(to_phi(reflection[:order]).tolist()),
        sigma_innovation=float(innovation),
        sigma=float(np.sqrt(power)),
        n=n,
        aicc=float(criteria["aicc"][order]),
        bic=float(criteria["bic"][order]),
    )


def order_criteria(reflection: Array, power: float, n: int) -> dict[str, Array]:
    """AICc and BIC of the orders 0 … len(reflection), from the innovation variances."""
    variance = power * np.concatenate(([1.0], np.cumprod(1.0 - reflection**2)))
    count = np.arange(variance.size) + 1.0
    fit = n * np.log(variance)
    room = np.maximum(n - count - 1.0, 1e-9)
    return {
        "aicc": fit + 2.0 * count * n / room,
        "bic": fit + count * np.log(n),
    }


def to_phi(reflection: Array) -> Array:
    """Coefficients φ from reflection coefficients (Levinson's step up)."""
    phi = np.zeros(0)
    for k in reflection:
        phi = np.concatenate((phi - k * phi[::-1], [k]))
    return phi


def to_reflection(phi: Array) -> Array:
    """Reflection coefficients from coefficients φ of a stable model (step down)."""
    out = np.zeros(phi.size)
    for m in range(phi.size, 0, -1):
        k = phi[-1]
        out[m - 1] = k
        phi = (phi[:-1] + k * phi[-2::-1]) / (1.0 - k * k) if m > 1 else phi[:0]
    return out


def predictors(phi: Array) -> tuple[list[Array], Array]:
    """Best linear predictors of orders 0 … p and their relative error variances.

    Returns
    -------
    coefficients
        For each order m, the coefficients of the m samples before, nearest first, shape (m,).
    ratio
        Error variance of order m over the innovation variance, shape (p + 1,); ends at 1.
    """
    reflection = to_reflection(phi)
    coefficients = [to_phi(reflection[:m]) for m in range(phi.size + 1)]
    falls = np.concatenate(([1.0], np.cumprod(1.0 - reflection**2)))
    return coefficients, falls / falls[-1]


def autocovariance(ar: AutoRegression, n: int) -> Array:
    """Autocovariance that the model implies, exactly.

    γ_m = Σ_{j≤m} φ^{(m)}_j γ_{m−j} with the predictors of order m for m ≤ p, and the recursion
    γ_k = Σ φ_j γ_{k−j} from there on.

    Parameters
    ----------
    ar
        The model.
    n
        Number of lags, from 0 to n − 1.

    Returns
    -------
    array
        Shape (n,), in the squared unit of the residual.

    Examples
    --------
    >>> ar = AutoRegression((0.5,), 1.0, (4 / 3) ** 0.5, 100, 0.0, 0.0)
    >>> autocovariance(ar, 3).round(6).tolist()
    [1.333333, 0.666667, 0.333333]
    """
    reflection = to_reflection(np.asarray(ar.phi))
    unit: Array = autocovariances(reflection[None], n)[0]
    return unit * ar.sigma_innovation**2


def autocovariances(reflection: Array, n: int) -> Array:
    """Autocovariances of several models for unit innovations, as `autocovariance`.

    Parameters
    ----------
    reflection
        Reflection coefficients, shape (B, p).
    n
        Number of lags, from 0 to n − 1.

    Returns
    -------
    array
        Shape (B, n).
    """
    count, order = reflection.shape
    gamma = np.zeros((max(n, order + 1), count))
    fill_autocovariances(np.ascontiguousarray(reflection), _FADED, gamma)
    return np.ascontiguousarray(gamma[:n].T)


def whiten(ar: AutoRegression, values: Array) -> Array:
    """Turn coloured residuals, or columns of their Jacobian, into uncorrelated ones.

    w_t = y_t − Σ φ_j y_{t−j}, of variance ``sigma_innovation``². The first p samples of every
    stretch are predicted from the fewer samples before them and scaled to the same variance, which
    is what the Cholesky factor of their covariance does; no sample is lost.

    Parameters
    ----------
    ar
        The model.
    values
        One log segment, shape (n,) or (n, K); NaN where a sample is not used.

    Returns
    -------
    array
        Same shape; zero where a sample is not used, so that it adds nothing to a sum of squares.

    Examples
    --------
    >>> ar = AutoRegression((0.6,), 1.0, 1.25, 100, 0.0, 0.0)
    >>> whiten(ar, np.array([1.25, 0.75, 0.45])).round(6).tolist()
    [1.0, 0.0, 0.0]
    """
    table = values[:, None] if values.ndim == 1 else values
    out = np.zeros_like(table)
    for span in run_slices(np.all(np.isfinite(table), axis=1)):
        out[span] = _whiten_run(np.asarray(ar.phi), table[span])
    return out[:, 0] if values.ndim == 1 else out


def _whiten_run(phi: Array, y: Array) -> Array:
    order = phi.size
    coefficients, ratio = predictors(phi)
    w = y.copy()
    for j, coefficient in enumerate(phi, 1):
        w[order:] -= coefficient * y[order - j : max(y.shape[0], order) - j]
    for t in range(min(order, y.shape[0])):
        w[t] = (y[t] - coefficients[t] @ y[:t][::-1]) / np.sqrt(ratio[t])
    return w


def log_likelihood(ar: AutoRegression, residuals: Sequence[Array]) -> float:
    """Gaussian log likelihood of several stretches, exact from their first sample on.

    ℓ = −½ Σ_t [log 2π v_t + w_t²/σ²], with v_t the error variance of the predictor used at t.

    Parameters
    ----------
    ar
        The model.
    residuals
        Segments of shape (n_s,); NaN where a sample is not used.

    Returns
    -------
    float
        The natural logarithm; infinite when the model has no noise.
    """
    if ar.sigma_innovation == 0.0:
        return np.inf
    phi = np.asarray(ar.phi)
    _, ratio = predictors(phi)
    total = 0.0
    for run in (r for segment in residuals for r in contiguous_runs(segment)):
        first = _whiten_run(phi, run[: ar.order, None])
        power = float(np.sum(first**2)) + innovation_power(run, phi)
        variance = ar.sigma_innovation**2
        total += power / variance + run.size * np.log(2.0 * np.pi * variance)
        total += float(np.sum(np.log(ratio[: min(run.size, ar.order)])))
    return -0.5 * total
