"""The time axis, against dates and epochs worked out by hand."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from softid.errors import InputError
from softid.log import Log
from softid.readers import load
from softid.readers.times import PLAUSIBLE_PERIOD_S

WriteFile = Callable[..., Path]


def timed(write_log: WriteFile, header: str, cells: list[str], **options: object) -> Log:
    rows = "\n".join(f"{cell};{k % 90};{k % 90}" for k, cell in enumerate(cells))
    path = write_log(f"{header};pressure_kpa;angle_deg\n{rows}\n")
    return load(path, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("header", "cells"),
    [
        ("time", ["0", "0.02", "0.04"]),
        ("t_ms", ["0", "20", "40"]),
        ("time [us]", ["0", "20000", "40000"]),
        ("t [µs]", ["0", "20000", "40000"]),
        ("min", ["0", "20", "40"]),
    ],
)
def test_numbers_in_their_unit(write_log: WriteFile, header: str, cells: list[str]) -> None:
    """A column called ``min`` is a minimum and no time: it has to be named."""
    if header == "min":
        with pytest.raises(InputError, match="no time column"):
            timed(write_log, header, cells)
        return
    log = timed(write_log, header, cells)
    np.testing.assert_allclose(log.time_s, [0.0, 0.02, 0.04], rtol=1e-15)


@pytest.mark.parametrize(
    ("step", "unit"), [(PLAUSIBLE_PERIOD_S[0] / 2, "h"), (PLAUSIBLE_PERIOD_S[1] * 2, "ms")]
)
def test_an_implausible_time_without_unit_is_asked_for(
    write_log: WriteFile, step: float, unit: str
) -> None:
    """The unit proposed makes the step plausible; 50 ns, that of 50 ppm of a ms, nobody records."""
    cells = [repr(k * step) for k in range(4)]
    with pytest.raises(InputError, match="the time has no unit") as caught:
        timed(write_log, "time", cells)
    assert f"--channel time=time:{unit}" in str(caught.value)
    assert timed(write_log, "time", cells, time_unit="s").period_s == pytest.approx(step)
    if unit == "h":
        with pytest.raises(InputError, match="no recorder") as caught:
            timed(write_log, "time", cells, channels={"time": "time:ms"})
        assert "--channel time=time:h" in str(caught.value)
        return
    flagged = timed(write_log, "time", cells, channels={"time": "time:ms"})
    assert flagged.period_s == pytest.approx(step * 1e-3)
    ticks = timed(write_log, "time", cells, channels={"time": "time:2.5*ms"})
    assert ticks.period_s == pytest.approx(step * 2.5e-3)


@pytest.mark.parametrize(
    ("header", "step", "samples", "doubted"),
    [
        ("time_s", 5.0, 2000, True),  # 5 ms taken for 5 s: a log of 2.8 hours
        ("time_s", 1.0, 20000, True),  # 1 kHz taken for 1 Hz: 5.6 hours
        ("time_s", 1.0, 3600, False),  # an hour of creep, once a second
        ("time_s", 2.0, 1000, False),
        ("time", 1.0, 3600, False),
        ("t_ms", 0.02, 100, True),  # seconds taken for ms: 50 kHz
        ("t_ms", 20.0, 100, False),
    ],
)
def test_a_stated_unit_is_questioned(
    write_log: WriteFile, header: str, step: float, samples: int, doubted: bool
) -> None:
    """Slow logs exist, so it is a warning; who states the unit by flag is not asked again."""
    cells = [repr(k * step) for k in range(samples)]
    issues = timed(write_log, header, cells).issues
    assert [issue.code for issue in issues] == ["time-unit-doubtful"] * doubted
    if doubted:
        better = "ms" if header == "time_s" else "s"
        assert f"--channel time={header}:{better}" in str(issues[0].remedy)
    unit = header.rpartition("_")[2] if "_" in header else "s"
    assert not timed(write_log, header, cells, channels={"time": f"{header}:{unit}"}).issues


@pytest.mark.parametrize(
    ("cells", "seconds"),
    [
        (
            ["2024-02-28T23:59:59.5", "2024-02-29T00:00:00", "2024-03-01 00:00:00"],
            [0, 0.5, 86400.5],
        ),
        (["2024-01-01T10:00:00Z", "2024-01-01T11:00:01+01:00"], [0, 1]),
        (["2024-01-01 10:00:00,25", "2024-01-01 10:00:01,5"], [0, 1.25]),
        (["10:00:00.5", "10:00:01", "11:00:00.5"], [0, 0.5, 3600]),
        (["9:59:59", "10:00:00"], [0, 1]),
    ],
)
def test_timestamps(write_log: WriteFile, cells: list[str], seconds: list[float]) -> None:
    """2024 is a leap year; an offset of one hour is one hour."""
    log = timed(write_log, "time", cells)
    np.testing.assert_allclose(log.time_s, seconds, rtol=0, atol=1e-9)
    assert log.metadata["start"] == cells[0]


@pytest.mark.parametrize("odd", ["2024-01-01T00:00:02Z", "2 o'clock", "2.0", "2024-13-01T00:00:00"])
def test_times_of_another_kind_are_named(write_log: WriteFile, odd: str) -> None:
    cells = ["2024-01-01T00:00:00", "2024-01-01T00:00:01", odd]
    with pytest.raises(InputError, match="not a time like 2024-01-01T00:00:00") as caught:
        timed(write_log, "time", cells)
    assert "row 4" in str(caught.value)


def test_an_epoch_keeps_its_precision(write_log: WriteFile) -> None:
    """1.7e9 s has a resolution of 2.4e-7 s in double precision; the log begins at zero."""
    log = timed(write_log, "time", ["1700000000.25", "1700000000.26", "1700000000.27"])
    np.testing.assert_allclose(log.time_s, [0.0, 0.01, 0.02], atol=3e-7)
    assert log.metadata["start_epoch_s"] == "1700000000.25"
    with pytest.raises(InputError, match="more than 1e\\+11 s"):
        timed(write_log, "time", ["1700000000000", "1700000000010"])
    log = timed(write_log, "time", ["1700000000000", "1700000000010"], time_unit="ms")
    assert log.time_s.tolist() == [0.0, 0.01]


@pytest.mark.parametrize(
    ("header", "cells"),
    [
        ("time_h", [f"{k * 0.02 / 3600:.12f}" for k in range(5)]),
        ("t [min]", [f"{k * 0.02 / 60:.12f}" for k in range(5)]),
        ("time", [f"20261121T120000.{20 * k:03d}" for k in range(5)]),
    ],
)
def test_hours_minutes_and_basic_iso_times(
    write_log: WriteFile, header: str, cells: list[str]
) -> None:
    """20 ms in three notations, to the rounding of the cells: 3.6 ns of the hours."""
    np.testing.assert_allclose(
        timed(write_log, header, cells).time_s, 0.02 * np.arange(5), atol=1e-8
    )


def test_nanoseconds_since_1970_are_proposed_and_read(write_log: WriteFile) -> None:
    """What the remedy says is right: 20 ms, to the 256 ns that a float leaves of 1.79e18."""
    cells = [str(1790000000000000000 + 20_000_000 * k) for k in range(5)]
    with pytest.raises(InputError, match="--channel time=timestamp:ns"):
        timed(write_log, "timestamp", cells)
    log = timed(write_log, "timestamp", cells, channels={"time": "timestamp:ns"})
    np.testing.assert_allclose(log.time_s, 0.02 * np.arange(5), atol=3e-7)


def test_midnight_in_times_of_day_is_said(write_log: WriteFile) -> None:
    """The cells as in the file, not seconds since the first; the second one is in row 3."""
    with pytest.raises(InputError, match=r"the day changes, after 23:59:59\.990") as caught:
        timed(write_log, "time", ["23:59:59.990", "00:00:00.010", "00:00:00.030"])
    assert caught.value.value == "00:00:00.010"
    assert "row 3" in str(caught.value)


@pytest.mark.parametrize("header", ["time", "Datum"])
@pytest.mark.parametrize(
    "cell", ["21.11.2026 12:00:0{}", "11/21/2026 12:00:0{}", "21-11-26 12:00:0{}", "11:59:0{} PM"]
)
def test_dates_with_two_readings_ask_for_iso(write_log: WriteFile, header: str, cell: str) -> None:
    """Day or month first is nobody's to guess, whatever the column is called."""
    with pytest.raises(InputError, match=r"write ISO 8601 \(2026-11-21T12:00:00\)") as caught:
        timed(write_log, header, [cell.format(k) for k in range(5)])
    assert caught.value.value == cell.format(0)
