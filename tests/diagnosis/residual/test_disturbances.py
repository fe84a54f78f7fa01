"""Lines and short events in what a model leaves, and the noise and motion that bring none."""

from __future__ import annotations

import numpy as np
import pytest
from noise import ar1

from softid.diagnosis.residual.disturbances import disturbance_issues, events_in
from softid.diagnosis.residual.spectral_line import Line, _regular, line_in
from softid.diagnosis.residual.structure import ResidualContext

TIME_S = np.arange(0.0, 40.0, 0.01)
STEPS = np.where(TIME_S % 20.0 < 10.0, 0.0, 100.0)


def left(residual: np.ndarray, u: np.ndarray = STEPS) -> list[ResidualContext]:
    return [ResidualContext(TIME_S, u, np.gradient(u, TIME_S), u, residual)]


def noise(seed: int, *, slow: bool = False) -> np.ndarray:
    """White with a standard deviation of 1, or with a correlation time of 1 s."""
    rng = np.random.default_rng(seed)
    return ar1(rng, TIME_S.size, 0.99 if slow else 0.0)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("slow", [False, True])
def test_noise_has_no_marks(seed: int, slow: bool) -> None:
    """Twenty draws of which chance may mark one in 10,000; drops of samples are bridged."""
    trembling = noise(seed, slow=slow)
    trembling[500:520] = np.nan
    assert line_in(left(trembling)) is None
    if not slow:
        assert events_in(left(trembling), 0.2) == ()


def test_a_steady_line_is_found() -> None:
    """Half as high as white noise and between two bins: to 1 mHz, and a tenth of its height."""
    found = line_in(left(noise(0) + 0.5 * np.sin(2.0 * np.pi * 1.3123 * TIME_S + 0.4)))
    assert found is not None
    assert found.frequency_hz == pytest.approx(1.3123, abs=0.001)
    assert found.amplitude == pytest.approx(0.5, rel=0.1)


def test_a_line_is_told_from_swings_that_begin_again_and_again() -> None:
    """Swings of 1.3 Hz that each of 13 moves sets off; and a line, beside as much noise."""
    begins = np.sort(np.random.default_rng(3).uniform(0.0, 40.0, 13))
    ups = np.where(np.arange(13) % 2, -1.0, 1.0)
    moved = sum(up * (begin <= TIME_S) for up, begin in zip(ups, begins, strict=True))
    number = np.searchsorted(begins, TIME_S, side="right") - 1
    late_s = TIME_S - begins[np.maximum(number, 0)]
    ringing = np.where(number < 0, 0.0, ups[number] * np.exp(-late_s / 4.0))
    swings = ringing * np.sin(2.0 * np.pi * 1.3 * late_s)
    steady = 0.3 * np.sin(2.0 * np.pi * 1.3 * TIME_S)
    for line, in_step in ((swings, False), (steady, True)):
        found = line_in(left(0.3 * noise(2) + 4.0 * line, 100.0 * moved))
        assert found is not None
        assert found.in_step is in_step
        told = disturbance_issues(
            left(noise(2)), 0.2, found, channel="angle", unit="deg", factor=1.0
        )[0]
        assert ("begin with the moves" in told.remedy) is not in_step


def test_a_line_in_pairs_of_samples_is_found() -> None:
    """Every second sample 1 µs before the next: even times at median intervals would be 40 million
    and the line is that of the pairs, 50 a second."""
    time_s = TIME_S.copy()
    time_s[::2] = time_s[1::2] - 1e-6
    residual = noise(0) + np.sin(2.0 * np.pi * 1.3123 * time_s)
    pairs = ResidualContext(time_s, STEPS, np.zeros_like(time_s), STEPS, residual)
    assert _regular(pairs)[0].size <= 10 * time_s.size
    found = line_in([pairs])
    assert found is not None
    assert found.frequency_hz == pytest.approx(1.3123, abs=0.001)


def test_a_line_of_the_input_is_its_motion() -> None:
    """The same line, while the input swings at it or at half of it; and one that is there for a
    quarter of the log only."""
    line = 0.5 * np.sin(2.0 * np.pi * 1.3123 * TIME_S + 0.4)
    for divisor in (1.0, 2.0):
        swinging = 50.0 + 40.0 * np.sin(2.0 * np.pi * 1.3123 / divisor * TIME_S)
        assert line_in(left(noise(0) + line, swinging)) is None
    assert line_in(left(noise(0) + 4.0 * line * (TIME_S < 10.0))) is None


@pytest.mark.parametrize("order", [5, 8, 13])
def test_overtones_of_a_sine_are_its_motion(order: int) -> None:
    """Friction and dead zones make them of one sine; a line between two of them is still one."""
    u = 50.0 + 40.0 * np.sin(2.0 * np.pi * 0.5123 * TIME_S)

    def line(hertz: float) -> Line | None:
        return line_in(left(noise(0) + 0.5 * np.sin(2.0 * np.pi * hertz * TIME_S), u))

    assert line(order * 0.5123) is None
    found = line((order + 0.5) * 0.5123)
    assert found is not None
    assert found.frequency_hz == pytest.approx((order + 0.5) * 0.5123, abs=0.002)


