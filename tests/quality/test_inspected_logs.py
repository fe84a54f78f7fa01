"""What an inspection finds in measured logs, against what was seen in them by eye.

The facts were read off plots and run lengths of the raw columns, independently of the detectors;
the folder's README tells of stalls, drop-outs and the zero-order hold too.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from inspected import codes

from softid.excitation import Stretch
from softid.quality import Inspection, inspect
from softid.readers import load

BEND_SENSOR = {
    "New_Step_dataset_0_60_11": (3, []),
    "Ramp_dataset_10_3": (31, [(705, 1.37), (3168, 52.54), (3296, 49.29)]),
    "Sin_dataset_2": (37, [(723, 36.92), (1366, 9.36)]),
    "Step_dataset2": (6, [(987, 9.89)]),
}
"""Intervals above 0.5 s, and samples that lost their first digit, such as 31.37 → 1.37."""


@cache
def inspected(path: Path) -> Inspection:
    return inspect(load(path))


def longest_kind(stretches: Sequence[Stretch]) -> str:
    """The kind of excitation that goes on for the longest time, all its stretches together."""
    lasting: dict[str, float] = defaultdict(float)
    for stretch in stretches:
        if stretch.kind != "rest":
            lasting[stretch.kind] += stretch.duration_s
    return max(lasting, key=lambda kind: lasting[kind])


@pytest.mark.parametrize("name", BEND_SENSOR)
def test_stalls_and_drop_outs_of_the_bend_sensor(measured: Path, name: str) -> None:
    """Every interval above 0.5 s (all 1.06 to 1.10 s) and every lost digit, nothing else."""
    found = inspected(measured / "pneunet-finger-bendsensor" / f"{name}.csv")
    stalls, lost = BEND_SENSOR[name]
    assert len(found.sampling.stalls) == stalls
    assert all(1.0 < stall.length_s < 1.2 for stall in found.sampling.stalls)
    angle = found.channel("angle")
    assert [
        (d.start, round((d.value or 0.0) * angle.display_factor, 2)) for d in angle.dropouts
    ] == lost
    assert all(d.cause == "lost digit" and d.stop == d.start + 1 for d in angle.dropouts)


@pytest.mark.parametrize("name", BEND_SENSOR)
def test_dead_band_of_the_bend_sensor(measured: Path, name: str) -> None:
    """The angle stands, then jumps by 0.75 to 0.85 degrees: 0.05, 0.05, −0.78, −0.78, …"""
    angle = inspected(measured / "pneunet-finger-bendsensor" / f"{name}.csv").channel("angle")
    assert angle.dead_band is not None
    assert angle.dead_band * angle.display_factor == pytest.approx(0.8, abs=0.06)
    assert angle.hold is None


def test_zero_order_hold_of_the_fabric_arm(measured: Path) -> None:
    """Runs of the pressures are 16 to 18 samples; those of the angle 1, 2 and 3, mean 1.9."""
    found = inspected(measured / "fabric-arm" / "oct25_axial.csv")
    angle, pressure = found.channel("angle").hold, found.channel("pressure").hold
    assert angle is not None
    assert pressure is not None
    assert angle.factor == pytest.approx(1.9, abs=0.1)
    assert pressure.factor == pytest.approx(17.0, abs=0.3)
    assert pressure.hold_s == pytest.approx(0.174, abs=0.002)


def test_excitation_of_the_fabric_arm(measured: Path) -> None:
    """0.1 Hz by its README, 0 to 69 kPa; the lag of 0.94 s computed there, roughly."""
    found = inspected(measured / "fabric-arm" / "oct25_axial.csv")
    assert found.command_excitation is not None
    (wave,) = found.command_excitation
    assert wave.kind == "sine"
    assert wave.frequency_hz == pytest.approx(0.1, rel=0.01)
    assert wave.amplitude == pytest.approx(34.5, rel=0.02)
    assert longest_kind(found.excitation) == "sine"
    assert found.command_lag is not None
    assert found.command_lag.lag_s == pytest.approx(0.94, rel=0.15)


@pytest.mark.parametrize("level", [20, 60, 100, 140, 200])
def test_quantisation_and_steps_of_the_gripper(measured: Path, level: int) -> None:
    """Pressures differ by multiples of 0.8425 kPa; the pump runs for 3 s of 6."""
    found = inspected(measured / "gripper-finger" / f"calibration_flex_{level}.csv")
    grid = found.channel("pressure").quantisation
    assert grid is not None
    assert grid.step == pytest.approx(0.84247, rel=1e-4)
    if level > 20:  # at 20 the pressure rises by one step only
        (stretch,) = found.excitation
        assert stretch.kind == "step"
        assert stretch.transitions == 2
        assert stretch.levels[0] == pytest.approx(-1.1, abs=0.3)


@pytest.mark.parametrize(
    ("name", "levels", "transitions"),
    [
        ("0730_step_1", (10.3, 34.5), 12),
        ("0730_step_2", (10.3, 68.9), 12),
        ("0730_step_3", (10.3, 103.4), 12),
        ("0730_step_4", (10.3, 137.9), 12),
    ],
)
def test_six_cycles_of_the_three_chamber_arm(
    measured: Path, name: str, levels: tuple[float, float], transitions: int
) -> None:
    """Command: exact; measured: the same two levels, within 1.5 kPa of the regulator's error."""
    found = inspected(measured / "three-chamber-arm" / f"{name}.csv")
    assert found.command_excitation is not None
    (wanted,) = found.command_excitation
    assert (wanted.kind, wanted.transitions) == ("step", transitions)
    assert wanted.levels == pytest.approx(levels, abs=0.1)
    assert longest_kind(found.excitation) in ("step", "staircase")
    reached = [level for s in found.excitation for level in s.levels]
    assert min(reached) == pytest.approx(levels[0], abs=1.5)
    assert max(reached) == pytest.approx(levels[1], abs=1.5)
    assert found.channel("pressure").quantisation is not None
    assert found.channel("pressure").quantisation.step == pytest.approx(0.3, rel=1e-3)


