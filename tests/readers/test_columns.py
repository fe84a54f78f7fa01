"""What names mean: a list of names as rigs write them, each with what a person would say."""

from __future__ import annotations

import pytest

from softid.readers.columns import (
    EXACT,
    LOOKALIKE,
    SYNONYM,
    best_matches,
    is_index_name,
    is_time_name,
    match_channel,
    read_name,
)


@pytest.mark.parametrize(
    ("name", "channel", "rank", "unit"),
    [
        ("time_s", "time", EXACT, "s"),
        ("t_ms", "time", SYNONYM, "ms"),
        ("Time (s)", "time", EXACT, "s"),
        ("time stamp [us]", "time", SYNONYM, "us"),
        ("seconds", "time", EXACT, "seconds"),
        ("pressure_kpa", "pressure", EXACT, "kpa"),
        ("pressure [bar]", "pressure", EXACT, "bar"),
        ("pressure (bar)", "pressure", EXACT, "bar"),
        ("Pressure", "pressure", EXACT, None),
        ("P_kPa", "pressure", SYNONYM, "kPa"),
        ("p/bar", "pressure", SYNONYM, "bar"),
        ("Druck in bar", "pressure", LOOKALIKE, "bar"),
        ("PressureMeas_kPa", "pressure", SYNONYM, "kPa"),
        ("P1_kPa", "pressure", LOOKALIKE, "kPa"),
        ("s1_p1_kpa", "pressure", LOOKALIKE, "kpa"),
        ("left_pressure", "pressure", LOOKALIKE, None),
        ("pressure2_kpa", "pressure", LOOKALIKE, "kpa"),
        ("pressure_in", "pressure", LOOKALIKE, None),  # the inlet, not inches
        ("pressure_cmd_kpa", "pressure_command", EXACT, "kpa"),
        ("Pressure command [psi]", "pressure_command", EXACT, "psi"),
        ("p_set_point_bar", "pressure_command", SYNONYM, "bar"),
        ("s1_p1_cmd_kpa", "pressure_command", LOOKALIKE, "kpa"),
        ("setpoint_kPa", "pressure_command", LOOKALIKE, "kPa"),
        ("Weg [mm]", "position", SYNONYM, "mm"),
        ("theta [deg]", "angle", SYNONYM, "deg"),
        ("θ/°", "angle", SYNONYM, "°"),
        ("bending angle (rad)", "angle", LOOKALIKE, "rad"),
        ("angle_rot_deg", "angle", LOOKALIKE, "deg"),
        ("bending_moment [N mm]", "torque", LOOKALIKE, "N mm"),
        ("force_n", "force", EXACT, "n"),
        ("position_mm", "position", EXACT, "mm"),
        ("contraction [mm]", "contraction", EXACT, "mm"),
    ],
)
def test_names_that_mean_a_channel(name: str, channel: str, rank: int, unit: str | None) -> None:
    read = read_name(name)
    assert match_channel(read) == (channel, rank)
    assert read.unit == unit


@pytest.mark.parametrize(
    "name",
    [
        *("angle_setpoint_deg", "position_ref_mm", "set_point", "pump_pwm", "flex_adc", "tip_x_mm"),
        *("supply_pressure_bar", "pressure_error", "p_gain", "T [degC]", "p_mm", "angle_rate"),
        *("sample", "", "   ", "[]", "col3", "x" * 1000, "()[]{}", "\x00"),
    ],
)
def test_names_that_mean_none(name: str) -> None:
    """Set-points of motion are no measured output; one letter needs a fitting unit."""
    assert match_channel(read_name(name)) is None


@pytest.mark.parametrize(
    ("name", "unit"),
    [("tip_x_mm", "mm"), ("flow [l/min]", "l/min"), ("count_n", None), ("e_v", None)],
)
def test_units_of_raw_columns(name: str, unit: str | None) -> None:
    assert read_name(name).unit == unit


def test_exact_names_beat_look_alikes_and_equals_stay_together() -> None:
    names = ["time_s", "p2_kpa", "pressure_kpa", "pressure2_kpa", "pos_a", "pos_b", "theta"]
    found = best_matches(names, range(len(names)))
    assert found == {"time": (0,), "pressure": (2,), "position": (4, 5), "angle": (6,)}


def test_only_plain_names_of_the_time_make_a_header() -> None:
    assert is_time_name("t [ms]")
    assert not is_time_name("time of day of the first run")


def test_index_names() -> None:
    assert all(map(is_index_name, ["", "Index", "Unnamed: 0", "#"]))
    assert not is_index_name("time")
