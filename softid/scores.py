"""How well a simulated output follows a measured one.

Plain arrays in; a NaN on either side is a sample that does not count.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.long_series import difference_powers, power_about
from softid.results import FitStatistics

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


def fit_percent(measured: Array, simulated: Array) -> float:
    """Fit 100 (1 − ‖y − ŷ‖/‖y − mean y‖), as MATLAB's ``compare``; NaN for a constant y."""
    y, s = _pairs(measured, simulated)
    return 100.0 * (1.0 - _nrmse(difference_powers(y, s)[0], _spread(y)))


def are_too_few(samples: int, unknowns: int) -> bool:
    """Whether what was estimated on a log alone may follow its samples, whatever they are.

    One more sample than unknowns has next to nothing left by which a response could be judged.

    Parameters
    ----------
    samples, unknowns
        Number of samples of an output, and of zeros and initial states that were estimated on them.
    """
    return samples <= unknowns + 1


def fit_statistics(
    measured: Array,
    simulated: Array,
    *,
    log: str,
    channel: str,
    unit: str,
    in_sample: bool,
    used: BoolArray | None = None,
    display_unit: str | None = None,
    display_factor: float = 1.0,
) -> FitStatistics:
    """Score a simulated output against a measured one.

    Parameters
    ----------
    measured, simulated
        Samples, shape (n,), in ``unit``.
    log, channel, unit
        What is compared.
    in_sample
        Whether the parameters were fitted to this log.
    used
        Samples to compare, shape (n,); by default those that are finite in both.
    display_unit, display_factor
        Unit of the file and the factor to it; by default ``unit``.

    Returns
    -------
    FitStatistics
        The relative scores are NaN when the measurement is constant.

    Raises
    ------
    InputError
        No sample can be compared.

    Examples
    --------
    >>> y = np.array([0.0, 1.0, 2.0])
    >>> s = fit_statistics(y, y, log="a", channel="angle", unit="rad", in_sample=True)
    >>> s.n, s.fit_percent
    (3, 100.0)
    """
    whole = measured if used is None or used.all() else np.where(used, measured, np.nan)
    y, s = _pairs(whole, simulated, where=f"{log}, {channel}")
    (square, apart), spread = difference_powers(y, s), _spread(y)
    relative = _nrmse(square, spread)
    return FitStatistics(
        log=log,
        channel=channel,
        unit=unit,
        in_sample=in_sample,
        kind="simulated",
        n=y.size,
        rmse=math.sqrt(square / y.size),
        nrmse=relative,
        fit_percent=100.0 * (1.0 - relative),
        r2=1.0 - relative**2,
        vaf=_vaf(apart, spread),
        display_unit=unit if display_unit is None else display_unit,
        display_factor=display_factor,
    )


def _spread(y: Array) -> float:
    """‖y − mean y‖², zero for a constant."""
    return power_about(y, float(y.mean())) if np.ptp(y) > 0.0 else 0.0


def _nrmse(square: float, spread: float) -> float:
    """Normalised error ‖y − ŷ‖/‖y − mean y‖, from the squares of both."""
    return math.sqrt(square / spread) if spread > 0.0 else float("nan")


def _vaf(square: float, spread: float) -> float:
    """Variance accounted for, 100 (1 − var(y − ŷ)/var y), from both times the samples."""
    return 100.0 * (1.0 - square / spread) if spread > 0.0 else float("nan")


def _pairs(measured: Array, simulated: Array, where: str | None = None) -> tuple[Array, Array]:
    there = np.isfinite(measured) & np.isfinite(simulated)
    if there.all():
        return measured, simulated
    if not there.any():
        raise InputError("there is no sample to compare", where=where, remedy="mask fewer samples")
    return measured[there], simulated[there]
