"""What is wrong in a flag is wrong usage; the same in a sidecar or a header is a wrong file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from softid.errors import InputError, UsageError
from softid.readers import load
from softid.readers.columns import meant_channel
from softid.units import CHANNEL_QUANTITY

WriteFile = Callable[..., Path]

HEADER = "time_s,pressure_cmd_kpa,pressure_kpa,angle_deg"
ROWS = "\n".join(f"{0.1 * k:.1f},{k},{k},{k}" for k in range(4))
LOG = f"{HEADER}\n{ROWS}\n"


@pytest.mark.parametrize(
    ("asked", "column", "unit", "said"),
    [
        ("angel", "angle_deg", "deg", "did you mean angle"),
        ("theta", "angle_deg", "deg", "did you mean angle"),
        ("tiem", "time_s", "s", "did you mean time"),
        ("pressure_comand", "pressure_cmd_kpa", "kPa", "did you mean pressure_command"),
        ("angle", "nosuch", "deg", "no such column"),
        ("angle", "99", "deg", "no such column"),
        ("angle", "3", "parsec", "parsec is a unit of length"),
        ("angle", "4", "0*deg", "one count of a column cannot be worth this"),
        ("angle", "4", "1e999*deg", "one count of a column cannot be worth this"),
        ("time", "1", "bar", "bar is a unit of pressure"),
    ],
)
def test_who_is_at_fault(
    write_log: WriteFile, asked: str, column: str, unit: str, said: str
) -> None:
    path = write_log(LOG)
    with pytest.raises(UsageError, match=said) as by_flag:
        load(path, channels={asked: f"{column}:{unit}"})
    assert f"--channel {asked}" in str(by_flag.value)
    write_log(f'[channels]\n{asked} = {{column = "{column}", unit = "{unit}"}}\n', "log.toml")
    with pytest.raises(InputError, match=said) as in_file:
        load(path)
    assert f"log.toml, [channels] {asked}" in str(in_file.value)


def test_names_that_are_no_slip() -> None:
    """Known names, names of other sensors that look like them, and names with a word or number."""
    for name in (
        *CHANNEL_QUANTITY,
        *("range", "resistance", "disturbance", "traction", "temp", "source", "torsion"),
        *("pressure_2", "angle2", "force_z", "position_ref", "pressure_supply", "adc", "flex"),
    ):
        assert meant_channel(name) is None, name


@pytest.mark.parametrize("name", [n for n in CHANNEL_QUANTITY if len(n) > 3])
def test_one_slip_of_any_kind_is_seen(name: str) -> None:
    """Two letters exchanged, one left out, one twice, one mistaken."""
    for k in range(1, len(name) - 1):
        exchanged = name[:k] + name[k + 1] + name[k] + name[k + 2 :]
        for slip in (exchanged, name[:k] + name[k + 1 :], name[:k] + name[k:], f"{name[:k]}q"):
            written = slip if slip[-1] != "q" else slip + name[k + 1 :]
            assert written == name or meant_channel(written) == name, written


def test_a_second_channel_of_a_kind_may_have_any_name(write_log: WriteFile) -> None:
    """Where the known name is given too, or a role asks for the other one, nobody mistyped it."""
    path = write_log(LOG)
    both = load(path, channels={"angle": "angle_deg:deg", "theta": "pressure_cmd_kpa"})
    assert both.outputs == ("angle",)
    own = load(path, channels={"theta": "angle_deg:deg"}, outputs=["theta"])
    assert own.outputs == ("theta",)


def test_a_pressure_that_is_explained_in_place_of_a_named_column_is_told(
    write_log: WriteFile,
) -> None:
    """A log of command and pressure alone is one of the pneumatics, and needs no remark."""
    path = write_log(LOG)
    log = load(path, channels={"flex": "angle_deg:V"})
    (told,) = [issue for issue in log.issues if issue.code == "pressure-explained"]
    assert (log.outputs, told.severity) == (("pressure",), "warning")
    assert "--output flex" in str(told.remedy)
    pneumatic = write_log("\n".join(r.rsplit(",", 1)[0] for r in LOG.splitlines()), "p.csv")
    for asked in (
        load(pneumatic, channels={"pressure": "3:kPa"}),
        load(path, channels={"flex": "angle_deg:V"}, outputs=["pressure"]),
        load(path, channels={"flex": "angle_deg:V"}, outputs=None),
    ):
        assert not [issue for issue in asked.issues if issue.code == "pressure-explained"]
