"""A range check that asks: thresholds are the module's constants, each tried on both sides."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from softid.channels import make_channel
from softid.errors import InputError
from softid.readers import load
from softid.readers.ranges import (
    HIGHEST_PRESSURE_KPA,
    LARGEST_ANGLE_RAD,
    SMALLEST_SPAN_KPA,
    find_doubt,
)

WriteFile = Callable[..., Path]


@pytest.mark.parametrize(
    ("name", "values", "unit", "better"),
    [
        ("pressure", [0.0, 1e5], "bar", "Pa"),
        ("pressure", [0.0, 1e5], "kPa", "Pa"),
        ("pressure_command", [0.0, 80.0], "bar", "kPa"),
        ("pressure", [0.0, 2.0], "Pa", "kPa"),
        ("angle", [0.0, 45.0], "rad", "deg"),
    ],
)
def test_a_wrong_unit_is_doubted(name: str, values: list[float], unit: str, better: str) -> None:
    """With ten samples at the top the 99th percentile is the top value."""
    doubt = find_doubt(make_channel(name, values + values[1:] * 10, unit))
    assert doubt is not None
    assert doubt.better == better
    assert doubt.value == pytest.approx(values[1])


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("pressure", [HIGHEST_PRESSURE_KPA, HIGHEST_PRESSURE_KPA]),
        ("pressure", [0.0, SMALLEST_SPAN_KPA]),
        ("pressure", [100.0, 100.0]),
        ("pressure", [101.30, 101.31]),  # a rig at rest
        ("pressure", [-90.0, 0.0]),
        ("angle", [-LARGEST_ANGLE_RAD, LARGEST_ANGLE_RAD]),
        ("force", [0.0, 1e9]),
        ("pressure", [np.nan, np.nan]),
    ],
)
def test_what_is_plausible_is_not_doubted(name: str, values: list[float]) -> None:
    assert find_doubt(make_channel(name, values)) is None


def test_single_spikes_do_not_count() -> None:
    values = np.linspace(0.0, 100.0, 1000)
    values[500] = 1e6
    assert find_doubt(make_channel("pressure", values)) is None


def test_the_reader_asks_and_an_explicit_unit_answers(write_log: WriteFile) -> None:
    """Pa taken for bar, as in the header of a log whose author meant Pa."""
    rows = "".join(f"{k},{20000 * k},{k}\n" for k in range(6))
    path = write_log("time_s,pressure_bar,angle_deg\n" + rows)
    with pytest.raises(InputError, match="is that its unit") as caught:
        load(path)
    assert "--channel pressure=pressure_bar:Pa" in str(caught.value)
    assert "column pressure_bar" in str(caught.value)
    assert load(path, channels={"pressure": "pressure_bar:Pa"}).pressure_kpa[1] == 20.0
    assert load(path, channels={"pressure": "pressure_bar:bar"}).pressure_kpa[1] == 2e6
    with pytest.raises(InputError, match="is that its unit"):
        load(path, channels={"pressure": "pressure_bar"})  # no unit stated: still asked


def test_the_only_fitting_unit_is_confirmed_not_proposed(write_log: WriteFile) -> None:
    """An angle of three turns in degrees has no better unit, so the question is only: really?"""
    path = write_log("time_s,pressure_kpa,angle_deg\n0,0,0\n1,50,600\n2,90,1100\n")
    with pytest.raises(InputError, match="confirm deg with --channel angle=angle_deg:deg, or map"):
        load(path)
    assert load(path, channels={"angle": "angle_deg:deg"}).channels["angle"].displayed[2] == 1100
