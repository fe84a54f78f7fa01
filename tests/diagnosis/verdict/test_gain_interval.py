"""The interval of the gain by blocks that are longer than the memory of the residuals."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from noise import ar1, coloured

from softid.diagnosis.verdict.gain_interval import FEWEST_SAMPLES, gain_interval

Array = npt.NDArray[np.float64]

PERIOD_S = 0.01
DRAWS = 300


def drawn(seed: int, runs: tuple[int, ...], time_s: float) -> list[Array]:
    """Three independent residuals, each run of which begins anew."""
    rng = np.random.default_rng(seed)
    return [np.concatenate([coloured(rng, n, time_s, PERIOD_S) for n in runs]) for _ in range(3)]


@pytest.mark.parametrize(
    ("runs", "time_s"),
    [
        ((480,), 0.0),
        ((400,), 0.3),
        ((400,), 1.0),
        ((2000,), 1.0),
        ((6000,), 1.0),
        ((80,) * 5, 0.1),
        ((80,) * 5, 0.5),
        ((1000,) * 2, 1.0),
    ],
)
def test_the_interval_covers_a_known_gain(runs: tuple[int, ...], time_s: float) -> None:
    """Closed form: noise of 1 under a misfit of 2 that is mended, 1 − 1/√5, however slow both are.

    Of 300 intervals 95 % are meant to cover it, ±1.3 %. Four of that are allowed, and a bias of the
    memory that records of four to twenty correlation times leave: 90 % is what `softid.uncertainty`
    measures for the mean of three.
    """
    true, hits, widths = 1.0 - 1.0 / np.sqrt(5.0), 0, []
    for seed in range(DRAWS):
        noise, misfit, _ = drawn(seed, runs, time_s)
        interval = gain_interval(noise + 2.0 * misfit, noise, runs)
        assert interval is not None
        hits += interval[0] <= true <= interval[1]
        widths.append(interval[1] - interval[0])
    least = 0.90 if time_s == 0.0 else 0.90 - 4.0 * 0.013
    assert hits / DRAWS >= least
    if time_s == 0.0:
        assert np.median(widths) < 0.1


@pytest.mark.parametrize("time_s", [0.1, 0.5])
def test_what_gains_nothing_seldom_seems_to(time_s: float) -> None:
    """Known truth: two residuals of one law, half of each its own, in five blocks of 0.8 s.

    2.5 % of 300 draws are meant to lie above zero, ±0.9 %, of which four are allowed; they were
    more than 13 % when a block was a 24th of the samples.
    """
    runs, sure = (80,) * 5, 0
    for seed in range(DRAWS):
        common, one, other = drawn(seed, runs, time_s)
        interval = gain_interval(common + 0.5 * one, common + 0.5 * other, runs)
        assert interval is not None
        sure += interval[0] > 0.0
    assert sure / DRAWS <= 0.025 + 4.0 * 0.009


@pytest.mark.parametrize("memory", [30, 100, 300, 1000])
@pytest.mark.parametrize("share", [0.5, 2.0])
def test_slow_residuals_without_a_gain_seldom_seem_to(memory: int, share: float) -> None:
    """Known truth: 1500 samples of AR(1) residuals of one law, of which the own part is a share.

    Of 400 draws the lower end may be cut off at 0 in 1/64, ±0.6 %, of which four are allowed. All
    six parts gained in up to 11 %, and the end was cut off in all of these. 90 % is the coverage
    that the other records of few correlation times are held to, ±1.1 %.
    """
    draws, cut, missed = 400, 0, 0
    for seed in range(draws):
        rng = np.random.default_rng(seed)
        common, one, other = (ar1(rng, 1500, float(np.exp(-1.0 / memory))) for _ in range(3))
        interval = gain_interval(common + share * one, common + share * other)
        assert interval is not None
        cut += interval[0] == 0.0
        missed += not interval[0] <= 0.0 <= interval[1]
    assert cut / draws <= 1.0 / 64.0 + 4.0 * 0.006
    assert missed / draws <= 0.10 + 4.0 * 0.011


def test_blocks_end_where_runs_do() -> None:
    """Closed form: five runs in each of which the residuals keep one value know five numbers, by
    Student's t with four degrees of freedom; their order does not matter."""
    before = np.repeat([1.0, 1.1, 0.9, 1.2, 0.8], 80)
    after = np.repeat([0.5, 0.5, 0.6, 0.4, 0.5], 80)
    found = gain_interval(before, after, (80,) * 5)
    assert found is not None
    s0, s1 = float(np.mean(before**2)), float(np.mean(after**2))
    psi = 0.5 * (after[::80] ** 2 / s1 - before[::80] ** 2 / s0)
    half = 2.7764451 * float(np.sqrt(psi @ psi / (5.0 * 4.0)))
    ratio = np.sqrt(s1 / s0)
    assert found == pytest.approx((1.0 - ratio * np.exp(half), 1.0 - ratio * np.exp(-half)))
    order = np.concatenate([np.arange(k, k + 80) for k in (160, 0, 320, 80, 240)])
    assert gain_interval(before[order], after[order], (80,) * 5) == pytest.approx(found, rel=1e-3)


def test_no_interval_of_few_samples() -> None:
    """Fewer than 192, and both errors belong to the same samples."""
    values = np.random.default_rng(0).standard_normal(FEWEST_SAMPLES)
    assert gain_interval(values, 0.5 * values) == pytest.approx((0.5, 0.5))
    assert gain_interval(values[1:], 0.5 * values[1:]) is None
    assert gain_interval(values, values[1:]) is None
    assert gain_interval(np.empty(0), np.empty(0)) is None


def test_no_interval_of_a_response_that_ran_away() -> None:
    """Before or after: a model without an error has no gain either."""
    values = np.random.default_rng(0).standard_normal(480)
    for lost in (np.full(480, np.nan), np.zeros(480)):
        assert gain_interval(values, lost) is None
        assert gain_interval(lost, values) is None


def test_no_gain_and_a_loss() -> None:
    """Closed form: the same error gains nothing, a doubled one loses its whole size."""
    values = np.random.default_rng(0).standard_normal(400)
    assert gain_interval(values, values) == pytest.approx((0.0, 0.0))
    assert gain_interval(values, 2.0 * values) == pytest.approx((-1.0, -1.0))


@pytest.mark.parametrize(("share", "loses"), [(0.9, False), (1.1, True)])
def test_a_slow_misfit_that_is_mended_everywhere_is_no_loss(share: float, loses: bool) -> None:
    """A drift is a single event to its memory; in each of six parts the error falls, or in five."""
    noise = 0.1 * np.random.default_rng(0).standard_normal(1200)
    before = np.linspace(1.0, 4.0, 1200) + noise
    after = noise.copy()
    after[:200] = share * before[:200]
    found = gain_interval(before, after)
    assert found is not None
    assert (found[0] < 0.0) is loses
