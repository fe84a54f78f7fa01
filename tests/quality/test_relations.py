"""Sign, lag and step response against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from drawn_logs import follow, staircase_log, with_fault

from softid.log import Log
from softid.quality import inspect
from softid.quality.relations import check_sign, command_lag


def test_a_sign() -> None:
    """An angle that follows is in order, turned round it is inverted; both tell the correlation."""
    right = check_sign(staircase_log(), "angle")
    wrong = check_sign(with_fault(staircase_log(), "angle", lambda v: -v), "angle")
    assert right is not None
    assert wrong is not None
    assert (right.inverted, wrong.inverted) == (False, True)
    assert right.correlation == pytest.approx(-wrong.correlation)
    assert right.correlation > 0.98


@pytest.mark.parametrize("name", ["distance", "length"])
def test_a_distance_falls_with_pressure(name: str) -> None:
    """D(θ) falls strictly on the working branch and L = L0 − x always; rising ones are inverted."""
    log = staircase_log()
    pressure = log.pressure_kpa
    for sign, inverted in ((-1.0, False), (1.0, True)):
        channels = {"pressure": pressure, name: 150.0 + sign * 0.5 * pressure}
        check = check_sign(Log.from_arrays(log.time_s, channels), name)
        assert check is not None
        assert check.inverted is inverted


def test_a_slow_sine_is_not_inverted() -> None:
    """A quarter of the period is the longest lag that is tried: −sin is sin half a period late."""
    time_s = np.arange(6000) * 0.01
    pressure = 40.0 + 30.0 * np.sin(2 * np.pi * 0.1 * time_s)
    angle = np.sin(2 * np.pi * 0.1 * (time_s - 2.0))
    check = check_sign(Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}), "angle")
    assert check is not None
    assert not check.inverted
    assert check.lag_s == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("delay_s", [0.0, 0.13, 0.94])
def test_a_pure_delay(delay_s: float) -> None:
    """The lag of a delayed 0.1 Hz sine is the delay, to a sample."""
    time_s = np.arange(6000) * 0.02
    wave = [40.0 + 30.0 * np.sin(2 * np.pi * 0.1 * (time_s - d)) for d in (0.0, delay_s)]
    channels = {"pressure_command": wave[0], "pressure": wave[1], "angle": wave[1]}
    lag = command_lag(Log.from_arrays(time_s, channels))
    assert lag is not None
    assert lag.lag_s == pytest.approx(delay_s, abs=0.03)


def test_no_lag_without_motion() -> None:
    """A resting command says nothing of the pneumatics."""
    log = with_fault(staircase_log(), "pressure_command", np.zeros_like)
    assert command_lag(log) is None
    assert inspect(log).ability("pneumatic lag").possible == "no"


def test_a_step_response() -> None:
    """A first-order lag makes 63.2 % of a step in its time constant, without overshoot."""
    time_s = np.arange(4000) * 0.005
    pressure = np.repeat([0.0, 60.0, 0.0, 60.0], 1000)
    log = Log.from_arrays(
        time_s, {"pressure": pressure, "angle": 0.01 * follow(time_s, pressure, 0.5)}
    )
    (response,) = inspect(log).responses
    assert response.transitions == 3
    assert response.input_t63_s == pytest.approx(0.005, abs=0.006)
    assert response.output_t63_s == pytest.approx(0.5, abs=0.02)
    assert response.overshoot == pytest.approx(0.0, abs=0.01)


def test_an_overshoot() -> None:
    """A second-order system of damping ratio 0.4 overshoots by exp(−πζ/√(1−ζ²)) = 25.4 %."""
    time_s = np.arange(6000) * 0.005
    omega, zeta = 4.0, 0.4
    fast = omega * np.sqrt(1 - zeta**2)
    rise_s = np.maximum(time_s - 10.0, 0.0)
    decay = np.exp(-zeta * omega * rise_s)
    angle = 1.0 - decay * (np.cos(fast * rise_s) + zeta * omega / fast * np.sin(fast * rise_s))
    channels = {"pressure": np.where(time_s < 10.0, 0.0, 50.0), "angle": angle}
    found = inspect(Log.from_arrays(time_s, channels))
    assert found.responses[0].overshoot == pytest.approx(0.254, abs=0.01)
    assert found.ability("inertia").possible == "yes"


def test_an_inverted_sign_names_the_option_that_turns_it() -> None:
    """The remedy is the flag of this channel, with its column and unit and a minus before it."""
    found = inspect(with_fault(staircase_log(), "angle", lambda v: -v))
    (issue,) = (i for i in found.issues if i.code == "inverted-sign")
    assert issue.remedy is not None
    assert "--channel angle=angle:-deg" in issue.remedy
