"""A covariance that was found from averages, with what the samples themselves know."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.uncertainty.covariance import Covariance

Array = npt.NDArray[np.float64]


def known_better(averaged: Covariance, information: Array) -> Covariance:
    """Standard deviations of averages, each less by what averaging loses of its information.

    An average over a few samples misses what a parameter does within them, and all the more so the
    faster that is. Under white noise its standard deviation is too large by √((Hₐ⁻¹)ₖₖ/(H⁻¹)ₖₖ),
    Hₐ being the information of the averages and H that of the samples. Slow noise is weaker where
    the samples know more than the averages do, so there too it does not become too small.

    Parameters
    ----------
    averaged
        From the averages.
    information
        H = Σ w² JᵀJ over all samples in the same coordinates, shape (K, K).

    Returns
    -------
    Covariance
        The same where a direction is undetermined.
    """
    determined = np.array([sd is not None for sd in averaged.sd], bool)
    scale = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
    scaled = information / np.outer(scale, scale)
    if not determined.all() or np.linalg.matrix_rank(scaled, hermitian=True) < scale.size:
        return averaged
    before = np.diag(averaged.matrix) / averaged.cost_per_variance
    after = np.diag(np.linalg.inv(scaled)) / scale**2
    lower = np.sqrt(np.minimum(after / before, 1.0))
    values = np.linalg.eigvalsh(scaled)
    return replace(
        averaged,
        matrix=averaged.matrix * np.outer(lower, lower),
        sd=tuple(float(lower[k] * (sd or 0.0)) for k, sd in enumerate(averaged.sd)),
        condition_number=float(np.sqrt(values[-1] / values[0])),
    )
