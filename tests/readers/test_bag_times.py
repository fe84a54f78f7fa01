"""One clock for all topics of a bag, and topics of two rates as two recorders."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import softid
from softid.readers import load
from softid.readers.bag import BagTable, read_bag

pytest.importorskip("rosbags", reason="rosbags is in the test extra")
from inspected import codes
from rosbag_files import KINDS, Message, Types, column, numbers, told, write_bag

SUFFIXES = sorted(KINDS)


def stamped(
    types: Types, topic: str, received: float, stamp: float | None, **start: int
) -> Message:
    fields = {"fluid_pressure": 1e4, "variance": 0.0, "header": types.header(stamp, **start)}
    return (topic, received, types.make("sensor_msgs/msg/FluidPressure", **fields))


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_stamps_of_the_recorder_s_clock_are_the_times(tmp_path: Path, suffix: str) -> None:
    """Received 20 and 400 ms late: the stamps 0 and 1 s count, and nothing is to be said."""
    types = Types(suffix)
    late = [stamped(types, "/p", 0.02, 0.0), stamped(types, "/p", 1.4, 1.0)]
    table = read_bag(write_bag(tmp_path / "run", suffix, late))
    assert column(table, "time") == [0.0, 1.0]
    assert table.head.issues == ()


def test_a_topic_without_header_is_timed_by_its_receipt(tmp_path: Path) -> None:
    types = Types(".db3")
    late = [stamped(types, "/p", 0.25, 0.0), stamped(types, "/p", 1.25, 1.0)]
    path = write_bag(tmp_path / "run", ".db3", [*late, *numbers(types, "/x", {0.5: 1.0})])
    table = read_bag(path)
    assert column(table, "time") == [0.0, 0.5, 1.0]
    np.testing.assert_equal(column(table, "/x"), [np.nan, 1.0, np.nan])
    assert "/x has no header" in told(table, "times-of-receipt")


@pytest.mark.parametrize(
    ("stamp", "start", "why"),
    [
        (None, {}, "1 of 2 stamps of /p are zero"),
        (1.0, {"start_ns": 5 * 10**9}, "the stamps of /p are 8.5e+08 s before their receipt"),
        (4.5, {}, "the stamps of /p are 1.75 s after their receipt"),
        (1.04, {}, "the stamps of /p are 0.02 s after their receipt"),
    ],
)
def test_of_two_clocks_the_recorder_s_is_taken(
    tmp_path: Path, stamp: float | None, start: dict[str, int], why: str
) -> None:
    """One topic of another clock, and all topics are timed by their receipt.

    The median of two differences is their mean: of 0 and 3.5 s, 1.75 s. No message is received
    before it is stamped, so of those 20 ms are too many.
    """
    types = Types(".mcap")
    messages = [stamped(types, "/p", 0.0, 0.0), stamped(types, "/p", 1.0, stamp, **start)]
    messages += [stamped(types, "/q", 0.5, 0.25)]
    table = read_bag(write_bag(tmp_path / "run", ".mcap", messages))
    assert column(table, "time") == [0.0, 0.5, 1.0]
    assert why in told(table, "times-of-receipt")


def test_two_messages_of_one_topic_and_time_are_two_rows(tmp_path: Path) -> None:
    """A sensor that stamps coarsely loses nothing; another topic shares the first of its rows."""
    types = Types(".mcap")
    twice = [("/a", 1.0, types.number(k)) for k in (1, 2)]
    messages = [*numbers(types, "/a", {0.0: 0.0}), *twice, *numbers(types, "/b", {1.0: 5.0})]
    table = read_bag(write_bag(tmp_path / "run", ".mcap", messages))
    assert column(table, "time") == [0.0, 1.0, 1.0]
    assert column(table, "/a") == [0.0, 1.0, 2.0]
    np.testing.assert_equal(column(table, "/b"), [np.nan, 5.0, np.nan])


def oscillation(at_s: np.ndarray[Any, Any]) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Pressure (kPa) and angle (rad) of 2 θ'' + 12 θ' + 150 θ = p, long after it began.

    Each sine of p of amplitude A at ω turns into one of A / (150 - 2 ω² + 12 i ω).
    """
    pressure, angle = np.full(at_s.size, 60.0), np.full(at_s.size, 60.0 / 150.0)
    for amplitude, hertz, phase in ((30.0, 0.4, 0.0), (20.0, 1.1, 1.0), (8.0, 2.3, 0.0)):
        omega = 2.0 * np.pi * hertz
        wave = amplitude * np.exp(1j * (omega * at_s + phase))
        pressure += wave.imag
        angle += (wave / (150.0 - 2.0 * omega**2 + 12.0j * omega)).imag
    return pressure, angle


def test_two_topics_of_two_rates_are_fitted_as_two_recorders(tmp_path: Path) -> None:
    """Pressure at 100 Hz, angle at 60 Hz, 5.8 ms apart: each parameter is found within 5 errors.

    The noise, 0.1 kPa and 2 mrad, makes the errors 0.04 % or so; without the times of either topic
    an angle would be up to 10 ms off, which N shows by a tenth.
    """
    types = Types(".mcap")
    rng = np.random.default_rng(1)
    pressure_s, angle_s = np.arange(0.0013, 20.0, 0.01), np.arange(0.0071, 20.0, 1 / 60)
    pressures = oscillation(pressure_s)[0] + 0.1 * rng.standard_normal(pressure_s.size)
    angles = oscillation(angle_s)[1] + 2e-3 * rng.standard_normal(angle_s.size)
    messages = numbers(types, "/pressure_kpa", dict(zip(pressure_s, pressures, strict=True)))
    messages += numbers(types, "/finger/angle_rad", dict(zip(angle_s, angles, strict=True)))
    messages += numbers(types, "/air", dict.fromkeys(np.arange(0.002, 20.0, 0.05), 20.0))
    log = load(write_bag(tmp_path / "run", ".mcap", messages))
    assert len(log) == pressure_s.size + angle_s.size
    remarks = codes(softid.inspect(log))
    assert "merged-rows" in remarks
    assert not remarks & {"missing-samples", "close-samples"}  # each row is of one recorder
    result = softid.fit(log, model="oscillator")
    found = {p.name: p for p in result.parameters}
    for name, truth in (("M", 2.0), ("N", 12.0), ("Q", 150.0)):
        error = found[name].stderr
        assert error is not None
        assert error < 2e-3 * truth
        assert abs(found[name].value - truth) < 5.0 * error


def test_messages_of_many_topics_raise_no_doubt_about_seconds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Four topics 30 µs apart: the median step of the rows, 30 µs, is that of no sensor."""
    types = Types(".mcap")
    messages = []
    for k, topic in enumerate(("/pressure_kpa", "/angle_deg", "/a", "/b")):
        values = {row / 50.0 + k * 3e-5: float(row) for row in range(50)}
        messages += numbers(types, topic, values)
    path = write_bag(tmp_path / "run", ".mcap", messages)
    assert not [i for i in load(path).issues if "is s its unit" in i.message]
    monkeypatch.setattr(BagTable, "is_timed_in_s", False)
    assert [i for i in load(path).issues if "is s its unit" in i.message]
