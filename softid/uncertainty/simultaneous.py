"""Noise that several channels of one recording share: one motion measured twice, one pressure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
import numpy.typing as npt

from softid.uncertainty.autoregression import autocovariance, fit_ar
from softid.uncertainty.lag_form import LagForm
from softid.uncertainty.linearisation import ResidualBlock, reachable
from softid.uncertainty.moments import gather_moments
from softid.uncertainty.restricted import restricted_ar

Array = npt.NDArray[np.float64]

LEAST_SAMPLES = 50
"""Fewer samples at which both channels are used say nothing about what they share."""

LEAST_SHARE = 1e-3
"""A sum of covariances whose smallest eigenvalue, relative to the variances, is below this is no
covariance but chance."""


def add_shared_noise(
    covariance: Array,
    blocks: Sequence[ResidualBlock],
    series: Sequence[Sequence[Array]],
) -> Array:
    """Add what channels that err together contribute to a covariance.

    With estimates δθ = Σ_t V_t u_t + Σ_t V'_t u'_t of two channels in units of their noise, the
    covariance of both at lag l is γ(l) = (γ₊(l) − γ₋(l))/4, γ₊ and γ₋ being the autocovariances
    of u + u' and u − u', and adds ½ [F(V + V') − F(V − V')] with F(V) = Σ V_tᵀ γ(t − s) V_s. A
    channel that leads the other is taken as if it did not.

    Parameters
    ----------
    covariance
        Σ over the blocks as if they were independent, shape (K, K).
    blocks
        Residuals, of which those with the same ``recording`` may share noise.
    series
        The influence W of every residual, per block and segment, shape (n_s, K).

    Returns
    -------
    numpy.ndarray
        The sum, shape (K, K); the covariance as it was where the channels share nothing that can
        be told from chance.
    """
    total = covariance
    for i, j in _pairs(blocks):
        own = [
            [w / block.weight for w in parts]
            for block, parts in ((blocks[i], series[i]), (blocks[j], series[j]))
        ]
        forms = [
            LagForm.of([v + sign * w for v, w in zip(*own, strict=True)]) for sign in (1.0, -1.0)
        ]
        lags = forms[0].lags
        gammas = [_autocovariance(blocks[i], blocks[j], sign, lags) for sign in (1, -1)]
        if any(gamma is None for gamma in gammas):
            continue
        both = 0.25 * (np.asarray(gammas[0]) - np.asarray(gammas[1]))
        total = total + 0.5 * (forms[0].matrix(both) - forms[1].matrix(both))
    return total if total is covariance or _is_covariance(total, covariance) else covariance


def _pairs(blocks: Sequence[ResidualBlock]) -> Iterator[tuple[int, int]]:
    for i, j in combinations(range(len(blocks)), 2):
        a, b = blocks[i], blocks[j]
        if a.recording is None or a.recording != b.recording or a.channel == b.channel:
            continue
        if [r.size for r in a.residuals] == [r.size for r in b.residuals]:
            yield i, j


def _autocovariance(a: ResidualBlock, b: ResidualBlock, sign: float, lags: int) -> Array | None:
    """Of u + sign·u' at the lags 0, 1, …; None with too few samples to tell."""
    residuals = tuple(
        a.weight * r + sign * b.weight * s for r, s in zip(a.residuals, b.residuals, strict=True)
    )
    if sum(int(np.isfinite(r).sum()) for r in residuals) < LEAST_SAMPLES:
        return None
    rows = tuple(a.weight * j + sign * b.weight * k for j, k in zip(a.rows, b.rows, strict=True))
    joint = ResidualBlock(f"{a.channel}, {b.channel}", rows, residuals)
    start = fit_ar(residuals)
    if start.sigma == 0.0:
        return np.zeros(lags)
    moments = gather_moments(residuals, reachable(joint), start.order)
    return autocovariance(restricted_ar(moments, start).ar, lags)


def _is_covariance(total: Array, independent: Array) -> bool:
    scale = np.sqrt(np.diag(independent))
    known = np.ix_(scale > 0.0, scale > 0.0)
    size = np.outer(scale, scale)[known]
    least, before = (float(np.linalg.eigvalsh(m[known] / size)[0]) for m in (total, independent))
    return least >= LEAST_SHARE * max(before, 0.0)
