"""Samples that depend on what the input did before the log began."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import linear_angle

from softid.diagnosis import diagnose
from softid.diagnosis.logs.moving_start import (
    LONGEST_S,
    LONGEST_SHARE,
    MOST_TRAVEL,
    without_moving_start,
)
from softid.diagnosis_results import Verdict
from softid.effects import delay
from softid.identification.input_denoising import without_input_noise
from softid.log import Log
from softid.synthesis import hidden_pair

Array = npt.NDArray[np.float64]

TIME_S = np.arange(0.0, 40.0, 0.02)
MOTION_S = 0.2
STATES = 2


def sine(time_s: Array = TIME_S, *, rest_s: float = 0.0) -> Array:
    pressure: Array = 50.0 - 40.0 * np.cos(np.pi * np.maximum(time_s - rest_s, 0.0))
    return pressure


def log_of(pressure: Array, time_s: Array = TIME_S) -> Log:
    angle = 0.01 * pressure
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}, name="moves")


def left_out(log: Log, motion_s: float = MOTION_S) -> Array:
    """Times that are left out, in s."""
    masked = without_moving_start(log, motion_s, states=STATES).masked
    assert masked is not None
    return log.time_s[masked]


def test_it_is_as_long_as_the_longest_delay() -> None:
    assert (LONGEST_S, LONGEST_SHARE) == (delay.LONGEST_S, delay.LONGEST_SHARE)


def test_a_drift_through_a_rest_is_no_motion() -> None:
    """The output creeps by a tenth of its range in ten seconds of rest, by a hundredth in the first
    one."""
    log = log_of(sine(rest_s=10.0))
    angle = log.channels["angle"]
    drifting = replace(angle, values=angle.values + 0.0075 * TIME_S)
    drifts = replace(log, channels={**log.channels, "angle": drifting})
    trembling = 0.004 * np.random.default_rng(1).standard_normal(TIME_S.size)
    noisy = replace(drifting, values=drifting.values + trembling)
    assert left_out(replace(drifts, channels={**log.channels, "angle": noisy})).size == 0


@pytest.mark.parametrize("seed", range(8))
def test_loud_noise_at_rest_is_no_motion(seed: int) -> None:
    """A twentieth of the range, of which averages of five samples still have a fiftieth."""
    log = log_of(sine(rest_s=3.0))
    angle = log.channels["angle"]
    noise = 0.04 * np.random.default_rng(seed).standard_normal(TIME_S.size)
    loud = replace(angle, values=angle.values + noise)
    assert left_out(replace(log, channels={**log.channels, "angle": loud})).size == 0


def test_a_log_that_begins_at_rest_is_itself() -> None:
    """The same object, so that nothing is fitted again."""
    log = log_of(sine(rest_s=1.5))
    assert without_moving_start(log, MOTION_S, states=STATES) is log


@pytest.mark.parametrize("seed", range(5))
def test_noise_of_a_gauge_at_rest_is_no_motion(seed: int) -> None:
    """A pressure that rests for two seconds, read with noise of 2 % of its range and averaged."""
    pressure = sine(rest_s=2.0)
    log = log_of(pressure)
    noisy = pressure + 1.6 * np.random.default_rng(seed).standard_normal(TIME_S.size)
    read = replace(log.channels["pressure"], values=noisy)
    log = without_input_noise(replace(log, channels={**log.channels, "pressure": read}))
    assert without_moving_start(log, MOTION_S, states=STATES) is log


def test_an_input_that_stays_is_known() -> None:
    """A motion that was set free shows itself in its first second, and no input was before it."""
    log = log_of(np.where(TIME_S > 5.0, 80.0, 0.0) * (TIME_S % 4.0 < 2.0))
    assert without_moving_start(log, MOTION_S, states=STATES) is log


@pytest.mark.parametrize(("later", "counts"), [(True, True), (False, False)])
def test_a_motion_that_has_just_lost_its_drive_goes_on(later: bool, counts: bool) -> None:
    """The input stays, the output decays; where nothing else moves, the decay is all there is."""
    pressure = np.where(later & (TIME_S > 5.0), 80.0, 0.0) * (TIME_S % 4.0 < 2.0)
    angle = 0.01 * pressure + np.exp(-TIME_S / 0.4)
    log = Log.from_arrays(TIME_S, {"pressure": pressure, "angle": angle})
    assert (left_out(log).size > 0) is counts


@pytest.mark.parametrize("rest_s", [0.0, 0.4])
def test_what_moves_at_once_is_left_out_but_for_its_states(rest_s: float) -> None:
    """By definition: up to the longest delay, but for as many samples as there are states."""
    log = log_of(sine(rest_s=rest_s))
    found = left_out(log)
    assert found[0] == TIME_S[STATES]
    assert found[-1] == pytest.approx(LONGEST_S, abs=0.011)
    assert found.size == round(LONGEST_S / 0.02) + 1 - STATES
    (issue,) = without_moving_start(log, MOTION_S, states=STATES).issues
    assert (issue.code, issue.severity) == ("moving-start", "info")
    assert f"{found.size} samples" in issue.message


def test_a_slow_actuator_remembers_for_longer_and_a_short_log_loses_a_tenth() -> None:
    assert left_out(log_of(sine()), motion_s=2.5)[-1] == pytest.approx(2.5, abs=0.021)
    short = log_of(sine()).between(0.0, 4.0)
    assert left_out(short)[-1] == pytest.approx(LONGEST_SHARE * 4.0, abs=0.021)


def test_samples_without_an_output_determine_no_state() -> None:
    """The two that stay are the first two that were recorded."""
    log = log_of(sine())
    angle = log.channels["angle"]
    values = np.where(TIME_S < 0.1, np.nan, angle.values)
    log = replace(log, channels={**log.channels, "angle": replace(angle, values=values)})
    kept = without_moving_start(log, MOTION_S, states=STATES)
    assert np.array_equal(np.flatnonzero(kept.segments()[0].used["angle"])[:3], (5, 6, 51))


def test_every_stretch_begins_anew() -> None:
    """After a stall nobody knows what the input did in it."""
    stalled = np.concatenate((TIME_S[:1000], TIME_S[1000:] + 30.0))
    found = left_out(log_of(sine(stalled), stalled))
    assert np.array_equal(np.unique(np.floor(found)), (0.0, 1.0, 50.0, 51.0))
    told = without_moving_start(log_of(sine(stalled), stalled), MOTION_S, states=STATES).issues
    assert "and of 1 more stretches" in told[0].message


@pytest.mark.parametrize("steps", [2, 12])
def test_the_first_of_a_few_steps_is_kept(steps: int) -> None:
    """It makes one of so many parts of the whole way."""
    pressure = np.where(TIME_S > 0.5, 80.0, 0.0)
    for k in range(1, steps):
        pressure[0.5 + 3.0 * k < TIME_S] = 80.0 * (1 - k % 2)
    assert (left_out(log_of(pressure)).size > 0) == (1.0 / steps < MOST_TRAVEL)


def test_noise_of_the_input_is_no_way() -> None:
    """Trembling by a hundredth of the range, 2000 times, makes a way of 20 ranges, none of them."""
    rng = np.random.default_rng(4)
    pressure = np.where(TIME_S > 0.5, 80.0, 0.0) * (TIME_S < 20.0)
    log = log_of(pressure + 0.2 * rng.standard_normal(TIME_S.size))
    assert without_moving_start(log, MOTION_S, states=STATES) is log


@pytest.mark.parametrize("rate_hz", [0.3, pytest.param(0.7, marks=pytest.mark.slow)])
def test_a_delay_is_no_resonance_where_a_log_begins_in_mid_motion(rate_hz: float) -> None:
    """Two sines through 120 ms of delay and a linear actuator, cut out of a longer motion."""

    def cut(seed: int) -> Log:
        time_s = np.arange(0.0, 40.0, 0.02)
        pressure = 60.0 + 25.0 * np.sin(2.0 * np.pi * rate_hz * time_s)
        pressure += 25.0 * np.sin(2.0 * np.pi * (0.4 + rate_hz) * time_s + seed)
        late = np.interp(time_s - 0.12, time_s, pressure)
        noise = 0.004 * np.random.default_rng(seed).standard_normal(time_s.size)
        angle = linear_angle(time_s, late) + noise
        whole = {"pressure": pressure, "angle": angle}
        return Log.from_arrays(time_s, whole, name=f"cut-{seed}").between(10.0, 40.0)

    found = diagnose(cut(1), hold_out=[cut(2)], model="oscillator")
    told = {*(cause.effect for cause in found.causes)}
    told |= {name for tie in found.alternatives for name in tie.effects}
    assert found.verdict in (Verdict.NAMED, Verdict.AMBIGUOUS)
    assert "delay" in told
    assert found.causes[0].effect == "delay"
    assert found.causes[0].parameters[0].value == pytest.approx(0.12, rel=0.2)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, 6))
def test_a_creep_is_named_in_a_log_that_begins_in_motion(seed: int) -> None:
    """Both logs begin 7 s late, with the material on its way: k and τ to a fifth or within 95 %."""
    pair = hidden_pair(["creep"], seed=8200 + seed)
    fitted, held_out = (log.between(log.time_s[0] + 7.0, np.inf) for log in pair.logs)
    found = diagnose(fitted, hold_out=held_out, model="muscle")
    assert found.verdict in (Verdict.NAMED, Verdict.PARTIAL)
    assert found.causes[0].effect == "creep"
    for estimate in found.causes[0].parameters:
        truth = pair.hidden["creep"][estimate.name.removeprefix("creep_")]
        low, high = estimate.ci95 or (estimate.value, estimate.value)
        assert low <= truth <= high or estimate.value == pytest.approx(truth, rel=0.2)
