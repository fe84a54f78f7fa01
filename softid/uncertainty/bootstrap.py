"""Block bootstrap: intervals by drawing residuals again in pieces that keep their memory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, UsageError
from softid.uncertainty.autoregression import AutoRegression, autocovariance, fit_ar
from softid.uncertainty.student import COVERAGE

Array = npt.NDArray[np.float64]

CI_METHOD = "block-bootstrap"
"""Name of this method in results."""

MIN_BLOCKS = 4
"""A segment is drawn in so many blocks at least where it has the samples, so that draws differ."""

FEWEST_RESIDUALS = 3
"""As many as a noise model needs, from which the length of a block is known."""

MAX_FAILED = 0.1
"""Share of bootstrap refits that may fail before the interval is refused."""


@dataclass(frozen=True, eq=False)
class BootstrapResult:
    """Estimates of the free parameters from residuals that were drawn again.

    Attributes
    ----------
    names
        Free parameters.
    estimates
        One row for each draw, shape (B, K), in the parameters' own units; NaN where a refit failed.
    block
        Samples in a block; a segment that holds fewer than four of them has shorter ones.
    """

    names: tuple[str, ...]
    estimates: Array
    block: int

    @property
    def failed(self) -> int:
        """How many refits failed."""
        return int(np.count_nonzero(~np.isfinite(self.estimates).all(axis=1)))

    @cached_property
    def ci95(self) -> dict[str, tuple[float, float]]:
        """Parameter → percentile interval.

        Raises
        ------
        IdentificationError
            More than a tenth of the refits failed.
        """
        limits = bootstrap_intervals(self.estimates).tolist()
        return {name: (low, high) for name, (low, high) in zip(self.names, limits, strict=True)}

    @property
    def stderr(self) -> dict[str, float]:
        """Parameter → standard deviation of its estimates.

        Raises
        ------
        IdentificationError
            More than a tenth of the refits failed.
        """
        good = self.estimates[_succeeded(self.estimates)]
        return dict(zip(self.names, np.std(good, axis=0, ddof=1).tolist(), strict=True))


def common_block(residuals: Iterable[Sequence[Array]]) -> int:
    """Block length for several channels that are drawn together, the longest of their own.

    It follows from the samples of all segments: a short one among them says nothing of the memory
    of the others, and `resample` shortens its blocks alone.

    Parameters
    ----------
    residuals
        Of every channel its segments of shape (n_s,); NaN where a sample is not used.
    """
    lengths = [1]
    for segments in residuals:
        n = sum(int(np.count_nonzero(np.isfinite(r))) for r in segments)
        lengths.append(block_length(fit_ar(segments), n))
    return max(lengths)


def block_length(ar: AutoRegression, n: int) -> int:
    """Block length that minimises the error of the variance of a mean.

    b = (2 G²/D)^{1/3} n^{1/3} with G = Σ |k| γ_k and D = (4/3)(Σ γ_k)², for blocks drawn in a
    circle; the autocovariance is that of the autoregression. At least 1, at most n/4.

    Parameters
    ----------
    ar
        Noise model of the residuals.
    n
        Samples in the record.

    Returns
    -------
    int
        Samples in a block.

    Notes
    -----
    D. N. Politis and H. White, Econom. Rev. 23 (2004) 53, with the correction of A. Patton,
    D. N. Politis and H. White, ibid. 28 (2009) 372.

    Examples
    --------
    >>> block_length(AutoRegression((0.9,), 1.0, (1 / 0.19) ** 0.5, 1000, 0.0, 0.0), 1000)
    52
    """
    if ar.order == 0 or n < 2:
        return 1
    gamma = autocovariance(ar, n)
    lags = np.arange(1, n)
    g = 2.0 * float(lags @ gamma[1:])
    total = float(gamma[0]) + 2.0 * float(gamma[1:].sum())
    spread = 4.0 / 3.0 * total**2
    best = (2.0 * g**2 / spread * n) ** (1.0 / 3.0) if spread > 0.0 else np.inf
    return int(np.clip(np.ceil(best), 1, max(1, n // MIN_BLOCKS)))


def resample(
    residuals: Sequence[Array],
    *,
    rng: np.random.Generator,
    block: int | None = None,
    fitted_parameters: int = 0,
) -> Iterator[tuple[Array, ...]]:
    """Draw residuals again without end, by moving blocks in a circle within each segment.

    Residuals are centred over all segments and stretched by √[n/(n − fitted_parameters)]. Samples
    that are not used stay where they are, and blocks run across them.

    Parameters
    ----------
    residuals
        Segments of shape (n_s,); NaN where a sample is not used.
    rng
        Source of randomness.
    block
        Block length in samples, of which a segment takes a quarter of its own at most; by default
        `block_length` of an autoregression for the samples of all.
    fitted_parameters
        Parameters that the fit took from these residuals.

    Yields
    ------
    tuple of array
        One array for each segment, NaN in the same places.

    Raises
    ------
    IdentificationError
        Fewer than three samples are used.
    UsageError
        The block length is below 1.

    Examples
    --------
    >>> draws = resample([np.array([1.0, -1.0, 2.0, -2.0])], rng=np.random.default_rng(1), block=2)
    >>> next(draws)[0].shape
    (4,)
    """
    if block is not None and block < 1:
        raise UsageError("a block holds at least one sample", value=block, remedy="give 1 or more")
    pools = [r[np.isfinite(r)] for r in residuals]
    n = sum(pool.size for pool in pools)
    if n < FEWEST_RESIDUALS:
        raise IdentificationError(
            "there are too few residuals to draw from",
            value=n,
            remedy="use a longer log or mask fewer samples",
        )
    length = block or block_length(fit_ar(residuals), n)
    mean = float(np.concatenate(pools).mean())
    stretch = float(np.sqrt(n / max(n - fitted_parameters, 1)))
    pools = [(pool - mean) * stretch for pool in pools]
    return _draws(residuals, pools, length, rng)


def _draws(
    residuals: Sequence[Array],
    pools: Sequence[Array],
    length: int,
    rng: np.random.Generator,
) -> Iterator[tuple[Array, ...]]:
    while True:
        drawn = []
        for residual, pool in zip(residuals, pools, strict=True):
            out = np.full(residual.size, np.nan)
            if pool.size:
                own = max(min(length, pool.size // MIN_BLOCKS), 1)
                out[np.isfinite(residual)] = pool[circular_blocks(pool.size, own, rng)]
            drawn.append(out)
        yield tuple(drawn)


def circular_blocks(n: int, block: int, rng: np.random.Generator) -> npt.NDArray[np.int64]:
    """Positions of one draw of n samples in blocks from a circle, shape (n,)."""
    starts = rng.integers(0, n, size=-(-n // block))
    return np.asarray((starts[:, None] + np.arange(block)).ravel()[:n] % n, dtype=np.int64)


def bootstrap_intervals(estimates: Array) -> Array:
    """95 % percentile intervals of bootstrap estimates.

    Parameters
    ----------
    estimates
        One row for each draw, shape (B, K); a row that is not finite is a refit that failed.

    Returns
    -------
    array
        Lower and upper limits, shape (K, 2).

    Raises
    ------
    IdentificationError
        More than a tenth of the refits failed.

    Notes
    -----
    Use 200 draws or more. Percentile intervals are too short when the record holds few
    independent blocks; `sandwich_covariance` allows for that.

    Examples
    --------
    >>> bootstrap_intervals(np.arange(101.0)[:, None]).round(6).tolist()
    [[2.5, 97.5]]
    """
    good = _succeeded(estimates)
    edges = [(1.0 - COVERAGE) / 2.0, (1.0 + COVERAGE) / 2.0]
    return np.asarray(np.quantile(estimates[good], edges, axis=0).T, dtype=np.float64)


def _succeeded(estimates: Array) -> npt.NDArray[np.bool_]:
    """Which refits have not failed, shape (B,); refused where too many have."""
    good = np.all(np.isfinite(estimates), axis=1)
    failed = 1.0 - float(good.mean()) if good.size else 1.0
    if failed > MAX_FAILED:
        raise IdentificationError(
            "too many bootstrap refits failed",
            value=f"{100 * failed:.0f} % of {good.size}",
            remedy="fix or bound the parameters that are not identified",
        )
    return np.asarray(good, np.bool_)
