"""The recorded input without its noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from scipy.signal import savgol_coeffs, savgol_filter

from softid.identification import fit
from softid.identification.input_denoising import (
    FURTHEST_NEIGHBOUR,
    LONGER_REACHES,
    SIGMAS,
    without_input_noise,
)
from softid.log import Log
from softid.synthesis import hidden_pair
from softid.synthesis.rig import Rig

Array = npt.NDArray[np.float64]

SIGMA = 0.5
"""kPa."""

SAMPLES = 4000
TIME_S = 0.01 * np.arange(SAMPLES)


def recorded(pressure: Array, time_s: Array = TIME_S) -> Log:
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": np.sin(time_s)})


def noise(seed: int = 0) -> Array:
    return SIGMA * np.random.default_rng(seed).standard_normal(SAMPLES)


def left_by_parabolas(*reaches: int) -> float:
    """Noise that parabolas through so many samples to either side, one after the other, leave."""
    weights = np.ones(1)
    for reach in reaches:
        weights = np.convolve(weights, savgol_coeffs(2 * reach + 1, 2))
    return float(np.sqrt(np.sum(weights**2)))


def test_a_slope_loses_the_noise_of_two_parabolas() -> None:
    """Closed form: the weights of Savitzky and Golay for w = 21 samples, once and once more.

    Longer reaches end where the slope leaves the limit of pairs. Where a sample itself lies far out
    its pairs end sooner, so the noise is above the closed form by up to a third.
    """
    least = left_by_parabolas(FURTHEST_NEIGHBOUR, FURTHEST_NEIGHBOUR)
    truth = 0.36 * SIGMA * np.arange(SAMPLES)
    error = without_input_noise(recorded(truth + noise())).pressure_kpa - truth
    found = float(np.std(error[40:-40])) / SIGMA
    assert 0.9 * least < found < 1.33 * least


def test_a_level_is_as_quiet_as_the_longest_reach_makes_it() -> None:
    """Closed form: the parabola through 161 samples and one through 21 of what that leaves.

    Some levels end sooner by chance, so the noise is above the closed form by up to a half; the
    mean stays.
    """
    least = left_by_parabolas(LONGER_REACHES[-1], FURTHEST_NEIGHBOUR)
    clean = without_input_noise(recorded(80.0 + noise())).pressure_kpa
    inside = clean[LONGER_REACHES[-1] : -LONGER_REACHES[-1]]
    assert 0.9 * least < float(np.std(inside)) / SIGMA < 1.5 * least
    assert float(np.mean(clean)) == pytest.approx(80.0, abs=4.0 * SIGMA / np.sqrt(SAMPLES))


@pytest.mark.parametrize("level_s", [4.0, 10.0])
def test_holds_add_little_to_the_path(level_s: float) -> None:
    """Known truth: softening and wear go by the path, and a gauge at rest covers none.

    By hand, of levels of 4 s at 100 Hz the first and last tenth of a second, a twentieth of the
    hold, tremble as they did. Parabolas through 21 samples leave twice as much and more.
    """
    truth = 100.0 * SIGMA * (np.floor(TIME_S / level_s) % 2.0)
    given = truth + noise(7)
    clean = without_input_noise(recorded(given)).pressure_kpa
    short = given
    for _ in range(2):
        short = savgol_filter(short, 2 * FURTHEST_NEIGHBOUR + 1, 2)

    def trembling(course: Array) -> float:
        steps = np.abs(np.diff(course))[np.diff(truth) == 0.0]
        return float(steps[steps < 10.0 * SIGMA].sum())

    assert trembling(clean) < 0.15 * trembling(given)
    assert trembling(clean) < 0.5 * trembling(short)


@pytest.mark.parametrize("hertz", [0.3, 0.6])
def test_bends_stay(hertz: float) -> None:
    """A sine of 80σ keeps its height to 4 standard errors of a regression on it, σ √(2/n), that is
    0.09σ; a mean over the same samples takes 0.2σ and more from it."""
    truth = 80.0 * SIGMA * np.sin(2.0 * np.pi * hertz * TIME_S)
    error = without_input_noise(recorded(truth + noise(5))).pressure_kpa - truth
    height = 80.0 * SIGMA * float(error @ truth) / float(truth @ truth)
    assert abs(height) < 4.0 * SIGMA * np.sqrt(2.0 / SAMPLES)


@pytest.mark.parametrize("protocol", ["levels", "lever"])
def test_parameters_stay_what_they_are(protocol: str) -> None:
    """Errors over standard errors of four fits behind a valve of 40 ms, with a noise of 0.7 kPa.

    Their mean has a standard deviation of a half if nothing is bent. A mean over the same samples
    bends the corners: N is off by −4.4 standard errors on the average of such logs of levels, and M
    by 2.9 on those of a lever.
    """
    rig = replace(Rig(), pressure_noise_kpa=0.7, noise=0.004)
    off = []
    for seed in range(4):
        pair = hidden_pair(seed=seed, model="oscillator", protocol=protocol, rig=rig)
        found = fit(without_input_noise(pair.logs[0]), model="oscillator")
        off.append(
            [
                (found.parameter(name).value - pair.actuator.values[name])
                / found.parameter(name).stderr
                for name in ("N", "Q")
            ]
        )
    assert np.all(np.abs(np.mean(off, axis=0)) < 1.6)


def test_edges_stay_where_they_are() -> None:
    """Invariant: parabolas that never reach across an edge are near the truth, as its noise is.

    The edges are 100σ high; a single sample from across would move the value by 4σ and more.
    """
    truth = np.where(TIME_S % 4.0 < 2.0, 0.0, 100.0 * SIGMA)
    trembling = noise(1)
    clean = without_input_noise(recorded(truth + trembling)).pressure_kpa
    assert np.max(np.abs(clean - truth)) <= np.max(np.abs(trembling)) + SIGMA


def test_slopes_are_not_bent() -> None:
    """Closed form: the parabola through symmetric pairs on a straight line is the line.

    The slope of 0.5σ a sample puts the outermost pairs beyond 5σ; the rest still quieten, and the
    mean error of a ramp stays within five of its standard errors.
    """
    truth = 0.5 * SIGMA * np.arange(SAMPLES)
    error = without_input_noise(recorded(truth + noise(2))).pressure_kpa - truth
    assert abs(float(np.mean(error))) < 5.0 * SIGMA / np.sqrt(SAMPLES)
    assert float(np.std(error)) < 0.6 * SIGMA


def test_a_kink_is_rounded_by_no_more_than_the_limit() -> None:
    """Invariant: a pass takes pairs within 5σ and moves no sample by more, so two by less than
    10σ, and by a fifth more for the estimate of σ."""
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

    The levels of both are within 5σ of each other, so only the stall keeps them apart.
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
