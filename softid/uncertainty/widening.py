"""Standard errors that are no smaller than what is known to scatter the parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from softid.uncertainty.covariance import Covariance


def widened(covariance: Covariance, least_sd: Mapping[str, float]) -> Covariance:
    r"""The covariance C with deviations of at least the given ones, D C D.

    D is diagonal with max(1, s/sd) for a least deviation s: correlations stay. The noise is
    inflated by D², and so is the rise of the cost at one standard deviation.

    Parameters
    ----------
    covariance
        What the residuals tell.
    least_sd
        Parameter → least standard deviation in internal coordinates; others stay as they are.
    """
    factors = np.ones(len(covariance.names))
    for k, (name, sd) in enumerate(zip(covariance.names, covariance.sd, strict=True)):
        if sd:
            factors[k] = max(1.0, least_sd.get(name, 0.0) / sd)
    sds = zip(covariance.sd, factors.tolist(), strict=True)
    return replace(
        covariance,
        matrix=covariance.matrix * np.outer(factors, factors),
        sd=tuple(sd if sd is None else sd * factor for sd, factor in sds),
        inflation=covariance.inflation * factors**2,
        cost_per_variance=covariance.cost_per_variance * factors**2,
    )


def larger_of(*deviations: Mapping[str, float]) -> dict[str, float]:
    """The largest deviation of each name among several.

    Parameters
    ----------
    deviations
        Name → deviation, each of some of the names.

    Examples
    --------
    >>> larger_of({"Q": 0.1, "N": 0.3}, {"Q": 0.2})
    {'Q': 0.2, 'N': 0.3}
    """
    found: dict[str, float] = {}
    for given in deviations:
        for name, sd in given.items():
            found[name] = max(sd, found.get(name, 0.0))
    return found
