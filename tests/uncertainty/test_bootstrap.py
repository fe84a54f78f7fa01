"""Block bootstrap: block length, what a draw keeps, and how often intervals cover."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from noise import ar1

from softid.errors import IdentificationError, UsageError
from softid.uncertainty import (
    AutoRegression,
    block_length,
    bootstrap_intervals,
    fit_ar,
    resample,
)
from softid.uncertainty.bootstrap import BootstrapResult, circular_blocks, common_block


def model(rho: float) -> AutoRegression:
    return AutoRegression((rho,), 1.0, (1.0 / (1.0 - rho**2)) ** 0.5, 0, 0.0, 0.0)


def test_block_length_of_an_ar1() -> None:
    """Closed form: G = 2ρ/(1 − ρ)² γ_0, Σγ = (1 + ρ)/(1 − ρ) γ_0, b = (1.5 (G/Σγ)² n)^{1/3}."""
    rho, n = 0.8, 5000
    ratio = 2.0 * rho / (1.0 - rho) ** 2 / ((1.0 + rho) / (1.0 - rho))
    assert block_length(model(rho), n) == int(np.ceil((1.5 * ratio**2 * n) ** (1.0 / 3.0)))


def test_block_length_has_limits() -> None:
    """White noise needs no blocks; four of them must fit into a short persistent record."""
    assert block_length(AutoRegression((), 1.0, 1.0, 0, 0.0, 0.0), 100) == 1
    assert block_length(model(0.999), 40) == 10


def test_a_draw_consists_of_blocks_from_a_circle() -> None:
    """Within a block positions rise by one, modulo n."""
    found = circular_blocks(23, 5, np.random.default_rng(1))
    assert found.size == 23
    inside = np.arange(1, 23) % 5 != 0
    np.testing.assert_array_equal(np.diff(found)[inside] % 23, 1)


def test_resampling_keeps_gaps_size_and_memory() -> None:
    """NaN stay; the variance grows by n/(n − k); the record's own lag-one correlation survives.

    200 draws, blocks of 50: of the memory a share 1/50 is cut, and the tolerance is 5 %.
    """
    residual = ar1(np.random.default_rng(2), 1500, 0.9)
    residual -= residual.mean()
    residual[300:310] = np.nan
    draws = resample([residual], rng=np.random.default_rng(3), block=50, fitted_parameters=149)
    table = np.array([parts[0] for parts in islice(draws, 200)])
    assert np.isnan(table[:, 300:310]).all()
    assert np.isfinite(np.delete(table, slice(300, 310), axis=1)).all()
    stretch = 1490.0 / (1490.0 - 149.0)
    assert np.nanvar(table) == pytest.approx(stretch * np.nanvar(residual), rel=0.05)
    pair = np.nanmean(table[:, :299] * table[:, 1:300]) / np.nanvar(table)
    own = np.nanmean(residual[:-1] * residual[1:]) / np.nanvar(residual)
    assert pair == pytest.approx((1.0 - 1.0 / 50.0) * own, rel=0.05)


@given(
    rho=st.floats(0.5, 0.97),
    shorts=st.lists(st.integers(1, 12), max_size=5),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=20, deadline=None)
def test_short_segments_do_not_shorten_the_blocks_of_long_ones(
    rho: float, shorts: list[int], seed: int
) -> None:
    """The best length grows with n^(1/3): a few samples more of the same noise add next to nothing.

    It was one sample beside a segment of six. In a draw among thirty the few samples tip the order
    of the autoregression, which moves the length by a fifth; the median of nine draws is judged.
    """
    rng = np.random.default_rng(seed)
    ratios = []
    for _ in range(9):
        long = [ar1(rng, 1500, rho), ar1(rng, 1500, rho)]
        block = common_block([[*long, *(ar1(rng, n, rho) for n in shorts)]])
        ratios.append(block / common_block([long]))
    assert np.median(ratios) == pytest.approx(1.0, abs=0.06)


@given(
    sizes=st.lists(st.integers(0, 60), min_size=1, max_size=6).filter(lambda s: sum(s) > 2),
    block=st.integers(1, 200),
)
@settings(max_examples=60, deadline=None)
def test_a_segment_is_drawn_in_four_blocks_at_least(sizes: list[int], block: int) -> None:
    """Samples that are their own places: within a block they rise by one, however long the block
    that was asked for, and every segment draws of its own alone."""
    places = [np.arange(n, dtype=float) for n in sizes]
    drawn = next(resample(places, rng=np.random.default_rng(8), block=block))
    mean = float(np.concatenate(places).mean())
    for n, part in zip(sizes, drawn, strict=True):
        own = max(min(block, n // 4), 1)
        found = np.rint(part + mean).astype(int)
        assert found.size == n
        assert set(found.tolist()) <= set(range(n))
        inside = np.arange(1, n) % own != 0
        assert np.all(np.diff(found)[inside] % max(n, 1) == 1 % max(n, 1))


def test_errors_do_not_depend_on_a_short_segment() -> None:
    """Mean of AR(1) 0.97 in two long segments with six samples between them: its standard error is
    that of the noise's memory, √[(1 + ρ)/(1 − ρ)/n], to the third that blocks of n^(1/3) and 400
    draws of one record leave; it was a ninth of that."""
    rng = np.random.default_rng(9)
    segments = [ar1(rng, n, 0.97) for n in (2000, 6, 2000)]
    n = sum(part.size for part in segments)
    exact = np.sqrt(1.97 / 0.03 / n)
    draws = resample(segments, rng=rng, block=common_block([segments]))
    means = [np.concatenate(parts).mean() for parts in islice(draws, 400)]
    assert np.std(means) == pytest.approx(exact, rel=1.0 / 3.0)
    own = [np.concatenate(parts).mean() for parts in islice(resample(segments, rng=rng), 400)]
    assert np.std(own) == pytest.approx(exact, rel=1.0 / 3.0)


def test_the_same_seed_gives_the_same_draws() -> None:
    """Randomness comes from the generator alone, the block length from the residuals."""
    residuals = [ar1(np.random.default_rng(4), 100, 0.5), ar1(np.random.default_rng(5), 60, 0.5)]
    first, second = (next(resample(residuals, rng=np.random.default_rng(6))) for _ in range(2))
    for a, b in zip(first, second, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_given_block_needs_no_noise_model(monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes longer than a draw, and refits of a bootstrap give the same block every time."""
    residuals = [ar1(np.random.default_rng(4), 100, 0.5)]
    length = block_length(fit_ar(residuals), 100)
    (own,) = next(resample(residuals, rng=np.random.default_rng(6)))
    monkeypatch.delattr("softid.uncertainty.bootstrap.fit_ar")
    (given,) = next(resample(residuals, rng=np.random.default_rng(6), block=length))
    np.testing.assert_array_equal(own, given)


