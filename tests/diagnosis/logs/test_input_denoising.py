"""The recorded input without its noise."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from softid.diagnosis.logs.input_denoising import REACH, SIGMAS, without_input_noise
from softid.log import Log

Array = npt.NDArray[np.float64]

SIGMA = 0.5
"""kPa."""

SAMPLES = 4000
TIME_S = 0.01 * np.arange(SAMPLES)


def recorded(pressure: Array, time_s: Array = TIME_S) -> Log:
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": np.sin(time_s)})


def noise(seed: int = 0) -> Array:
    return SIGMA * np.random.default_rng(seed).standard_normal(SAMPLES)


def test_a_level_loses_the_noise_of_two_running_means() -> None:
    """Closed form: two means over w = 21 samples weigh by a triangle, Σ² = (2w² + 1)/(3w³).

    Pairs that noise alone puts beyond 3σ are left out, and the sample itself stays: at a difference
    of √2σ that is 3.4 % of all samples, so the noise is above the closed form by up to a third.
    """
    width = 2 * REACH + 1
    least = np.sqrt((2 * width**2 + 1) / (3 * width**3))
    clean = without_input_noise(recorded(80.0 + noise())).pressure_kpa
    found = float(np.std(clean[40:-40])) / SIGMA
    assert 0.9 * least < found < 1.33 * least
    assert float(np.mean(clean)) == pytest.approx(80.0, abs=4.0 * SIGMA / np.sqrt(SAMPLES))


def test_edges_stay_where_they_are() -> None:
    """Invariant: means that never reach across an edge are within the largest noise of the truth.

    The edges are 100σ high; a single sample from across would move a mean of 21 by 5σ.
    """
    truth = np.where(TIME_S % 4.0 < 2.0, 0.0, 100.0 * SIGMA)
    trembling = noise(1)
    clean = without_input_noise(recorded(truth + trembling)).pressure_kpa
    assert np.max(np.abs(clean - truth)) <= np.max(np.abs(trembling)) + 1e-12


def test_slopes_are_not_bent() -> None:
    """Closed form: the mean of a symmetric pair on a straight line is the line.

    The slope of 0.5σ a sample puts the outermost pairs beyond 3σ; the rest still quieten, and the
    mean error of a ramp stays within five of its standard errors.
    """
    truth = 0.5 * SIGMA * np.arange(SAMPLES)
    error = without_input_noise(recorded(truth + noise(2))).pressure_kpa - truth
    assert abs(float(np.mean(error))) < 5.0 * SIGMA / np.sqrt(SAMPLES)
    assert float(np.std(error)) < 0.6 * SIGMA


def test_a_kink_is_rounded_by_no_more_than_the_limit() -> None:
    """Invariant: a pass moves a sample by less than 3σ, so two move it by less than 6σ."""
    truth = 100.0 * np.abs((TIME_S % 2.0) - 1.0)
    given = truth + noise(3)
    clean = without_input_noise(recorded(given)).pressure_kpa
    assert np.max(np.abs(clean - given)) <= 2.0 * SIGMAS * 1.2 * SIGMA


def test_the_outputs_are_not_touched() -> None:
    """The noise of an output is what a fit weighs by."""
    log = recorded(80.0 + noise(4))
    clean = without_input_noise(log)
    assert clean.channels["angle"] is log.channels["angle"]
    assert not np.array_equal(clean.pressure_kpa, log.pressure_kpa)


@pytest.mark.parametrize("course", ["steps", "sine", "few"])
def test_without_noise_the_log_stays_as_it_is(course: str) -> None:
    """No noise, or too few samples to know it: the same log comes back."""
    pressure = {
        "steps": np.where(TIME_S % 4.0 < 2.0, 0.0, 50.0),
        "sine": 40.0 * np.sin(0.5 * TIME_S),
        "few": noise()[:15],
    }[course]
    log = recorded(pressure, TIME_S[: pressure.size])
    assert without_input_noise(log) is log


def test_nothing_crosses_a_stall() -> None:
    """Turning the sign of the second stretch keeps the noise's size and must not reach the first.

    The levels of both are within 3σ of each other, so only the stall keeps them apart.
    """
    time_s = np.where(np.arange(SAMPLES) < 2000, TIME_S, TIME_S + 30.0)
    second = np.where(np.arange(SAMPLES) < 2000, 1.0, -1.0)
    pressure = 0.5 * SIGMA + noise(6)
    one, other = (
        without_input_noise(recorded(values, time_s)).pressure_kpa
        for values in (pressure, second * pressure)
    )
    assert np.array_equal(one[:2000], other[:2000])
    assert np.array_equal(one[2000:], -other[2000:])
