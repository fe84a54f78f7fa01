"""What a gauge adds to the input: noise, and the rounding of coarse steps."""

from __future__ import annotations

import numpy as np
import pytest

from softid.identification.gauge_errors import GaugeErrors, gauge_errors
from softid.log import Log

TIME_S = np.arange(2000) * 0.01
COURSE = np.interp(TIME_S, [0, 4, 6, 9, 12, 20], [3.0, 3.0, 41.3, 41.3, 17.9, 17.9])
STEP = 1.5


def log_of(values: np.ndarray, name: str = "pressure") -> Log:
    """A log with an input of some values, and the output of the course."""
    channels = {name: values, "angle": 0.01 * COURSE}
    return Log.from_arrays(TIME_S, channels, input=name, outputs=("angle",), name="g")


def rounded(noise: float) -> np.ndarray:
    """The course with noise, rounded."""
    noisy = COURSE + noise * np.random.default_rng(2).standard_normal(TIME_S.size)
    return STEP * np.round(noisy / STEP)


def test_a_coarse_gauge_has_a_step() -> None:
    found = gauge_errors(log_of(rounded(0.05)))
    assert found.step == pytest.approx(STEP, rel=1e-3)
    assert found.are_there


@pytest.mark.parametrize(
    ("values", "name"),
    [
        (rounded(1.5), "pressure"),  # noise of a step blurs it
        (COURSE + 0.1 * np.sin(900.0 * TIME_S), "pressure"),  # on no grid
        (rounded(0.05), "pressure_command"),  # what is set is known
        (np.repeat([0.0, 20.0, 10.0, 40.0, 30.0], 400), "pressure"),  # levels that are set
    ],
)
def test_other_inputs_have_none(values: np.ndarray, name: str) -> None:
    assert gauge_errors(log_of(values, name)).step == 0.0


@pytest.mark.parametrize(
    ("tau_s", "is_set"),
    [(0.0, True), (0.3, True), (4.0, False)],  # one that hardly follows does not tell
)
def test_levels_that_are_as_far_apart_are_set(tau_s: float, is_set: bool) -> None:
    """By definition: a staircase of 20 kPa up and down, which the output answers to and rests."""
    time_s = np.arange(4800) * 0.01
    levels = 20.0 * np.array([0, 1, 2, 3, 4, 3, 2, 1])
    values = levels[(time_s / 1.5).astype(np.intp) % levels.size]
    angle = values.copy()
    for k in range(1, values.size):
        share = np.exp(-0.01 / tau_s) if tau_s else 0.0
        angle[k] = values[k] + share * (angle[k - 1] - values[k])
    log = Log.from_arrays(time_s, {"pressure": values, "angle": angle}, name="staircase")
    assert (gauge_errors(log).step == 0.0) is is_set


def test_few_levels_in_any_order_are_set() -> None:
    """By definition: four levels, as many of their changes by one as not; none is passed."""
    values = np.repeat(np.tile([0.0, 20.0, 60.0, 40.0], 10), 50)
    found = Log.from_arrays(TIME_S, {"pressure": values, "angle": 0.01 * values}, name="levels")
    assert gauge_errors(found).step == 0.0


def test_what_is_drawn_is_what_rounding_takes() -> None:
    """Uniform within a step over many levels, alike whenever one is set again, none in passing."""
    rng = np.random.default_rng(0)
    levels = STEP * rng.integers(0, 60, 500) * 3.0  # never the next one
    drawn = GaugeErrors(0.0, STEP, TIME_S, np.repeat(levels, 4)).rounding(TIME_S, rng)
    assert np.max(np.abs(drawn)) <= 0.5 * STEP
    assert np.std(drawn) == pytest.approx(STEP / 12.0**0.5, rel=0.15)
    for level in np.unique(levels):
        assert np.ptp(drawn[np.repeat(levels, 4) == level]) == 0.0
    ramp = GaugeErrors(0.0, STEP, TIME_S[:60], STEP * np.repeat(np.arange(20.0), 3))
    np.testing.assert_array_equal(ramp.rounding(TIME_S[3:57], rng), 0.0)
