"""`softid inspect`: what it prints, and what it gives to machines."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from desk import Desk, Outcome
from drawn_logs import staircase_log, with_fault
from jsonschema import Draft202012Validator

from softid.errors import Issue
from softid.log import Log
from softid.quality import inspect
from softid.records import dump_json
from softid.records.reading import load_schema
from softid_cli.inspect import render

Cli = Callable[..., Outcome]


def faulty_log() -> Log:
    """A staircase with one lost sample."""

    def fault(values):  # type: ignore[no-untyped-def]
        values[2000] = -999.0
        return values

    return with_fault(staircase_log(), "angle", fault)


def test_sections_in_order() -> None:
    """Channels, findings, excitation, abilities, wanted logs, as the design has them."""
    text = render(inspect(faulty_log()))
    headings = [
        "staircase: pressure → angle",
        "channel ",
        "Findings",
        "Excitation of pressure\n",
        "Excitation of pressure_command",
        "What this log can identify",
        "Logs that would help",
    ]
    places = [text.index(heading) for heading in headings]
    assert places == sorted(places)
    assert "warning: angle drops out at 1 place (1 × spike): 20.00 s: -999 deg" in text
    assert "  → leave these samples out of the fit" in text
    assert "4400 samples in 43.99 s, every 10 ms (100 Hz), no jitter; no gaps, no stalls" in (
        " ".join(text.split())
    )


def test_findings_are_folded_as_the_issues_of_a_fit() -> None:
    """One way to print an issue: the rest of its sentence stands below its first word."""
    found = inspect(faulty_log())
    told = render(replace(found, issues=(Issue("x", "warning", "word " * 30, None),)))
    first = told.index("warning: word")
    assert told[first:].splitlines()[1].startswith("  word")


def drawn_steps(period_s: float, hold_s: float) -> Log:
    """Steps between 0 and 60 kPa with a little noise, the last hold twice as long."""
    rng = np.random.default_rng(0)
    n = round(hold_s / period_s)
    pressure = np.repeat([0.0, 60.0, 0.0, 60.0, 60.0], n)
    pressure = pressure + 0.1 * rng.standard_normal(pressure.size)
    channels = {"pressure": pressure, "angle": 0.4 * pressure}
    return Log.from_arrays(np.arange(pressure.size) * period_s, channels, name="steps")


@pytest.mark.parametrize(
    ("period_s", "hold_s", "clock", "held"),
    [
        (20.0, 2000.0, "every 20 s (0.05 Hz)", "held 1980 to 3980 s, median 1980 s"),
        (1e-4, 0.1, "every 0.1 ms (10 kHz)", "held 0.0999 to 0.2 s, median 0.0999 s"),
    ],
)
def test_slow_and_quick_clocks(period_s: float, hold_s: float, clock: str, held: str) -> None:
    """Times and rates are written without powers of ten, and a hold says what it measures."""
    text = " ".join(render(inspect(drawn_steps(period_s, hold_s))).split())
    assert clock in text
    assert held in text
    assert "e+0" not in text


def test_gaps_and_stalls_are_told_apart() -> None:
    """Each kind has its own longest; a mean rate is told where it differs from the median one."""
    time_s = np.arange(1000) * 0.01
    time_s[300:] += 0.2
    time_s[700:] += 2.0
    log = Log.from_arrays(time_s, {"pressure": np.sin(time_s), "angle": np.sin(time_s)})
    text = " ".join(render(inspect(log)).split())
    assert "1 gap of 0.21 s; 1 stall of 2.01 s" in text
    assert "(100 Hz by the median, 81.95 Hz on average)" in text


def test_missing_samples_are_told_once() -> None:
    """What the reader counted and what the channel lacks is one finding."""
    log = with_fault(staircase_log(), "angle", lambda v: np.where(v > 35.0, np.nan, v))
    told = Issue("missing-output", "info", "angle: samples missing")
    codes = [i.code for i in inspect(replace(log, issues=(told,))).issues]
    assert codes.count("missing-samples") == 1
    assert "missing-output" not in codes
    assert "drop-outs" not in codes


def test_json_has_no_nan_and_one_shape() -> None:
    """Three samples, a channel of gaps and a whole staircase have the same fields."""
    steps = staircase_log()
    short = Log.from_arrays(np.arange(3) * 0.1, {"pressure": np.arange(3.0), "angle": np.ones(3)})
    gappy = with_fault(steps, "angle", lambda v: np.where(np.arange(v.size) % 2, v, np.nan))

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    documents = [
        json.loads(dump_json(inspect(log)), parse_constant=refuse) for log in (steps, short, gappy)
    ]
    assert len({tuple(sorted(d)) for d in documents}) == 1
    assert len({tuple(sorted(c)) for d in documents for c in d["channels"]}) == 1
    assert documents[0]["holds"][0]["after_change"] is False
    assert documents[1]["channels"][0]["noise_std"] is None


def test_json_is_valid_by_its_schema(softid: Cli, tmp_path: Path) -> None:
    """The schema is the published format, for a log with findings and for one of three samples."""
    log = faulty_log()
    rows = np.column_stack([log.time_s, *(c.values for c in log.channels.values())])
    header = ",".join(["time_s", *(f"{n}_{c.unit}" for n, c in log.channels.items())])
    np.savetxt(tmp_path / "long.csv", rows, delimiter=",", header=header, comments="")
    (tmp_path / "short.csv").write_text("time_s,pressure_kpa,angle_deg\n0,0,1\n0.1,5,1\n0.2,9,1\n")
    done = softid("inspect", tmp_path / "long.csv", tmp_path / "short.csv", "--json")
    assert done.code == 0, done.err
    document = json.loads(done.out)
    long, short = document["logs"]
    assert long["channels"][1]["dropouts"]
    assert not short["responses"]
    schema = load_schema(document["schema"])
    Draft202012Validator(schema).validate(document)
    assert set(schema["$defs"]["inspection"]["properties"]) == set(long)
    assert set(schema["$defs"]["channel"]["properties"]) == set(long["channels"][0])


@pytest.mark.parametrize("width", [80, 120])
def test_the_width(width: int) -> None:
    """No line is longer than the terminal, and no word is cut by an ellipsis."""
    text = render(inspect(faulty_log()), width=width)
    assert max(map(len, text.splitlines())) <= width
    assert "pressure_command" in text


def test_a_clean_log_says_so() -> None:
    """Without findings there is no empty heading."""
    assert "Findings: none" in render(inspect(staircase_log()))


def test_many_channels_are_folded() -> None:
    """Six raw channels are listed, the rest counted; JSON has them all."""
    log = staircase_log()
    extra = {f"adc{k}": log.pressure_kpa for k in range(20)}
    channels = {name: log.channels[name].values for name in ("pressure", "angle")} | extra
    text = render(inspect(Log.from_arrays(log.time_s, channels)))
    assert "adc5" in text
    assert "adc6" not in text
    assert "… 14 more" in text


LONG = {
    "pressure": "pressure_sensor_of_the_left_outer_chamber_filtered_kpa",
    "angle": "bending_angle_of_the_second_segment_by_motion_capture_deg",
    "adc": "raw_reading_of_the_third_flexible_sensor_before_calibration",
}
UNITS_OF_LONG = {"pressure": "kPa", "angle": "deg"}


def test_a_long_name_stays_on_one_line(softid: Cli, tmp_path: Path) -> None:
    """Every column can be copied from the screen into --channel; rows of the table stay rows."""
    rows = [f"{0.02 * k:.2f},{80 * (k > 20)},{0.5 * k:.1f},{k}" for k in range(60)]
    (tmp_path / "wide.csv").write_text("\n".join([",".join(["time_s", *LONG.values()]), *rows]))
    flags = [f"--channel={name}={LONG[name]}:{unit}" for name, unit in UNITS_OF_LONG.items()]
    told = softid("inspect", str(tmp_path / "wide.csv"), *flags)
    assert told.code == 0, told.err
    lines = told.out.splitlines()
    for column in LONG.values():
        assert sum(column in line for line in lines) == 1, column
    table = lines[lines.index("") + 1 :]
    assert [row.split()[1] for row in table[2:5]] == ["input", "output", "other"]
    assert all(len(row) <= 80 for row in table[:5])
    shortened = table[4].split()[0]
    assert f"  {shortened} is the column {LONG['adc']}" in lines


def test_short_names_need_no_list(softid: Cli, desk: Desk) -> None:
    """Where the table has room, nothing is told twice."""
    del desk
    assert "is the column" not in softid("inspect", "a.csv").out


def test_the_command_prints(softid: Cli, desk: Desk) -> None:
    """Each log has its own part; options reach the reader."""
    told = softid("inspect", "a.csv", "b.csv", "--input", "pressure", "--channel", "angle=2:deg")
    assert told.code == 0
    assert told.err == ""
    assert "a: pressure → angle" in told.out
    assert "b: pressure → angle" in told.out
    assert desk.asked["load"]["input"] == "pressure"
    assert desk.asked["load"]["channels"] == {"angle": "2:deg"}


def test_json(softid: Cli, desk: Desk) -> None:
    """One document with a schema name and a list, also for one log."""
    del desk
    document = json.loads(softid("inspect", "a.csv", "--json").out)
    assert document["schema"] == "softid.inspection/1"
    (found,) = document["logs"]
    assert found["log"] == "a"
    assert found["sampling"]["n"] == 50
    assert found["channels"][0]["role"] == "input"
    assert {a["name"] for a in found["abilities"]} >= {"static curve", "inertia"}


def test_it_needs_a_log(softid: Cli) -> None:
    """Bad usage is 2; a file that is not there is 3."""
    assert softid("inspect").code == 2
    assert softid("inspect", "nowhere.csv").code == 3


def test_a_measured_log(softid: Cli, measured: Path) -> None:
    """The stalls and lost digits of the bend sensor, read from the file itself."""
    told = softid("inspect", measured / "pneunet-finger-bendsensor" / "Sin_dataset_2.csv")
    words = " ".join(told.out.split())
    assert told.code == 0
    assert "37 stalls longer than 0.5 s" in words
    assert "drops out at 2 places (2 × lost digit): 43.57 s: 36.92 deg, 82.05 s: 9.36 deg" in words