def test_the_triangle_of_the_three_chamber_arm(measured: Path) -> None:
    """Six cycles of 15.6 s between 7 and 172 kPa, 7 s of rest at either end."""
    found = inspected(measured / "three-chamber-arm" / "0721_ramp.csv")
    assert found.command_excitation is not None
    assert [s.shape or s.kind for s in found.command_excitation] == ["rest", "triangle", "rest"]
    triangle = found.command_excitation[1]
    assert triangle.cycles == pytest.approx(6.0, abs=0.1)
    assert triangle.rate == pytest.approx(21.2, rel=0.03)
    assert longest_kind(found.excitation) == "sweep"


@pytest.mark.parametrize(("name", "hold_s"), [("1", 7.4), ("3", 3.3), ("4", 1.5)])
def test_squares_of_the_three_chamber_arm(measured: Path, name: str, hold_s: float) -> None:
    """Five cycles between 6.9 and 172.4 kPa; a log without a motion takes the command as input."""
    path = measured / "three-chamber-arm" / f"0706_pressure_only_square_{name}.csv"
    found = inspect(load(path, input="pressure_command", outputs=["pressure"]))
    (square,) = found.excitation
    assert (square.kind, square.transitions) == ("step", 10)
    assert square.levels == pytest.approx((6.9, 172.4), abs=0.1)
    assert square.hold_s == pytest.approx(hold_s, rel=0.05)


def test_the_baseline_of_the_two_segment_arm(measured: Path) -> None:
    """At rest: nothing but noise, of a pressure that moves on seven levels of 0.644 kPa."""
    found = inspected(measured / "two-segment-arm" / "Jan10-1_baseline.csv")
    assert [s.kind for s in found.excitation] == ["rest"]
    assert "input-at-rest" in codes(found)
    pressure = found.channel("pressure")
    assert pressure.quantisation is not None
    assert pressure.quantisation.step == pytest.approx(0.6439, rel=1e-3)
    assert pressure.quantisation.levels == 7
    assert pressure.noise_std == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize("name", ["apr4_1", "apr4_2"])
def test_a_pressure_that_was_stuck(measured: Path, name: str) -> None:
    """One value from 10.0 to 20.1 s amid 1 kPa of noise, in 540 and 567 samples."""
    found = inspected(measured / "two-segment-arm" / f"{name}.csv")
    (stuck,) = found.channel("pressure").frozen
    assert stuck.start_s == pytest.approx(10.1, abs=0.1)
    assert stuck.length_s == pytest.approx(10.03, abs=0.05)
    assert stuck.stop - stuck.start == (540 if name == "apr4_1" else 567)


@pytest.mark.parametrize("name", ["Jan5_1", "Jan5_2", "Jan10-4_R_1", "Jan10-4_R_2", "feb21"])
def test_steps_of_the_two_segment_arm(measured: Path, name: str) -> None:
    """Two levels for 10 s each; a clock that varies by half; no stall, no drop-out of a sensor."""
    found = inspected(measured / "two-segment-arm" / f"{name}.csv")
    (steps,) = found.excitation
    assert steps.kind == "step"
    assert steps.hold_s == pytest.approx(8.5, abs=0.6)
    assert found.sampling.jitter > 0.4
    assert found.sampling.stalls == ()
    assert {"drop-outs", "frozen-channel", "saturation", "inverted-sign"}.isdisjoint(codes(found))


def test_every_measured_log_can_be_inspected(measured: Path) -> None:
    """No log ends in an error, none of the good rigs has an inverted sign."""
    paths = [p for p in sorted(measured.glob("*/*.csv")) if p.parent.name != "raw"]
    assert len(paths) > 20
    for path in paths:
        if path.name.startswith("0706"):
            continue
        found = inspected(path)
        assert len(found.abilities) == (6 if found.input == "force" else 8)
        assert np.isfinite(found.sampling.rate_hz)
        assert "inverted-sign" not in codes(found), path.name


def test_a_slow_fall_is_no_hold(measured: Path) -> None:
    """0730_step_1 falls from 34 to 27 kPa in 1.1 s, then faster: six pulses between two levels, by
    the command as by the measured pressure, and no level of 27 kPa between them."""
    found = inspected(measured / "three-chamber-arm" / "0730_step_1.csv")
    assert found.command_excitation is not None
    for (stretch,) in (found.excitation, found.command_excitation):
        assert (stretch.kind, stretch.transitions, len(stretch.levels)) == ("step", 12, 2)


@pytest.mark.parametrize("name", ["KDN_1bar", "KDN_3bar"])
def test_no_more_changes_are_timed_than_counted(measured: Path, name: str) -> None:
    """Table and judgement rest on the same holds, so both tell the same number of changes."""
    found = inspected(measured / "printed-cylinder" / f"{name}.csv")
    (stretch,) = found.excitation
    assert found.responses[0].transitions == stretch.transitions