@pytest.mark.parametrize("hertz", [2.0 * 1.31 - 0.37, 1.31 + 2.0 * 0.37, 1.31 - 0.37])
def test_sums_and_differences_of_lines_are_their_motion(hertz: float) -> None:
    """Friction makes them of an input of two sines; a line elsewhere is still one."""
    u = 50.0 + 20.0 * np.sin(2.0 * np.pi * 0.37 * TIME_S) + 20.0 * np.sin(8.231 * TIME_S)
    mixed = 0.5 * np.sin(2.0 * np.pi * hertz * TIME_S)
    assert line_in(left(noise(0) + mixed, u)) is None
    beside = 0.5 * np.sin(2.0 * np.pi * 3.4 * TIME_S)
    found = line_in(left(noise(0) + beside, u))
    assert found is not None
    assert found.frequency_hz == pytest.approx(3.4, abs=0.002)


def test_chance_lines_of_random_steps_hide_no_line() -> None:
    """Of 40 inputs of random steps some have weak lines, whose multiples would cover 1 Hz."""
    steady = 2.0 * np.sin(2.0 * np.pi * TIME_S)
    for seed in range(40):
        rng = np.random.default_rng(seed)
        begins = np.concatenate(([0.0], np.cumsum(rng.uniform(0.6, 2.6, 70))))
        levels = rng.uniform(0.0, 100.0, begins.size)
        u = levels[np.searchsorted(begins, TIME_S, side="right") - 1]
        found = line_in(left(noise(seed) + steady, u))
        assert found is not None, seed
        assert found.frequency_hz == pytest.approx(1.0, abs=0.001)


@pytest.mark.parametrize("dwell_s", [1.5, 2.0, 2.9])
def test_steps_up_and_down_at_one_rate_are_their_motion(dwell_s: float) -> None:
    """A staircase has no line at the rate of its steps, which alternate, but each leaves a pulse; a
    line elsewhere is still one."""
    number = np.floor(TIME_S / dwell_s)
    steps = np.minimum(number, np.floor(TIME_S[-1] / dwell_s) - number)
    late_s = TIME_S - number * dwell_s
    pulses = np.exp(-late_s / (0.3 * dwell_s))
    assert line_in(left(0.3 * noise(4) + 2.0 * (pulses - pulses.mean()), 10.0 * steps)) is None
    found = line_in(left(noise(4) + 0.5 * np.sin(2.0 * np.pi * 5.7 * TIME_S), 10.0 * steps))
    assert found is not None
    assert found.frequency_hz == pytest.approx(5.7, abs=0.002)


def test_a_weak_ripple_of_the_input_is_its_motion() -> None:
    """A hundredth of its steps high, far above them at 11.3 Hz: pulses of a valve."""
    ripple = np.sin(2.0 * np.pi * 11.3 * TIME_S)
    assert line_in(left(noise(0) + ripple)) is not None
    assert line_in(left(noise(0) + ripple, STEPS + 0.01 * np.ptp(STEPS) * ripple)) is None


def test_events_at_rest_are_found_and_those_after_a_step_are_not() -> None:
    """Knocks of 0.1 s and ten times the noise at 6 and 17 s; the step of the input is at 10 s."""
    knocked = noise(1)
    for at_s in (6.0, 17.0):
        knocked[(at_s <= TIME_S) & (at_s + 0.1 > TIME_S)] += 10.0
    assert events_in(left(knocked), 0.2) == pytest.approx((6.0, 17.0), abs=0.051)
    transient = noise(1) + 10.0 * np.exp(-np.maximum(TIME_S - 10.0, 0.0) / 0.1) * (TIME_S > 10.0)
    assert events_in(left(transient), 0.2) == ()


@pytest.mark.parametrize("level", [0.0, 1.0, 2.0, 3.0])
def test_noise_of_the_gauge_hides_no_event(level: float) -> None:
    """The same with 0.5 kPa of it about any level of rest, steps of 2 kPa between which it lies or
    on which it does."""
    knocked = noise(1)
    for at_s in (6.0, 17.0):
        knocked[(at_s <= TIME_S) & (at_s + 0.1 > TIME_S)] += 10.0
    u = level + STEPS + 0.5 * noise(2)
    assert events_in(left(knocked, u), 0.2) == pytest.approx((6.0, 17.0), abs=0.051)


def test_what_a_slow_settling_leaves_is_no_event() -> None:
    """A tail of 3 s behind the step, ten times its usual length, and a knock at 17 s beside it."""
    tail = 30.0 * np.exp(-np.maximum(TIME_S - 10.0, 0.0) / 0.6) * (TIME_S > 10.0)
    assert events_in(left(noise(1) + tail), 0.2) == ()
    knocked = noise(1) + tail
    knocked[(TIME_S >= 17.0) & (TIME_S < 17.1)] += 20.0
    assert events_in(left(knocked), 0.2) == pytest.approx((17.0,), abs=0.051)


def test_marks_are_told_in_the_units_of_the_log() -> None:
    """Frequency, height and times, one sentence each."""
    both = 0.01 * (noise(2) + np.sin(2.0 * np.pi * 5.0 * TIME_S))
    both[1700:1710] += 0.3
    line = line_in(left(both))
    told = disturbance_issues(left(both), 0.2, line, channel="angle", unit="deg", factor=100.0)
    assert [issue.code for issue in told] == ["spectral-line", "short-events"]
    assert "at 5 Hz, 1" in told[0].message
    assert "1 short event while the input rests, at 17 s" in told[1].message
    quiet = left(noise(3))
    assert line_in(quiet) is None
    assert disturbance_issues(quiet, 0.2, None, channel="angle", unit="deg", factor=1.0) == ()
