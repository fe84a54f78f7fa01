"""Sensors and clock: what they add has the statistics that the recipe says."""

from __future__ import annotations

import numpy as np
import pytest

from softid.errors import InputError
from softid.synthesis.sensors import Sampling, Sensor, coloured_noise, standard_normal

N = 40_000


def rng(seed: int = 3) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_normal_numbers_are_normal() -> None:
    """Mean 0, variance 1, fourth moment 3; five standard errors of each at n = 40,000."""
    z = standard_normal(rng(), N)
    assert abs(z.mean()) < 5 / np.sqrt(N)
    assert abs(z.var() - 1.0) < 5 * np.sqrt(2.0 / N)
    assert abs((z**4).mean() - 3.0) < 5 * np.sqrt(96.0 / N)


def test_normal_numbers_are_those_of_the_inverse_distribution() -> None:
    """The first numbers of seed 0, from its uniform numbers 0.63696, 0.26979 and 0.04097."""
    assert standard_normal(rng(0), 3) == pytest.approx([0.3503, -0.6134, -1.7395], abs=2e-4)


@pytest.mark.parametrize("ar", [(0.9,), (1.5, -0.7)])
def test_coloured_noise_has_unit_variance_and_its_colour(ar: tuple[float, ...]) -> None:
    """Yule–Walker: ρ1 = φ1 (order 1) or φ1/(1 − φ2) (order 2). n_eff ≈ n(1−φ²)/(1+φ²) ≥ 2,000."""
    noise = coloured_noise(ar, N, rng())
    first = ar[0] / (1.0 - (ar[1] if len(ar) > 1 else 0.0))
    correlation = np.mean(noise[1:] * noise[:-1]) / noise.var()
    assert noise.var() == pytest.approx(1.0, abs=5 * np.sqrt(2.0 / 2_000))
    assert correlation == pytest.approx(first, abs=0.02)


def test_sensor_adds_what_it_says() -> None:
    """Mean shift = zero, standard deviation = sigma (white, coloured and rounding together)."""
    sensor = Sensor(
        decimals=2, zero=2.5, noise_sd=0.2, coloured_sd=0.15, coloured_ar=(0.5,), quantum=0.25
    )
    true = np.linspace(0.0, 100.0, N)
    added = sensor.read(true, rng()) - true
    assert added.mean() == pytest.approx(2.5, abs=0.01)
    assert added.std() == pytest.approx(sensor.sigma, rel=0.03)
    assert sensor.sigma == pytest.approx(np.sqrt(0.04 + 0.0225 + 0.25**2 / 12), rel=1e-12)


def test_quantum_and_decimals() -> None:
    """Values are multiples of the quantum, written to the decimals, without a negative zero."""
    read = Sensor(decimals=2, quantum=0.05, noise_sd=0.3).read(np.zeros(500), rng())
    assert np.abs(read / 0.05 - np.round(read / 0.05)).max() < 1e-9
    assert not np.signbit(Sensor(decimals=1).read(np.array([-0.01, 0.0]), rng())).any()
    assert Sensor(decimals=1).read(np.array([1.26, -7.31]), rng()).tolist() == [1.3, -7.3]


def test_blank_cells_come_in_runs() -> None:
    """The share is met to five standard errors, and the runs are at least as long as asked."""
    sensor = Sensor(decimals=1, blank_fraction=0.03, blank_rows=3)
    blank = np.isnan(sensor.read(np.zeros(N), rng()))
    edges = np.flatnonzero(np.diff(blank.astype(int)))
    assert blank.mean() == pytest.approx(0.03, abs=5 * np.sqrt(3 * 0.03 / N))
    assert (edges[1::2] - edges[::2]).min() == 3


def test_clock_without_flaws_is_even() -> None:
    """k/rate exactly as text with the decimals reads back."""
    assert Sampling(rate_hz=100, decimals=2).times(0.05, rng()).tolist() == [
        0.0, 0.01, 0.02, 0.03, 0.04, 0.05,
    ]  # fmt: skip


def test_clock_with_jitter_and_lost_rows() -> None:
    """Jitter has its standard deviation; the share of lost rows is met to five standard errors."""
    times = Sampling(rate_hz=100, jitter_s=5e-4, decimals=6).times(200.0, rng())
    off = times - np.arange(20_001) / 100.0
    assert off.std() == pytest.approx(5e-4, rel=0.03)
    assert (np.diff(times) > 0).all()
    kept = Sampling(rate_hz=100, lost_fraction=0.05).times(200.0, rng())
    assert 1 - kept.size / 20_001 == pytest.approx(0.05, abs=5 * np.sqrt(0.05 / 20_001))


def test_stalls_leave_gaps() -> None:
    """No row between 2.0 and 3.1 s nor between 4.0 and 5.1 s."""
    times = Sampling(rate_hz=10, stall_at_s=(2.0, 4.0), stall_s=1.1).times(6.0, rng())
    gaps = np.flatnonzero(np.diff(times) > 1.0)
    assert times[gaps].tolist() == [2.0, 4.0]
    assert np.diff(times)[gaps] == pytest.approx([1.1, 1.1])


def test_skipped_start_shortens_the_recording() -> None:
    """2 s of excitation, 0.5 s skipped: 1.5 s from zero on."""
    times = Sampling(rate_hz=10, skip_s=0.5).times(2.0, rng())
    assert (times[0], times[-1]) == (0.0, 1.5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Sensor(decimals=10), "decimals is out of range"),
        (lambda: Sensor(decimals=2, noise_sd=-1.0), "noise_sd is out of range"),
        (lambda: Sensor(decimals=2, coloured_sd=1.0), "needs its autoregressive coefficients"),
        (lambda: Sensor(decimals=2, coloured_ar=(1.1,)), "grow without end"),
        (lambda: Sampling(rate_hz=0.0), "rate_hz is out of range"),
        (lambda: Sampling(rate_hz=10).times(0.01, rng()), "the recording has 1 rows"),
        (lambda: Sampling(rate_hz=1e9).times(10.0, rng()), "rows"),
        (lambda: Sampling(rate_hz=100, decimals=1).times(1.0, rng()), "same time"),
        (lambda: Sampling(rate_hz=10, stall_at_s=(0.0,), stall_s=9).times(1.0, rng()), "fewer"),
    ],
)
def test_refused(make, message: str) -> None:
    """Each impossible rig is one sentence."""
    with pytest.raises(InputError, match=message):
        make()
