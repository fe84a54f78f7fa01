"""What a fit leaves over, described as noise with a memory.

The residuals of real logs are autocorrelated: the misfit of a model wanders slowly and sensors are
filtered. Every interval, criterion and test of this package starts from the models made here.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.residuals import whiteness
from softid.results import NoiseModel
from softid.uncertainty.autoregression import (
    AutoRegression,
    autocovariance,
    contiguous_runs,
    fit_ar,
)

Array = npt.NDArray[np.float64]


FIRST_LAGS, MORE_LAGS = 4096, 8
"""Autocovariances are made for so many lags, and so many times more until they have faded."""


def effective_n(ar: AutoRegression, lengths: Sequence[int]) -> float:
    """Independent samples whose mean would be as uncertain as that of the coloured ones.

    n_e = N² γ_0 / Σ_s Σ_{|k|<n_s} (n_s − |k|) γ_k; below N for a persistent residual, above N for
    one that alternates.

    Parameters
    ----------
    ar
        The model.
    lengths
        Samples in each stretch.

    Examples
    --------
    >>> ar = AutoRegression((0.9,), 1.0, (1 / 0.19) ** 0.5, 1000, 0.0, 0.0)
    >>> round(effective_n(ar, [100000]))
    5264
    """
    total = int(sum(lengths))
    if ar.sigma == 0.0 or total == 0:
        return float(total)
    gamma = _until_faded(ar, max(lengths))
    variance = 0.0
    for n in lengths:
        lags = np.arange(1, min(n, gamma.size))
        variance += n * gamma[0] + 2.0 * float((n - lags) @ gamma[lags])
    return float(total**2 * gamma[0] / variance)


def _until_faded(ar: AutoRegression, n: int) -> Array:
    """Autocovariance at the lags below n, without the zeros at the end."""
    lags = min(n, FIRST_LAGS)
    gamma = autocovariance(ar, lags)
    while lags < n and np.any(gamma[-max(ar.order, 1) :]):
        lags = min(n, MORE_LAGS * lags)
        gamma = autocovariance(ar, lags)
    return gamma


def noise_model(
    channel: str,
    residuals: Sequence[Array],
    *,
    fitted_parameters: int = 0,
    ar: AutoRegression | None = None,
) -> NoiseModel:
    """Describe what a fit leaves over in one channel.

    Parameters
    ----------
    channel
        Output channel.
    residuals
        One residual per segment, shape (n_s,), canonical unit; NaN where a sample is not used.
    fitted_parameters
        Parameters that the fit took from these samples; the standard deviation is taken over
        n − fitted_parameters. They do not lower the degrees of freedom of the whiteness test, since
        they multiply inputs and not past residuals.
    ar
        A model already made, for example by `restricted_ar`; by default `fit_ar` of the residuals.

    Returns
    -------
    NoiseModel

    Raises
    ------
    IdentificationError
        Fewer than three samples are used.
    """
    model = fit_ar(residuals) if ar is None else ar
    runs = [run for residual in residuals for run in contiguous_runs(residual)]
    n = sum(run.size for run in runs)
    power = sum(float(run @ run) for run in runs)
    test = whiteness(residuals)
    return NoiseModel(
        channel=channel,
        sigma=float(np.sqrt(power / max(n - fitted_parameters, 1))),
        innovation_sigma=model.sigma_innovation,
        ar=model.phi,
        white=test.is_white,
        ljung_box_p=test.p_value,
        effective_n=min(effective_n(model, [run.size for run in runs]), float(n)),
    )
