"""Each kind of excitation against its definition, and what is refused."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from softid.errors import InputError
from softid.synthesis.waveforms import WAVEFORMS, Steps, read_waveform


def command(waveform, times):
    pieces = waveform.pieces(0.0, np.random.default_rng(5))
    found = []
    for t in times:
        (piece,) = [p for p in pieces if p.start_s <= t < p.stop_s]
        found.append(piece.command_kpa(t))
    return found


CASES = [
    ({"kind": "hold", "level_kpa": 7, "duration_s": 2}, 2.0, {0.0: 7, 1.9: 7}),
    ({"kind": "rest", "duration_s": 2}, 2.0, {1.0: 0}),
    ({"kind": "steps", "levels_kpa": [0, 30, 10], "hold_s": 0.5}, 1.5, {0.4: 0, 0.5: 30, 1.2: 10}),
    (
        {
            "kind": "staircase", "first_kpa": 0, "last_kpa": 300, "steps": 10, "hold_s": 1,
            "back": True,
        },
        21.0,
        {0.0: 0, 1.0: 30, 10.5: 300, 11.5: 270, 20.5: 0},
    ),
    (
        {"kind": "square", "low_kpa": 5, "high_kpa": 9, "frequency_hz": 2, "cycles": 3},
        1.5,
        {0.1: 5, 0.3: 9, 1.4: 9},
    ),
    (
        {"kind": "sine", "low_kpa": 0, "high_kpa": 240, "frequency_hz": 0.5, "cycles": 1.5},
        3.0,
        {0.0: 0, 0.5: 120, 1.0: 240, 2.0: 0},
    ),
    (
        {"kind": "triangle", "low_kpa": 10, "high_kpa": 80, "period_s": 2, "cycles": 2},
        4.0,
        {0.0: 10, 0.5: 45, 1.0: 80, 1.5: 45, 3.0: 80},
    ),
    (
        {"kind": "sweep", "first_kpa": 80, "last_kpa": 20, "duration_s": 3},
        3.0,
        {0.0: 80, 1.0: 60, 2.0: 40},
    ),
    (  # 1 Hz growing by 2 Hz/s has passed t + t² periods: 0.75, 2 and 3.75
        {
            "kind": "chirp", "low_kpa": 0, "high_kpa": 10, "first_hz": 1, "last_hz": 5,
            "duration_s": 2,
        },
        2.0,
        {0.0: 0, 0.5: 5, 1.0: 0, 1.5: 5},
    ),
]  # fmt: skip


@pytest.mark.parametrize(("table", "duration_s", "values"), CASES, ids=lambda v: str(v)[:25])
def test_kinds(table: dict, duration_s: float, values: dict[float, float]) -> None:
    """Duration and values follow from each kind's definition; the tolerance is rounding."""
    waveform = read_waveform(table, where="r.toml, [excitation]")
    pieces = waveform.pieces(0.0, np.random.default_rng(0))
    assert pieces[-1].stop_s == pytest.approx(duration_s, abs=1e-12)
    assert command(waveform, values) == pytest.approx(list(values.values()), abs=1e-9)


def test_sequence_joins_its_parts() -> None:
    """Parts follow one another without gap, each starting its own clock."""
    part = {"kind": "sine", "low_kpa": 0, "high_kpa": 10, "frequency_hz": 1, "cycles": 1}
    rest = {"kind": "rest", "duration_s": 1.25}
    waveform = read_waveform({"kind": "sequence", "parts": [rest, part, rest]}, where="r.toml")
    pieces = waveform.pieces(3.0, np.random.default_rng(0))
    assert [(p.start_s, p.stop_s) for p in pieces] == [(3.0, 4.25), (4.25, 5.25), (5.25, 6.5)]
    assert pieces[1].command_kpa(4.75) == pytest.approx(10.0)


def test_random_levels_come_from_the_generator() -> None:
    """Same generator, same levels; all inside the range, not all equal."""
    table = {
        "kind": "random_levels", "low_kpa": 20, "high_kpa": 90, "count": 40, "shortest_s": 0.2,
        "longest_s": 0.6,
    }  # fmt: skip
    waveform = read_waveform(table, where="r.toml")
    made = [waveform.pieces(0.0, np.random.default_rng(s)) for s in (1, 1, 2)]
    levels = [[p.command_kpa(p.start_s) for p in pieces] for pieces in made]
    holds = np.array([p.stop_s - p.start_s for p in made[0]])
    assert levels[0] == levels[1] != levels[2]
    assert 20.0 <= min(levels[0]) < 40.0 < 70.0 < max(levels[0]) <= 90.0
    assert holds.min() > 0.199
    assert holds.max() < 0.601


