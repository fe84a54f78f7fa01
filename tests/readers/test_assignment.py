"""Which column becomes which channel and which role: flags beat the sidecar, it beats names."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from softid.errors import InputError, UsageError
from softid.readers import load

WriteFile = Callable[..., Path]


def table(header: str, rows: int = 4) -> str:
    """Rows of small rising numbers: 0.0, 0.1, … in the first column, +1 per column."""
    width = header.count(",") + 1
    lines = [",".join(str(round(0.1 * k + c, 3)) for c in range(width)) for k in range(rows)]
    return "\n".join([header, *lines])


@pytest.mark.parametrize(
    "header",
    [
        "time_s,pressure_1,pressure_2,angle_deg",
        "time_s,P1_kPa,P2_kPa,angle_deg",
        "time_s,pressure_kpa,pressure_bar,angle_deg",
        "time_s,P_kPa,pressure [bar],angle_deg",
        "time_s,pressure_meas_bar,pressure_kpa,angle_deg",
    ],
)
def test_two_columns_that_look_like_pressure_are_listed(write_log: WriteFile, header: str) -> None:
    _, first, second, _ = header.split(",")
    with pytest.raises(InputError) as e:
        load(write_log(table(header)))
    assert e.value.what == f"2 columns look like pressure: {first}, {second}"
    assert re.search(f"--channel '?pressure={first}:", str(e.value))


def test_plain_names_are_settled_by_the_user_alone(write_log: WriteFile) -> None:
    """`P_kPa` beside `pressure [bar]`: a flag or a sidecar chooses; a look-alike is no rival."""
    header = "time_s,P_kPa,pressure [bar],angle_deg"
    path = write_log(table(header))
    assert load(path, channels={"pressure": "P_kPa:kPa"}).channels["pressure"].column == "P_kPa"
    write_log('[channels]\npressure = {column = "pressure [bar]", unit = "bar"}\n', "log.toml")
    assert load(path).channels["pressure"].column == "pressure [bar]"
    unsaid = write_log(table("time_s,pressure_kpa,P1_kPa,angle_deg"), "other.csv")
    assert load(unsaid).channels["pressure"].column == "pressure_kpa"


def test_a_clock_beside_the_seconds_is_no_rival(write_log: WriteFile) -> None:
    """Loggers write both; softid's own word wins, and the values differ by the start only."""
    path = write_log(table("t_s,time_s,pressure_kpa,angle_deg"))
    assert load(path).time_s.tolist() == [1.0, 1.1, 1.2, 1.3]


def test_roles_of_a_file_are_the_logs_fault(write_log: WriteFile) -> None:
    """A log without the model's output is bad input (3), and no flag is named that nobody typed."""
    path = write_log(table("time_s,pressure_kpa,angle_deg"))
    with pytest.raises(InputError, match=r"torque, which the model params") as caught:
        load(path, input="pressure", outputs=["torque"], roles_of="the model params.json")
    assert "--output" not in str(caught.value)
    write_log('[roles]\ninput = "valve"\n', "log.toml")
    with pytest.raises(InputError, match=r"valve, which the sidecar .*log\.toml asks for"):
        load(path)


@pytest.mark.parametrize("outputs", [None, ()])
def test_a_log_in_which_nothing_drives_lists_what_it_has(
    write_log: WriteFile, outputs: tuple[str, ...] | None
) -> None:
    """No user and no sidecar asks for a pressure here, so none is said to."""
    path = write_log(table("time_s,angle_deg"))
    with pytest.raises(InputError, match="no input channel is recognised among angle;") as caught:
        load(path, outputs=outputs)
    assert "None" not in str(caught.value)


def test_an_input_is_no_output(write_log: WriteFile) -> None:
    """With nothing else that drives, the pressure cannot be explained, and that is said."""
    path = write_log(table("time_s,pressure_kpa,angle_deg"))
    with pytest.raises(UsageError, match="pressure is to be explained, and no other channel"):
        load(path, outputs=["pressure"])
    with pytest.raises(UsageError, match="pressure is both input and output"):
        load(path, input="pressure", outputs=["pressure"])


def test_columns_of_one_name_are_told_by_number(write_log: WriteFile) -> None:
    path = write_log(table("time_s,pressure_kpa,pressure_kpa,angle_deg"))
    with pytest.raises(InputError, match=r"pressure_kpa \(column 2\), pressure_kpa \(column 3\)"):
        load(path)
    log = load(path, channels={"pressure": "3:kPa"})
    assert log.pressure_kpa[0] == 2.0
    assert log.channels["pressure_kpa"].values[0] == 1.0
    with pytest.raises(UsageError, match="columns 2 and 3 could be pressure_kpa"):
        load(path, channels={"pressure": "pressure_kpa:kPa"})