def test_bootstrap_errors_agree_with_theory() -> None:
    """Slope of a line under AR(1) 0.7: the exact standard error to 20 % (400 draws, one record)."""
    rng = np.random.default_rng(7)
    n = 3000
    x = np.linspace(-1.0, 1.0, n)
    project = x / (x @ x)
    gamma = 0.7 ** np.arange(n)
    lagged = np.correlate(project, project, "full")[n - 1 :]
    exact = np.sqrt(gamma[0] * lagged[0] + 2.0 * gamma[1:] @ lagged[1:])
    draws = resample([ar1(rng, n, 0.7)], rng=rng)
    slopes = np.array([[project @ parts[0]] for parts in islice(draws, 400)])
    assert slopes.std() == pytest.approx(exact, rel=0.2)
    low, high = bootstrap_intervals(slopes)[0]
    assert high - low == pytest.approx(2.0 * 1.96 * slopes.std(), rel=0.15)


def test_failed_refits_are_left_out_or_refused() -> None:
    """Two of 102 rows failed: quantiles of the others; half of them: no interval."""
    rows = np.concatenate((np.arange(101.0), [np.nan]))[:, None]
    np.testing.assert_allclose(bootstrap_intervals(rows), [[2.5, 97.5]])
    with pytest.raises(IdentificationError, match="50 %"):
        bootstrap_intervals(np.array([[1.0], [np.nan]]))
    found = BootstrapResult(("M",), rows, 1)
    assert found.stderr["M"] == pytest.approx(np.arange(101.0).std(ddof=1))
    half = BootstrapResult(("M",), np.array([[1.0], [2.0], [np.nan], [np.nan]]), 1)
    with pytest.raises(IdentificationError, match="50 %"):
        _ = half.stderr


def test_mistakes_are_named() -> None:
    """Blocks of nothing, and blocks out of nothing."""
    with pytest.raises(IdentificationError, match="too few residuals"):
        resample([np.full(9, np.nan)], rng=np.random.default_rng(12), block=2)
    with pytest.raises(UsageError):
        resample([np.ones(9)], rng=np.random.default_rng(12), block=0)
