"""Standard errors of quantities that are computed from the estimates."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Quantities = Mapping[str, tuple[float, str]]

RELATIVE_STEP = 1e-4
"""Relative step of the central differences."""

RESTS_ON = 0.01
"""A quantity rests on an undetermined parameter when it follows its relative changes by so much."""


def propagated_errors(
    compute: Callable[[Mapping[str, float]], Quantities],
    values: Mapping[str, float],
    names: Sequence[str],
    covariance: Array | None,
    *,
    undetermined: Collection[str] = (),
) -> dict[str, float | None]:
    """Standard errors of computed quantities to first order, √(gᵀ C g) with g = ∂q/∂θ.

    Quantities may be known where no parameter is, as a ratio of two that make up for each other.

    Parameters
    ----------
    compute
        Parameter values → quantity name → (value, unit).
    values
        The estimates.
    names
        The K parameters of the covariance.
    covariance
        On the linear scale, shape (K, K); None when there is none.
    undetermined
        Estimated parameters without a standard error.

    Returns
    -------
    dict
        One entry per quantity; None where it is not known, since it rests on an undetermined
        parameter.

    Examples
    --------
    >>> ratio = lambda v: {"ratio": (v["a"] / v["b"], "1")}
    >>> together = np.array([[4.0, 8.0], [8.0, 16.0]])  # a and b fail by the same factor
    >>> propagated_errors(ratio, {"a": 1.0, "b": 2.0}, ["a", "b"], together)["ratio"] < 1e-6
    True
    """
    found = compute(values)
    errors: dict[str, float | None] = dict.fromkeys(found)
    if covariance is None:
        return errors
    slopes = {name: _slopes(compute, values, name) for name in (*names, *undetermined)}
    for key, (value, _) in found.items():
        loose = (abs(slopes[k].get(key, 0.0) * values[k]) for k in undetermined)
        if any(not slope <= RESTS_ON * abs(value) for slope in loose):
            continue
        gradient = np.array([slopes[name].get(key, np.nan) for name in names])
        variance = float(gradient @ covariance @ gradient)
        if np.isfinite(variance):
            errors[key] = max(variance, 0.0) ** 0.5
    return errors


def _slopes(
    compute: Callable[[Mapping[str, float]], Quantities], values: Mapping[str, float], name: str
) -> dict[str, float]:
    step = RELATIVE_STEP * (abs(values[name]) or 1.0)
    up, down = (compute({**values, name: values[name] + move}) for move in (step, -step))
    return {key: (up[key][0] - down[key][0]) / (2.0 * step) for key in up if key in down}