def test_an_unsettled_channel_is_no_error_when_nobody_needs_it(write_log: WriteFile) -> None:
    path = write_log(table("time_s,pressure_1,pressure_2,angle_deg"))
    log = load(path, input="pressure_1", outputs=["angle"])
    assert set(log.channels) == {"angle", "pressure_1", "pressure_2"}
    assert [i.code for i in log.issues] == ["channel-not-settled"]
    with pytest.raises(InputError, match="look like pressure"):
        load(path, input="pressure")


@pytest.mark.parametrize("name", ["pressure", "angle"])
def test_a_missing_unit_is_asked_for(write_log: WriteFile, name: str) -> None:
    header = "time_s,pressure_kpa,angle_deg".replace(
        f"{name}_{'kpa' if name[0] == 'p' else 'deg'}", name
    )
    with pytest.raises(InputError, match=f"the {name} has no unit") as caught:
        load(write_log(table(header)))
    assert f"--channel {name}={name}:" in str(caught.value)


def test_volts_are_asked_for_what_they_mean(write_log: WriteFile) -> None:
    """To call them kPa, as a pressure without a unit is, would give a wrong scale."""
    path = write_log(table("time_s,pressure_V,angle_deg"))
    with pytest.raises(InputError, match="V is no unit of pressure; say how much 1 V is") as caught:
        load(path)
    assert "--channel 'pressure=pressure_V:100*kPa'" in str(caught.value)
    scaled = load(path, channels={"pressure": "pressure_V:100*kPa"}).channels["pressure"]
    volts = load(path, channels={"pressure": "pressure_V:kPa"}).channels["pressure"]
    assert scaled.values.tolist() == (100.0 * volts.values).tolist()


@pytest.mark.parametrize(
    ("header", "signal", "column"),
    [
        ("pressure_mA", "mA", "pressure_mA"),
        ("pressure [mA]", "mA", "pressure [mA]"),
        ("pressure (V)", "V", "pressure (V)"),
        ("pressure/V", "V", "pressure/V"),
        ("pressure [counts]", "count", "pressure [counts]"),
    ],
)
def test_a_signal_is_asked_for_its_scale_however_it_is_written(
    write_log: WriteFile, header: str, signal: str, column: str
) -> None:
    path = write_log(table(f"time_s,{header},angle_deg"))
    asked = f"{signal} is no unit of pressure.*; say how much 1 {signal} is"
    for channels in ({}, {"pressure": column}, {"pressure": f"{column}:{signal}"}):
        with pytest.raises((InputError, UsageError), match=asked) as caught:
            load(path, channels=channels)
        assert f"pressure={column}:100*kPa" in str(caught.value)


def test_a_signal_in_the_row_of_units_is_asked_for_its_scale(write_log: WriteFile) -> None:
    header = "time,pressure,angle"
    content = table(header).replace(header, f"{header}\ns,mA,deg")
    with pytest.raises(InputError, match="mA is no unit of pressure; say how much 1 mA is"):
        load(write_log(content))


def test_what_stands_for_a_unit_and_is_none_is_named(write_log: WriteFile) -> None:
    path = write_log(table("time_s,pressure (furlong),angle_deg"))
    with pytest.raises(InputError, match="furlong is no unit of pressure; state it") as caught:
        load(path)
    assert "column pressure (furlong)" in str(caught.value)
    assert "--channel 'pressure=pressure (furlong):kPa'" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("P left:bar", 100.0),
        ("2:bar", 100.0),
        ("p LEFT:bar", 100.0),
        ("P left:25*kPa", 25.0),
        ("a:b:kPa", 2.0),
    ],
)
def test_flags_name_columns_by_name_or_number(
    write_log: WriteFile, text: str, expected: float
) -> None:
    """The second column holds 1.0 first, the third 2.0; a name may contain a colon."""
    path = write_log(table("time_s,P left,a:b,angle_deg"))
    assert load(path, channels={"pressure": text}).pressure_kpa[0] == expected


def test_a_name_may_be_given_without_its_unit(write_log: WriteFile) -> None:
    log = load(write_log(table("time_s,P1 [bar],P2 [bar],angle_deg")), channels={"pressure": "P2"})
    assert log.pressure_kpa[0] == 200.0


@pytest.mark.parametrize("column", ["foo", "0", "5", "-1", ""])
def test_unknown_columns_list_the_choices(write_log: WriteFile, column: str) -> None:
    with pytest.raises(UsageError, match="no such column") as caught:
        load(write_log(table("time_s,a,b,c")), channels={"pressure": f"{column}:kPa"})
    assert "time_s, a, b, c" in str(caught.value)
    assert "--channel pressure" in str(caught.value)