def test_random_ramps_come_from_the_generator() -> None:
    """Same generator, same ramps; they join, begin and end low, and no two are of one slope."""
    table = {
        "kind": "random_ramps", "low_kpa": 20, "high_kpa": 90, "count": 40, "shortest_s": 0.2,
        "longest_s": 0.6,
    }  # fmt: skip
    waveform = read_waveform(table, where="r.toml")
    made = [waveform.pieces(0.0, np.random.default_rng(s)) for s in (1, 1, 2)]
    starts = [[p.command_kpa(p.start_s) for p in pieces] for pieces in made]
    assert starts[0] == starts[1] != starts[2]
    pieces = made[0]
    for one, next_one in pairwise(pieces):
        assert one.command_kpa(one.stop_s) == pytest.approx(next_one.command_kpa(next_one.start_s))
    assert starts[0][0] == pytest.approx(pieces[-1].command_kpa(pieces[-1].stop_s)) == 20.0
    assert 20.0 <= min(starts[0]) < 40.0 < 70.0 < max(starts[0]) <= 90.0
    holds = np.array([p.stop_s - p.start_s for p in pieces])
    assert 0.199 < holds.min() < holds.max() < 0.601


def test_a_multisine_has_its_tones_and_no_others() -> None:
    """Ten lines of equal size at multiples of 0.5 Hz, within the levels and reaching one nearly."""
    table = {
        "kind": "multisine", "low_kpa": 20, "high_kpa": 90, "frequency_hz": 0.5, "tones": 10,
        "cycles": 3,
    }  # fmt: skip
    waveform = read_waveform(table, where="r.toml")
    (piece,) = waveform.pieces(1.0, np.random.default_rng(1))
    assert (piece.start_s, piece.stop_s) == (1.0, 7.0)
    values = np.array([piece.command_kpa(t) for t in np.arange(1.0, 7.0, 0.01)])
    lines = np.abs(np.fft.rfft(values - 55.0)) / (0.5 * values.size)
    heard = np.flatnonzero(lines > 1e-6)
    assert heard.tolist() == [3 * k for k in range(1, 11)]
    assert np.ptp(lines[heard]) < 1e-6
    assert 0.9 * 35.0 < np.abs(values - 55.0).max() <= 35.0


def test_a_step_to_the_same_level_has_no_slope() -> None:
    """A held level is one number, not a line computed anew at each time."""
    (piece,) = Steps((0.1,), 3.0).pieces(0.0, np.random.default_rng(0))
    assert {piece.command_kpa(t) for t in np.linspace(0, 2.9, 50)} == {0.1}


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({}, "the key kind is missing"),
        ({"kind": "wobble"}, "kind of excitation is unknown.*'wobble'.*hold, rest"),
        ({"kind": "rest"}, "the key duration_s is missing"),
        ({"kind": "rest", "duration_s": 0}, "duration_s is out of range.*above 0"),
        ({"kind": "rest", "duration_s": "2"}, "a number is expected"),
        ({"kind": "rest", "duration_s": True}, "a number is expected"),
        ({"kind": "rest", "duration_s": float("nan")}, "out of range"),
        ({"kind": "rest", "duration_s": 1, "level_kpa": 3}, "key is unknown.*'level_kpa'"),
        ({"kind": "hold", "level_kpa": 3e5, "duration_s": 1}, "level_kpa is out of range"),
        ({"kind": "steps", "levels_kpa": [], "hold_s": 1}, "a list is expected"),
        ({"kind": "steps", "levels_kpa": [0, 5000], "hold_s": 1}, "out of range.*5000"),
        ({"kind": "square", "low_kpa": 0, "high_kpa": 1, "frequency_hz": 1, "cycles": 1.5},
         "a whole number is expected"),
        ({"kind": "sequence"}, "a sequence has no parts"),
        ({"kind": "sequence", "parts": [{"kind": "rest", "duration_s": -1}]}, "part 1.*range"),
        ({"kind": "sequence", "parts": [{"kind": "rest", "duration_s": 1}], "x": 1}, "unknown"),
        ("rest", "a table is expected"),
    ],
)  # fmt: skip
def test_refused(table: object, message: str) -> None:
    """Each mistake is one sentence with place and remedy."""
    with pytest.raises(InputError, match=message) as error:
        read_waveform(table, where="r.toml, [excitation]")
    assert str(error.value).startswith("r.toml, [excitation]")


def test_every_kind_is_tested() -> None:
    """A new kind needs a case here."""
    tested = {case[0]["kind"] for case in CASES} | {"sequence", "random_levels"}
    tested |= {"random_ramps", "multisine"}
    assert tested == set(WAVEFORMS)
