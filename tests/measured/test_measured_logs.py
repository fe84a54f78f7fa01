"""Every measured log loads, and the raw files equal the tidied ones that were made from them.

The tidied files were written with four to six digits, which sets the tolerances. Their pressures
are the raw psi times 6.894757 with no zero taken off, their times begin at the first sample.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from softid.errors import InputError
from softid.log import Log
from softid.readers import load

DEGREE = np.pi / 180
ROLES = {
    "two-segment-arm": ("pressure", ("angle",)),
    "three-chamber-arm": ("pressure", ("angle",)),
    "gripper-finger": ("pressure", ("angle",)),
    "pneunet-finger-bendsensor": ("pressure", ("angle",)),
    "fabric-arm": ("pressure", ("angle",)),
    "printed-cylinder": ("pressure", ("position",)),
    "linear-drive-friction": ("force", ("position",)),
}
LOGS = {
    "two-segment-arm": (
        "Jan10-1_baseline Jan10-4_R_1 Jan10-4_R_2 Jan5_1 Jan5_2 apr4_1 apr4_2 apr5_1 feb21"
    ),
    "three-chamber-arm": (
        "0706_pressure_only_square_1 0706_pressure_only_square_3 0706_pressure_only_square_4 "
        "0721_ramp 0730_step_1 0730_step_2 0730_step_3 0730_step_4"
    ),
    "gripper-finger": " ".join(f"calibration_flex_{20 * k}" for k in range(1, 11)),
    "pneunet-finger-bendsensor": (
        "New_Step_dataset_0_60_11 Ramp_dataset_10_3 Sin_dataset_2 Step_dataset2"
    ),
    "fabric-arm": "oct25_axial",
    "printed-cylinder": "KDN_1bar KDN_3bar O-ring257_3bar",
    "linear-drive-friction": "DATA_EMPS",
}
TIDIED = [(folder, stem) for folder, stems in LOGS.items() for stem in stems.split()]
PNEUNET_FLAGS = {"pressure": "pressure:kPa", "angle": "angle:deg"}
HEADERLESS_SIDECAR = """
[channels]
time = {column = 1, unit = "s"}
pressure_command = {column = 2, unit = "psi"}
pressure = {column = 5, unit = "psi"}
p2 = {column = 6, unit = "psi"}
p3 = {column = 7, unit = "psi"}