@pytest.mark.parametrize(("unit", "what"), [("deg", "unit of angle"), ("foo", "not a unit")])
def test_wrong_units_are_refused(write_log: WriteFile, unit: str, what: str) -> None:
    with pytest.raises(UsageError, match=what):
        load(write_log(table("time_s,a,angle_deg")), channels={"pressure": f"a:{unit}"})
    with pytest.raises(InputError, match=what):
        load(write_log(table(f"time_s,pressure [{unit}],angle_deg")))


def test_missing_channels_say_which_option_helps(write_log: WriteFile) -> None:
    with pytest.raises(InputError, match="no time column") as caught:
        load(write_log(table("a,b,c")))
    assert "--channel time=" in str(caught.value)
    with pytest.raises(InputError, match="no input channel") as caught:
        load(write_log(table("time_s,a,angle_deg")))
    assert "--input" in str(caught.value)
    with pytest.raises(InputError, match="no output channel") as caught:
        load(write_log(table("time_s,pressure_kpa,a")))
    assert "--output" in str(caught.value)


@pytest.mark.parametrize(
    ("header", "options", "roles"),
    [
        ("time_s,pressure_cmd_kpa,pressure_kpa,angle_deg", {}, ("pressure", ("angle",))),
        ("time_s,pressure_cmd_kpa,angle_deg", {}, ("pressure_command", ("angle",))),
        ("time_s,pressure_cmd_kpa,pressure_kpa", {}, ("pressure_command", ("pressure",))),
        ("time_s,force_n,position_mm", {}, ("force", ("position",))),
        ("time_s,pressure_kpa,force_n,position_mm", {}, ("pressure", ("position",))),
        (
            "time_s,pressure_cmd_kpa,pressure_kpa,angle_deg",
            {"outputs": ["pressure"]},
            ("pressure_command", ("pressure",)),
        ),
        (
            "time_s,pressure_cmd_kpa,pressure_kpa,angle_deg",
            {"input": "pressure_command"},
            ("pressure_command", ("angle",)),
        ),
        ("time_s,pressure_kpa,torque_nmm,angle_deg", {"outputs": ["torque", "angle"]},
         ("pressure", ("torque", "angle"))),
        ("time_s,pressure_kpa,angle_deg", {"input": "angle_deg", "outputs": ["pressure_kpa"]},
         ("angle", ("pressure",))),
        ("time_s,pump,angle_deg", {"input": "pump"}, ("pump", ("angle",))),
        (
            "t,command (V),flex [V],angle", {"input": "command", "outputs": ["flex"]},
            ("command (V)", ("flex [V]",)),
        ),
    ],
)  # fmt: skip
def test_roles(
    write_log: WriteFile, header: str, options: dict[str, object], roles: tuple[str, object]
) -> None:
    """The defaults that the reader's documentation states, and the arguments that choose."""
    log = load(write_log(table(header)), **options)  # type: ignore[arg-type]
    assert (log.input, log.outputs) == roles


@pytest.mark.parametrize("options", [{"input": "foo"}, {"outputs": ["foo"]}])
def test_unknown_roles_list_the_choices(write_log: WriteFile, options: dict[str, object]) -> None:
    with pytest.raises(UsageError, match="no channel foo") as caught:
        load(write_log(table("time_s,pressure_kpa,angle_deg,x")), **options)  # type: ignore[arg-type]
    assert "pressure, angle, x" in str(caught.value)


SIDECAR = """
[channels]
pressure = {column = "a", unit = "bar"}
angle = {column = 3, unit = "deg"}

[roles]
input = "pressure"
output = ["angle"]

[metadata]
rig = "finger 3"
supply_bar = 6
"""


@pytest.mark.parametrize("name", ["log.toml", "log.csv.toml"])
def test_a_sidecar_beside_the_log_is_found(write_log: WriteFile, name: str) -> None:
    write_log(SIDECAR, name)
    log = load(write_log(table("time_s,a,b")))
    assert (log.pressure_kpa[0], log.outputs) == (100.0, ("angle",))
    assert dict(log.metadata) == {"rig": "finger 3", "supply_bar": "6"}


def test_flags_beat_the_sidecar_and_the_sidecar_beats_names(write_log: WriteFile) -> None:
    path = write_log(table("time_s,a,angle_rad,pressure_kpa"))
    sidecar = write_log(SIDECAR, "other.toml")
    log = load(path, sidecar=sidecar)
    assert log.pressure_kpa[0] == 100.0  # a in bar, not the exact name pressure_kpa
    np.testing.assert_allclose(log.channels["angle"].values[0], np.deg2rad(2.0))
    assert load(path, sidecar=sidecar, channels={"pressure": "4:kPa"}).pressure_kpa[0] == 3.0


