"""Outputs that move before their input, and the motions that only seem to."""

from __future__ import annotations

import numpy as np
import pytest

from softid.identification.preparation import with_faults_told
from softid.log import Log
from softid.quality import inspect
from softid.quality.causality import LEADING_OUTPUT, lead_s, leading_outputs
from softid.quality.lagged_correlation import lagged_correlations

TIME_S = 0.01 * np.arange(4000)


def levels(seed: int = 0) -> np.ndarray:
    """Random levels behind a valve of 40 ms, with the noise of a gauge."""
    rng = np.random.default_rng(seed)
    held = np.repeat(100.0 * rng.random(20), 200)
    return behind(held, 0.04) + 0.3 * rng.standard_normal(TIME_S.size)


def behind(values: np.ndarray, tau_s: float) -> np.ndarray:
    """A lag of first order, exact for held values."""
    found = np.empty_like(values)
    found[0] = values[0]
    share = np.exp(-0.01 / tau_s)
    for k in range(1, values.size):
        found[k] = share * found[k - 1] + (1.0 - share) * values[k - 1]
    return found


def recorded(pressure: np.ndarray, angle: np.ndarray) -> Log:
    return Log.from_arrays(TIME_S, {"pressure": pressure, "angle": angle}, name="a")


@pytest.mark.parametrize("tau_s", [0.02, 0.1, 0.4])
@pytest.mark.parametrize("seed", range(3))
def test_a_motion_that_follows_does_not_lead(tau_s: float, seed: int) -> None:
    """Nor with noise; a static curve moves with its input; and what is at rest does neither."""
    pressure = levels(seed)
    angle = behind(pressure, tau_s)
    noise = np.random.default_rng(seed + 10).standard_normal(TIME_S.size)
    for output in (angle, angle + 3.0 * noise, np.tanh(pressure / 50.0), noise, 0.0 * noise):
        assert lead_s(recorded(pressure, output), "angle") is None


@pytest.mark.parametrize("tau_s", [0.1, 0.4])
def test_exchanged_columns_are_told(tau_s: float) -> None:
    """By about the time constant, in the inspection and in what a fit says, once."""
    pressure = levels()
    log = recorded(behind(pressure, tau_s), pressure)
    ahead_s = lead_s(log, "angle")
    assert ahead_s is not None
    assert 0.3 * tau_s < ahead_s < 1.5 * tau_s
    (issue,) = leading_outputs(log)
    assert f"angle moves {ahead_s:.2g} s before pressure does" in issue.message
    assert [i.code for i in inspect(log).issues].count(LEADING_OUTPUT) == 1
    told = with_faults_told(with_faults_told(log)).issues
    assert [i.code for i in told].count(LEADING_OUTPUT) == 1
    assert leading_outputs(recorded(pressure, behind(pressure, tau_s))) == ()


def test_a_clock_that_is_late_is_told() -> None:
    """An input that is stamped 0.3 s too late; 0.01 s is within the clock's."""
    pressure, angle = levels(), behind(levels(), 0.05)
    late = lead_s(recorded(np.roll(pressure, 30), angle), "angle")
    assert late == pytest.approx(0.25, abs=0.05)
    assert lead_s(recorded(np.roll(pressure, 1), angle), "angle") is None


def test_a_lead_of_two_samples_is_told_however_long_the_log_is() -> None:
    """Of 4000 samples every second is correlated, and a step of that grid is such a lead."""
    pressure = levels()
    ahead_s = lead_s(recorded(np.roll(pressure, 2), pressure), "angle")
    assert ahead_s == pytest.approx(0.02, rel=0.01)


def test_an_overshoot_does_not_lead() -> None:
    """A reading that jumps and comes back by a half in 1 s, as a sensor that creeps does."""
    pressure = levels()
    assert lead_s(recorded(pressure, pressure - 0.5 * behind(pressure, 1.0)), "angle") is None


def test_correlations_are_those_of_numpy() -> None:
    """At every lag, of the samples that overlap, to rounding; constants have none."""
    rng = np.random.default_rng(1)
    one, two = 5.0 + rng.standard_normal(60).cumsum(), rng.standard_normal(60) - 40.0
    found = lagged_correlations(one, two, 50)
    assert found[0] == pytest.approx(np.corrcoef(one, two)[0, 1])
    for lag in range(1, 51):
        assert found[lag] == pytest.approx(np.corrcoef(one[:-lag], two[lag:])[0, 1], abs=1e-10)
    assert lagged_correlations(np.ones(20), two[:20], 5).tolist() == [0.0] * 6
    assert lagged_correlations(one[:8], two[:8], 7)[4:].tolist() == [0.0] * 4