[roles]
input = "pressure_command"
output = "pressure"
"""


def tidied(measured: Path, folder: str, stem: str) -> np.ndarray:
    return np.genfromtxt(measured / folder / f"{stem}.csv", delimiter=",", names=True)


@pytest.mark.parametrize(("folder", "stem"), TIDIED)
def test_tidied_logs_load_without_flags(measured: Path, folder: str, stem: str) -> None:
    """Exact names beat look-alikes; every column is kept and no issue but missing motion arises."""
    log = load(measured / folder / f"{stem}.csv")
    only_pressure = stem.startswith("0706")
    roles = ("pressure_command", ("pressure",)) if only_pressure else ROLES[folder]
    assert (log.name, log.input, log.outputs) == (stem, *roles)
    table = tidied(measured, folder, stem)
    np.testing.assert_array_equal(log.time_s, table["time_s"])
    known = {"pressure_kpa": "pressure", "pressure_cmd_kpa": "pressure_command"}
    known |= {"angle_deg": "angle", "position_mm": "position", "force_n": "force"}
    for column in (name for name in table.dtype.names if name != "time_s"):
        channel = log.channels[known.get(column, column)]
        assert channel.column == column
        np.testing.assert_allclose(channel.displayed, table[column], rtol=1e-12, atol=1e-12)
    assert len(log.channels) == len(table.dtype.names) - 1
    assert [i.code for i in log.issues] == (["missing-output"] if folder == "fabric-arm" else [])


def test_all_tidied_logs_are_in_the_list(measured: Path) -> None:
    there = {(p.parent.name, p.stem) for p in measured.glob("*/*.csv") if p.parent.name != "raw"}
    assert there == set(TIDIED)


def test_a_raw_channel_keeps_the_unit_in_its_name(measured: Path) -> None:
    log = load(measured / "two-segment-arm" / "Jan5_1.csv")
    units = {name: log.channels[name].unit for name in ("s1_p1_kpa", "angle2_chord_deg", "enc1_v")}
    assert units == {"s1_p1_kpa": "kPa", "angle2_chord_deg": "deg", "enc1_v": "1"}


@pytest.mark.parametrize("stem", ["New_Step_dataset_0_60_11", "Sin_dataset_2"])
def test_raw_pneunet_equals_its_twin(measured: Path, stem: str) -> None:
    """Semicolons and bare-CR line ends; values equal, times to their rounding (1e-3 of 1e3 s)."""
    log = load(measured / "raw" / f"pneunet_{stem}.csv", channels=PNEUNET_FLAGS)
    twin = tidied(measured, "pneunet-finger-bendsensor", stem)
    np.testing.assert_allclose(log.time_s, twin["time_s"], atol=5.1e-4, rtol=0)
    np.testing.assert_array_equal(log.pressure_kpa, twin["pressure_kpa"])
    np.testing.assert_allclose(
        log.channels["angle"].values, twin["angle_deg"] * DEGREE, rtol=1e-13, atol=1e-15
    )
    np.testing.assert_array_equal(log.channels["set_point"].values, twin["angle_setpoint_deg"])
    np.testing.assert_array_equal(log.channels["motor_speed"].values, twin["pump_pwm"])


def test_raw_pneunet_without_flags_asks_for_the_unit(measured: Path) -> None:
    with pytest.raises(InputError, match="pressure has no unit") as caught:
        load(measured / "raw" / "pneunet_Sin_dataset_2.csv")
    assert "--channel pressure=pressure:kPa" in str(caught.value)


def test_raw_gripper_equals_its_twin(measured: Path) -> None:
    """An index column; pressures are ADC counts of 0.84247 kPa, positions pixels.

    The scale is that of the tidied file, whose zero cannot be stated: differences are compared.
    """
    log = load(
        measured / "raw" / "gripper_calibration_flex_100.csv",
        channels={"pressure": "left_pressure:0.84247*kPa"},
        input="left_pwm",
        outputs=["pressure", "left_flex"],
    )
    twin = tidied(measured, "gripper-finger", "calibration_flex_100")
    np.testing.assert_allclose(log.time_s, twin["time_s"], atol=5e-6)
    np.testing.assert_array_equal(log.channels["left_pwm"].values, twin["pump_pwm"])
    np.testing.assert_array_equal(log.channels["left_flex"].values, twin["flex_adc"])
    np.testing.assert_array_equal(log.channels["right_flex"].values, twin["flex2_adc"])
    np.testing.assert_allclose(
        log.pressure_kpa - log.pressure_kpa[0],
        twin["pressure_kpa"] - twin["pressure_kpa"][0],
        atol=2e-3,
    )


def test_raw_gripper_has_two_columns_that_look_like_pressure(measured: Path) -> None:
    path = measured / "raw" / "gripper_calibration_flex_100.csv"
    with pytest.raises(InputError, match="left_pressure, right_pressure") as caught:
        load(path)
    assert "--channel pressure=left_pressure" in str(caught.value)
    log = load(path, input="left_pwm", outputs=["left_flex"])
    assert {"left_pressure", "right_pressure", "tip_pos_x"} <= set(log.channels)


@pytest.mark.parametrize(
    ("raw", "folder", "stem", "atol"),
    [
        # tidied pressures have 6 digits (two-segment) or 3 decimals (three-chamber), in kPa
        ("two-segment_Jan5_1", "two-segment-arm", "Jan5_1", 1e-4),
        ("three-chamber_0730_step_2", "three-chamber-arm", "0730_step_2", 1e-3),
    ],
)
def test_raw_headerless_arms_equal_their_twins(
    measured: Path, tmp_path: Path, raw: str, folder: str, stem: str, atol: float
) -> None:
    """Gzip, no names, ``,`` or ``|`` with a trailing bar: columns by number from a sidecar."""
    sidecar = tmp_path / "arm.toml"
    sidecar.write_text(HEADERLESS_SIDECAR)
    log = load(measured / "raw" / f"{raw}.txt.gz", sidecar=sidecar)
    twin = tidied(measured, folder, stem)
    others = ("p2_kpa", "p3_kpa") if "three" in raw else ("s1_p2_kpa", "s1_p3_kpa")
    assert (log.name, log.input, log.outputs) == (raw, "pressure_command", ("pressure",))
    np.testing.assert_allclose(log.time_s - log.time_s[0], twin["time_s"], atol=5.1e-5)
    np.testing.assert_allclose(log.pressure_command_kpa, twin["pressure_cmd_kpa"], atol=atol)
    np.testing.assert_allclose(log.pressure_kpa, twin["pressure_kpa"], atol=atol)
    for name, column in zip(("p2", "p3"), others, strict=True):
        raw_psi = log.channels[name]
        assert raw_psi.unit == "psi"
        np.testing.assert_allclose(raw_psi.values * 6.894757, twin[column], atol=atol)


def test_raw_headerless_without_a_word_asks_for_the_time(measured: Path) -> None:
    with pytest.raises(InputError, match="no time column") as caught:
        load(measured / "raw" / "two-segment_Jan5_1.txt.gz")
    assert "--channel time=COLUMN:s" in str(caught.value)


def emps(measured: Path) -> Log:
    return load(
        measured / "raw" / "linear-drive_DATA_EMPS.mat",
        channels={"position": "qm:m", "position_ref": "qg:m", "force": "vir:35.15065188*N"},
    )


def test_raw_mat_equals_its_twin(measured: Path) -> None:
    """The force is gtau times vir; tidied positions have 6 digits in mm, forces 6 digits in N."""
    log = emps(measured)
    twin = tidied(measured, "linear-drive-friction", "DATA_EMPS")
    assert (log.input, log.outputs) == ("force", ("position",))
    assert float(log.metadata["gtau"]) == pytest.approx(35.15065188, abs=1e-8)
    np.testing.assert_allclose(log.time_s, twin["time_s"], atol=5e-5)
    np.testing.assert_allclose(log.channels["position"].values, twin["position_mm"], atol=5.1e-4)
    np.testing.assert_allclose(log.channels["force"].values, twin["force_n"], atol=5.1e-4)
    np.testing.assert_allclose(
        log.channels["position_ref"].values * 1000, twin["position_ref_mm"], atol=5.1e-4
    )


def test_a_wrong_scale_would_be_seen(measured: Path) -> None:
    """The comparison above can fail: a force off by 1e-4 of itself is out of its tolerance."""
    log = emps(measured)
    twin = tidied(measured, "linear-drive-friction", "DATA_EMPS")
    assert np.max(np.abs(log.channels["force"].values * 1.0001 - twin["force_n"])) > 5.1e-4