@pytest.mark.parametrize(
    ("unit", "told"), [("bar", True), ("kPa", False), ("kilopascal", False), ("-kPa", False)]
)
def test_a_unit_that_contradicts_the_header_is_told(
    write_log: WriteFile, unit: str, told: bool
) -> None:
    """The user's word holds, a hundred times the header's, and is told; the same unit is not."""
    path = write_log(table("time_s,pressure_kPa,angle_deg"))
    log = load(path, channels={"pressure": f"pressure_kPa:{unit}"})
    found = [issue for issue in log.issues if issue.code == "unit-contradiction"]
    assert bool(found) is told
    if told:
        assert "taken in bar, as given, while the file says kPa" in found[0].message
        assert log.channels["pressure"].values[0] == pytest.approx(100.0)


def test_a_unit_of_something_else_reads_well(write_log: WriteFile) -> None:
    """One sentence for all quantities, whatever sound they begin with."""
    path = write_log(table("time_s,pressure_kpa,angle_deg"))
    with pytest.raises(UsageError, match="bar is a unit of pressure, not of angle"):
        load(path, channels={"angle": "angle_deg:bar"})


def test_a_raw_channel_never_takes_a_known_name(write_log: WriteFile) -> None:
    """Else its counts would be read as kPa."""
    path = write_log(table("time_s,pressure,P [kPa],angle_deg"))
    log = load(path, channels={"pressure": "P:kPa"})
    assert log.channels["pressure_col2"].unit == "1"
    assert log.channels["pressure_col2"].column == "pressure"
    unsettled = load(write_log(table("time_s,pressure,pump,angle_deg")), input="pump")
    assert set(unsettled.channels) == {"pressure_col2", "pump", "angle"}


def test_a_column_of_timestamps_is_the_time_whatever_its_name(write_log: WriteFile) -> None:
    rows = "2024-01-01T00:00:00,1,2\n2024-01-01T00:00:00.5,2,3\n"
    log = load(write_log("stamp_utc,pressure_kpa,angle_deg\n" + rows))
    assert log.time_s.tolist() == [0.0, 0.5]


def test_a_minus_at_the_unit_turns_the_sign(write_log: WriteFile, tmp_path: Path) -> None:
    """-deg is −1 times deg, by flag and by sidecar: the same log with every angle negated."""
    path = write_log(table("time_s,pressure_bar,angle_deg"))
    plain = load(path).channels["angle"]
    turned = load(path, channels={"angle": "angle_deg:-deg"}).channels["angle"]
    np.testing.assert_array_equal(turned.values, -plain.values)
    assert turned.display_unit == "deg"
    beside = tmp_path / "turned.toml"
    beside.write_text('[channels]\nangle = {column = "angle_deg", unit = "-deg"}\n')
    said = load(path, sidecar=beside).channels["angle"]
    np.testing.assert_array_equal(said.values, -plain.values)


def test_a_mark_for_nothing_is_told_with_row_and_sign(write_log: WriteFile) -> None:
    """Two of 20 angles are -999: the first, in row 5 of the file, is named as it is written."""
    rows = [f"{0.1 * k:.1f},{k},{-999 if k in (3, 9) else k}" for k in range(20)]
    with pytest.raises(InputError, match=r"2 rows.*leave these cells empty") as caught:
        load(write_log("\n".join(["time_s,pressure_kpa,angle_deg", *rows])))
    assert caught.value.value == -999.0
    assert "column angle_deg, row 5" in str(caught.value)


@pytest.mark.parametrize("cell", ["1e308", "inf", "-inf"])
def test_a_number_that_is_no_measurement_is_told(write_log: WriteFile, cell: str) -> None:
    """It counts as missing, as it must for every sum, but with a warning that names its row."""
    rows = [f"{0.1 * k:.1f},{k},{cell if k == 4 else k}" for k in range(20)]
    log = load(write_log("\n".join(["time_s,pressure_kpa,angle_deg", *rows])))
    assert np.isnan(log.channels["angle"].values[4])
    (issue,) = (i for i in log.issues if i.code == "not-a-measurement")
    assert issue.severity == "warning"
    assert "column angle_deg, row 6: 1 number is infinite" in issue.message


def test_grad_is_asked_for(write_log: WriteFile) -> None:
    """The degree of a German header or the gon, which differ by a tenth: never a giga-radian."""
    with pytest.raises(InputError, match=r"angle=COLUMN:deg or .*angle=COLUMN:gon"):
        load(write_log("Zeit;Druck;Winkel\ns;bar;Grad\n0;0,1;0,2\n0,1;0,2;0,3\n"))


def test_the_level_of_a_step_is_no_mark_for_nothing(write_log: WriteFile) -> None:
    """0 and 80 bar in turn: one value lies far from the other, but the question is the unit."""
    rows = [f"{0.1 * k:.1f},{80 * (k // 10 % 2)},{k}" for k in range(40)]
    with pytest.raises(InputError, match="is that its unit"):
        load(write_log("\n".join(["time_s,pressure_bar,angle_deg", *rows])))
