"""Quantisation, hold, dead band and noise are found with the size that was put in."""

from __future__ import annotations

import numpy as np
import pytest

from softid.excitation import (
    SampleHold,
    find_dead_band,
    find_hold,
    find_quantisation,
    noise_std,
)
from softid.excitation.texture import fresh_samples


def moving(n: int, seed: int, *, noise: float = 1.0) -> np.ndarray:
    """A slow swing of 100 with white noise."""
    rng = np.random.default_rng(seed)
    return 100.0 * np.sin(np.arange(n) * 2e-3) + noise * rng.standard_normal(n)


@pytest.mark.parametrize("step", [0.842468, 0.1089987, 0.0152951])
def test_a_step_survives_rounding_in_the_file(step: float) -> None:
    """Values k·step printed with three decimals, as rigs do: least squares averages to 1e-3."""
    values = np.round(step * np.round(moving(2000, 0) / step), 3)
    found = find_quantisation(values)
    assert found is not None
    assert found.step == pytest.approx(step, rel=1e-3)
    span = np.ptp(values) / step + 1.0
    assert found.bits == pytest.approx(np.log2(span), abs=0.01)


def test_no_grid_in_floats() -> None:
    """Uniform residues lie within 0.15 steps of a grid 30 % of the time, 95 % are asked for."""
    assert find_quantisation(moving(2000, 1)) is None


def test_two_levels_are_no_grid() -> None:
    """A square wave says nothing of a sensor's resolution."""
    assert find_quantisation(np.repeat([0.0, 60.0, 0.0], 50)) is None


@pytest.mark.parametrize("factor", [2, 3, 5, 17])
@pytest.mark.parametrize("step", [0.0, 0.02, 0.5, 1.0])
def test_a_regular_hold(factor: int, step: float) -> None:
    """Every k-th sample repeated: the factor is k, whether or not the values are quantised."""
    n = 6000
    values = moving(n, factor)[(np.arange(n) // factor) * factor]
    values = np.round(values / step) * step if step else values
    found = find_hold(np.arange(n) * 0.01, values, step or None)
    assert found is not None
    assert found.factor == pytest.approx(factor, rel=0.05)
    assert found.rate_hz == pytest.approx(100.0 / factor, rel=0.05)


def test_a_hold_on_another_clock() -> None:
    """A 57 Hz camera logged at 100 Hz: 1.75 samples per image, so runs of one and two."""
    time_s = np.arange(5000) * 0.01
    image = np.floor(time_s * 57.0)
    values = (
        10.0 * np.sin(0.6 * image / 57.0)
        + 0.01 * np.random.default_rng(0).standard_normal(3000)[image.astype(int)]
    )
    found = find_hold(time_s, values, None)
    assert found is not None
    assert found.rate_hz == pytest.approx(57.0, rel=0.1)


@pytest.mark.parametrize("step", [0.3, 0.7, 1.0, 2.0])
@pytest.mark.parametrize("slope", [0.0, 0.01, 0.9])
def test_quantised_noise_is_not_held(step: float, slope: float) -> None:
    """White noise of one unit on grids from fine to coarse, at rest and moving a step a sample."""
    rng = np.random.default_rng(int(100 * step + 10 * slope))
    drift = slope * np.abs((np.arange(4000) % 400) - 200.0)
    values = np.round((drift + rng.standard_normal(4000)) / step) * step
    assert find_hold(np.arange(4000) * 0.01, values, step) is None


def test_a_dead_band_is_no_hold() -> None:
    """A sensor that moves only after 0.8: its jumps are 0.8, its rests last as the motion does."""
    time_s = np.arange(4000) * 0.02
    quantity = 40.0 * (1.0 - np.cos(2 * np.pi * 0.02 * time_s))
    values, shown = np.empty(4000), 0.0
    for k, q in enumerate(quantity):
        shown = q if abs(q - shown) >= 0.8 else shown
        values[k] = shown
    values = np.round(values, 2)
    assert find_hold(time_s, values, 0.01) is None
    assert find_dead_band(time_s, values, 0.01) == pytest.approx(0.8, rel=0.1)


def test_fresh_samples_of_a_regular_hold() -> None:
    """One sample per hold, its first."""
    values = np.repeat(np.random.default_rng(0).standard_normal(20), 3)
    fresh = fresh_samples(np.arange(60) * 0.01, values, SampleHold(3.0, 0.03, 33.3))
    assert fresh.tolist() == list(range(0, 60, 3))


@pytest.mark.parametrize("seed", range(12))
def test_noise_within_15_percent(seed: int) -> None:
    """σ = 1 on quantised, held and irregular samples over motion 20 to 300 times as large.

    600 to 5000 samples, so at least 200 fresh ones: the 68 % quantile then scatters by some 6 %.
    """
    rng = np.random.default_rng(seed)
    n, factor = int(rng.choice([1000, 2000, 5000])), int(rng.choice([1, 2, 3, 5]))
    step = float(rng.choice([0.0, 0.02, 0.5, 1.0]))
    intervals = rng.uniform(0.3, 1.7, n) if rng.random() < 0.5 else np.ones(n)
    time_s = 0.01 * np.cumsum(intervals)
    motion = rng.uniform(20.0, 300.0) * np.sin(2 * np.pi * rng.uniform(0.0, 0.5) * time_s)
    values = (motion + rng.standard_normal(n))[(np.arange(n) // factor) * factor]
    values = np.round(values / step) * step if step else values
    grid = find_quantisation(values)
    found_step = grid.step if grid else None
    hold = find_hold(time_s, values, found_step)
    assert noise_std(time_s, values, step=found_step, hold=hold) == pytest.approx(1.0, rel=0.15)


def test_noise_below_the_step_is_not_invented() -> None:
    """At σ = 0.1 steps the grid hides the noise; None says so."""
    values = np.round(moving(3000, 0, noise=0.1))
    assert noise_std(np.arange(3000) * 0.01, values, step=1.0) is None


def test_a_clean_signal_has_no_noise() -> None:
    """A constant is exactly without noise; 20 samples are the least that are judged."""
    assert noise_std(np.arange(50.0), np.full(50, 6.89476)) == 0.0
    assert noise_std(np.arange(10.0), np.full(10, 6.89476)) is None
