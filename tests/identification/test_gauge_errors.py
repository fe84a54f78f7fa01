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
    """A log with an input of some values."""
    channels = {name: values, "angle": 0.01 * values}
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
