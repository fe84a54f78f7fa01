"""What an output does while the input is held, and what that says of the log."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from drawn_logs import follow
from inspected import codes

from softid.log import Log
from softid.quality import Inspection, inspect
from softid.readers import load


def held_log(
    extra_deg: np.ndarray | float = 0.0, *, zeros: Sequence[int] = (), **others: np.ndarray
) -> Inspection:
    """0, 60 and 0 kPa, the middle level for 40 s, and an angle with a lag of 0.5 s.

    The angle reads zero at some samples.
    """
    rng = np.random.default_rng(0)
    time_s = np.arange(5500) * 0.01
    pressure = np.where((time_s >= 10.0) & (time_s < 50.0), 60.0, 0.0)
    angle = 0.5 * follow(time_s, pressure, 0.5) + extra_deg + 0.01 * rng.standard_normal(5500)
    angle[list(zeros)] = 0.0
    channels = {"pressure": pressure, "angle": angle, **others}
    return inspect(Log.from_arrays(time_s, channels, units={"angle": "deg"}))


def test_a_settling_output_is_explained() -> None:
    """A first-order lag of 0.5 s in holds of 5 s and more: at rest to e^-10, no remark."""
    found = held_log()
    assert [h.settled for h in found.holds] == [True, True, True]
    assert [h.unexplained for h in found.holds] == [None, None, None]
    assert [h.after_change for h in found.holds] == [False, True, True]
    assert codes(found).isdisjoint({"moves-by-itself", "moving-at-start", "other-inputs"})
    assert found.ability("creep").possible == "yes"
    assert found.ability("sensor drift").possible == "yes"


def test_faults_of_a_sensor_are_no_motion() -> None:
    """Zeros for three samples, seven times in a hold at 30 deg: too long for a median of five."""
    found = held_log(zeros=[k + j for k in range(2000, 4800, 400) for j in range(3)])
    assert "drop-outs" in codes(found)
    assert [h.unexplained for h in found.holds] == [None, None, None]
    assert "moves-by-itself" not in codes(found)


def test_a_second_chamber_moves_the_output() -> None:
    """A second pressure of 40 kPa toggles every 8 s during the hold: its name is told, and neither
    creep nor drift is promised from that hold."""
    time_s = np.arange(5500) * 0.01
    second = np.where((time_s > 12.0) & (time_s < 50.0) & ((time_s // 8.0) % 2 == 0), 40.0, 0.0)
    found = held_log(0.3 * follow(time_s, second, 0.5), other_kpa=second)
    (issue,) = (i for i in found.issues if i.code == "moves-by-itself")
    assert found.holds[1].unexplained is not None
    assert np.rad2deg(found.holds[1].unexplained) == pytest.approx(12.0, abs=0.5)
    assert found.ability("creep").possible == "no"
    assert found.ability("sensor drift").possible == "no"
    assert "angle moves by itself" in found.ability("creep").reason
    assert "10.00 to 49.99 s" in issue.message


def test_a_damped_swing_is_explained() -> None:
    """A swing of 8 deg at 0.5 Hz that dies away with 3 s belongs to the step."""
    time_s = np.arange(5500) * 0.01
    since = np.maximum(time_s - 10.0, 0.0)
    found = held_log(8.0 * np.exp(-since / 3.0) * np.sin(np.pi * since))
    assert "moves-by-itself" not in codes(found)


def test_an_output_that_moves_before_the_input() -> None:
    """6 of 30 degrees are lost in the first 10 s, before any change of pressure."""
    time_s = np.arange(5500) * 0.01
    found = held_log(6.0 * np.exp(-time_s / 2.0))
    (issue,) = (i for i in found.issues if i.code == "moving-at-start")
    assert "0.00 to 9.99 s" in issue.message
    assert found.holds[0].at_start is not None
    assert np.rad2deg(found.holds[0].at_start) == pytest.approx(6.0, abs=0.2)


def test_a_drive_without_a_spring_has_no_static_curve() -> None:
    """Speed follows force: the position runs on through every hold, so no level settles, nothing
    is said of pressures, and the times to 63 % are no damping."""
    rng = np.random.default_rng(0)
    time_s = np.arange(6000) * 0.01
    force = np.repeat([0.0, 10.0, -10.0, 20.0, -20.0, 0.0], 1000)
    position = 0.01 * np.cumsum(0.001 * force) + 1e-6 * rng.standard_normal(6000)
    channels = {"force": force, "position": position}
    found = inspect(Log.from_arrays(time_s, channels, input="force", outputs=["position"]))
    names = [a.name for a in found.abilities]
    assert "damping by pressure" not in names
    assert "pneumatic lag" not in names
    assert found.ability("static curve").possible != "yes"
    assert found.ability("damping").possible == "partly"
    assert "still moving" in found.ability("damping").reason
    assert found.ability("hysteresis").possible != "yes"


def test_two_levels_are_two_however_long_one_is() -> None:
    """4 s at 0 and 120 s at 60 kPa: table and judgement both tell of two levels."""
    time_s = np.arange(6200) * 0.02
    pressure = np.where(time_s < 120.0, 60.0, 0.0)
    angle = 0.5 * follow(time_s, pressure, 0.3)
    found = inspect(Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}))
    assert found.excitation[0].levels == pytest.approx((0.0, 60.0))
    assert found.excitation[0].shortest_hold_s == pytest.approx(4.0, abs=0.1)
    assert found.excitation[0].longest_hold_s == pytest.approx(120.0, abs=0.1)
    assert "only 2 settled levels" in found.ability("static curve").reason


def test_only_pressures_tell_nothing_of_the_actuator() -> None:
    """Command to pressure identifies valve and line; the judgement says so."""
    time_s = np.arange(4000) * 0.01
    command = np.where((time_s // 10.0) % 2 == 0, 0.0, 60.0)
    channels = {"pressure_command": command, "pressure": follow(time_s, command, 0.4)}
    log = Log.from_arrays(time_s, channels, input="pressure_command", outputs=["pressure"])
    told = {a.name: a.possible for a in inspect(log).abilities}
    assert told == {"motion": "no", "sensor drift": "no", "pneumatic lag": "yes"}


def test_channels_without_unit_are_no_second_input() -> None:
    """A duty cycle drives; a converter's counts that follow it are no input, though both are
    pure numbers."""
    time_s = np.arange(3000) * 0.01
    duty = np.where((time_s // 5.0) % 2 == 0, 0.0, 100.0)
    counts = np.round(500.0 + follow(time_s, duty, 0.3))
    channels = {"pwm": duty, "adc": counts, "angle": follow(time_s, 0.004 * duty, 0.3)}
    log = Log.from_arrays(time_s, channels, input="pwm", outputs=["angle"])
    assert "other-inputs" not in codes(inspect(log))


def test_a_motion_beside_a_pressure_is_judged() -> None:
    """With a pressure as first output and falling counts as second, the counts are the motion;
    they may fall, as raw counts have no sign to be wrong."""
    time_s = np.arange(3000) * 0.01
    duty = np.where((time_s // 5.0) % 2 == 0, 0.0, 100.0)
    pressure = follow(time_s, duty, 0.3)
    channels = {"pwm": duty, "pressure": pressure, "adc": np.round(600.0 - 2.0 * pressure)}
    log = Log.from_arrays(time_s, channels, input="pwm", outputs=["pressure", "adc"])
    found = inspect(log)
    assert "motion" not in {a.name for a in found.abilities}
    assert found.ability("static curve").possible == "partly"
    assert "inverted-sign" not in codes(found)


@pytest.mark.parametrize("name", ["apr5_1", "feb21"])
def test_arm_whose_other_chambers_move(measured: Path, name: str) -> None:
    """In apr5_1 chambers 2 and 3 go 110 → 10 kPa three times while chamber 1 stays at 104 kPa; in
    feb21 all chambers are deflated together and the angle wanders until the end of the hold."""
    found = inspect(load(measured / "two-segment-arm" / f"{name}.csv"))
    assert {"moves-by-itself", "other-inputs"} <= codes(found)
    assert found.ability("creep").possible == "no"
    assert found.ability("sensor drift").possible == "no"
    assert "2 levels" in found.ability("static curve").reason
    assert found.ability("damping").possible == "partly"


def test_a_change_out_of_a_stuck_pressure_is_not_timed(measured: Path) -> None:
    """The pressure repeats one value from 10 to 20 s and then falls by 70 kPa between two samples
    while the angle needs 3 s: the only change of this log says nothing of the input's speed."""
    for name in ("apr4_1", "apr4_2"):
        found = inspect(load(measured / "two-segment-arm" / f"{name}.csv"))
        assert found.responses == ()
        assert found.ability("inertia").possible == "no"
        assert "stuck" in found.ability("damping").reason


def test_strokes_and_force_steps_do_not_settle(measured: Path) -> None:
    """The cylinder is pulled at constant speed and the drive has no spring: no static curve."""
    for name in ("printed-cylinder/KDN_3bar", "linear-drive-friction/DATA_EMPS"):
        found = inspect(load(measured / f"{name}.csv"))
        assert found.ability("static curve").possible == "no"
        assert "settles at none of them" in found.ability("static curve").reason


def test_arm_that_moves_before_its_pressure(measured: Path) -> None:
    """0721_ramp: the angle falls from 0 to −19.5 degrees while the pressure rests at 14 kPa."""
    found = inspect(load(measured / "three-chamber-arm" / "0721_ramp.csv"))
    assert "moving-at-start" in codes(found)
