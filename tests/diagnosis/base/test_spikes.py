"""Readings that are far off those beside them are no misfit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from softid.diagnosis import diagnose
from softid.diagnosis.base.spikes import SPIKES
from softid.diagnosis_results import Verdict
from softid.log import Log
from softid.synthesis import hidden_pair


def spiked(log: Log) -> Log:
    """The log with nine readings a third of the output's deviation off, where it moves quickly.

    Two of them are side by side.
    """
    (name,) = log.outputs
    values = log.channels[name].values.copy()
    quick = np.argsort(-np.abs(np.diff(values)))[:400:50]
    values[[*quick.tolist(), int(quick[0]) + 1]] += 0.3 * np.std(values)
    channels = {**log.channels, name: replace(log.channels[name], values=values)}
    return replace(log, channels=channels)


@pytest.mark.parametrize("hidden", ["", pytest.param("creep", marks=pytest.mark.slow)])
def test_they_are_left_out_and_told(hidden: str) -> None:
    """Known truth: too small to be seen without a fit, beside the quick motion of an oscillator."""
    names = [hidden] if hidden else []
    train, hold_out = hidden_pair(names, seed=610, model="oscillator").logs
    logs = [spiked(log) for log in (train, hold_out)]
    found = diagnose(logs[0], hold_out=[logs[1]], model="oscillator")
    assert [cause.effect for cause in found.causes] == names
    assert found.verdict is (Verdict.NAMED if hidden else Verdict.ADEQUATE)
    told = [issue.message for issue in found.issues if issue.code == SPIKES]
    assert len(told) == 2
    assert told[0].startswith("train: ")


@pytest.mark.parametrize("at_jump", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_two_side_by_side_away_from_jumps_of_the_input(at_jump: bool) -> None:
    """Two readings alike, off by fifty deviations of the noise: beside a jump of the input a quick
    actuator may have moved, or not yet."""
    train, hold_out = hidden_pair([], seed=610, model="oscillator", protocol="levels").logs
    jump = int(np.argmax(np.abs(np.diff(train.channels[train.input].values))))
    first = jump + 1 if at_jump else jump - 40
    (name,) = train.outputs
    values = train.channels[name].values.copy()
    noise = np.std(np.diff(values[jump - 100 : jump])) / 2.0**0.5
    values[first : first + 2] = values[first - 1] + 50.0 * noise + np.array([0.0, noise])
    channels = {**train.channels, name: replace(train.channels[name], values=values)}
    found = diagnose(replace(train, channels=channels), hold_out=[hold_out], model="oscillator")
    told = [issue.message for issue in found.issues if issue.code == SPIKES]
    assert [message.startswith("train: 2 readings") for message in told] == [True] * (not at_jump)


@pytest.mark.slow
def test_noise_has_none() -> None:
    train, hold_out = hidden_pair([], seed=611).logs
    found = diagnose(train, hold_out=[hold_out], model="muscle")
    assert SPIKES not in {issue.code for issue in found.issues}


@pytest.mark.slow
def test_what_shows_a_delay_is_no_spike() -> None:
    """A lag of 0.1 s behind a delay of 50 ms, by the closed form of its steps: both are recovered.

    The base leaves a peak with a corner where each step arrives; without it the delay is too short.
    """
    delay_s, lag_s, rate_hz = 0.05, 0.1, 100.0

    def stepped(seed: int) -> Log:
        rng = np.random.default_rng(seed)
        time_s = np.arange(4500) / rate_hz
        at_s = np.cumsum(rng.uniform(0.5, 1.8, 60))
        levels = np.concatenate(([0.0], rng.uniform(0.0, 250.0, 60)))
        since_s = np.maximum(time_s[:, np.newaxis] - at_s - delay_s, 0.0)
        pressure = (np.diff(levels) * -np.expm1(-since_s / lag_s)).sum(axis=1)
        pressure += 0.75 * rng.standard_normal(time_s.size)
        command = levels[np.searchsorted(at_s, time_s, side="right")]
        channels = {"pressure_command": command, "pressure": pressure}
        return Log.from_arrays(
            time_s, channels, input="pressure_command", outputs=("pressure",), name=f"steps-{seed}"
        )

    found = diagnose(stepped(2), hold_out=[stepped(12)], model="oscillator", effects=["delay"])
    assert SPIKES not in {issue.code for issue in found.issues}
    assert found.extended is not None
    low, high = found.extended.parameter("delay_tau").ci95
    assert low < delay_s < high
    assert found.extended.parameter("delay_tau").value == pytest.approx(delay_s, rel=0.03)
    assert found.extended.parameter("N").value == pytest.approx(lag_s, rel=0.02)
