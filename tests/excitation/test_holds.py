"""Settled windows: where they are, where they are not, and at which level."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn_logs import follow, quantised

from softid.excitation import distinct_levels, segment_excitation, settled_windows
from softid.excitation.holds import windows_of
from softid.excitation.motion import describe_motion, median_of_five, turning_points

RUNGS = (0.0, 20.0, 40.0, 60.0, 40.0, 20.0, 0.0)


def stairs(rate_hz: float = 100.0, hold_s: float = 3.0) -> tuple[np.ndarray, np.ndarray]:
    wanted = np.repeat(RUNGS, int(hold_s * rate_hz))
    return np.arange(wanted.size) / rate_hz, wanted


@pytest.mark.parametrize("noise", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("lag_s", [0.02, 0.3])
@pytest.mark.parametrize("step", [0.0, 0.8])
def test_every_rung_is_a_window(noise: float, lag_s: float, step: float) -> None:
    """One window per rung, at its level within the standard error of 60 samples and half a step."""
    time_s, wanted = stairs()
    rng = np.random.default_rng(0)
    measured = follow(time_s, wanted, lag_s) + noise * rng.standard_normal(time_s.size)
    windows = settled_windows(time_s, quantised(measured, step))
    assert len(windows) == len(RUNGS)
    for k, (window, rung) in enumerate(zip(windows, RUNGS, strict=True)):
        assert window.level == pytest.approx(rung, abs=0.5 + 3 * noise / 60**0.5 + step / 2)
        assert 300 * k <= window.start < window.stop <= 300 * (k + 1) + 30
        assert window.stop - window.start >= 150


def test_irregular_times() -> None:
    """The same rungs on a clock that jumps between 2 and 40 ms."""
    time_s, wanted = stairs()
    kept = np.sort(np.random.default_rng(1).choice(time_s.size, 700, replace=False))
    windows = settled_windows(time_s[kept], wanted[kept])
    assert [w.level for w in windows] == list(RUNGS)


def test_the_tail_of_a_window() -> None:
    """A tail of 0.4 keeps the last 40 % of each window."""
    time_s, wanted = stairs()
    whole, tail = settled_windows(time_s, wanted), settled_windows(time_s, wanted, tail=0.4)
    for full, part in zip(whole, tail, strict=True):
        assert part.stop == full.stop
        assert part.stop - part.start == pytest.approx(0.4 * (full.stop - full.start), abs=1)


@pytest.mark.parametrize("noise", [0.0, 0.5, 2.0])
@pytest.mark.parametrize("shape", ["sine", "triangle"])
def test_extremes_of_a_wave_are_no_windows(shape: str, noise: float) -> None:
    """A sine stays within 3 % of its extreme for 11 % of the period, and yet is never still."""
    time_s = np.arange(4000) * 0.01
    phase = (0.1 * time_s) % 1.0
    wave = -np.cos(2 * np.pi * phase) if shape == "sine" else 1.0 - np.abs(4.0 * phase - 2.0)
    values = 50.0 * wave + noise * np.random.default_rng(0).standard_normal(time_s.size)
    assert settled_windows(time_s, values) == ()


def test_a_flicker_does_not_split_a_hold() -> None:
    """Two samples of the other level, as a logger with late messages writes."""
    time_s, wanted = stairs()
    wanted[750:752] = 0.0
    windows = settled_windows(time_s, wanted)
    assert len(windows) == len(RUNGS)
    assert windows[2].level == 40.0


def test_a_resting_log_is_one_window() -> None:
    """Noise alone does not move."""
    noise = np.random.default_rng(0).standard_normal(1000)
    (window,) = settled_windows(np.arange(1000) * 0.01, 5.0 + noise)
    assert (window.start, window.stop) == (0, 1000)
    assert window.level == pytest.approx(5.0, abs=0.15)


def test_a_held_input_has_no_false_windows() -> None:
    """A sine of which only every 17th sample is new stands still, but never rests."""
    time_s = np.arange(6000) * 0.01
    held_s = 0.17 * np.floor(time_s / 0.17)
    assert settled_windows(time_s, 30.0 * np.sin(2 * np.pi * 0.1 * held_s)) == ()


def test_distinct_levels_do_not_chain() -> None:
    """Levels 1 apart with a tolerance of 1.5: the first two are one level, the third is not."""
    assert distinct_levels([0.0, 1.0, 2.0], 1.5) == (0.5, 2.0)


def test_turning_points_of_a_triangle() -> None:
    """Closed form: the corners."""
    values = np.concatenate([np.arange(10.0), np.arange(10.0, 0.0, -1.0), np.arange(10.0)])
    assert turning_points(values, 3.0).tolist() == [10, 20]


def test_the_median_keeps_edges() -> None:
    """A step stays where it is; one outlier vanishes."""
    values = np.repeat([0.0, 1.0], 10)
    spiked = values.copy()
    spiked[4] = 50.0
    assert np.array_equal(median_of_five(values), values)
    assert np.array_equal(median_of_five(spiked), values)


def test_brief_stops_count_neither_as_levels_nor_as_changes() -> None:
    """A coarse grid makes stops on the way between two levels of 3 s: 4 changes, 2 levels."""
    time_s = np.arange(1500) * 0.01
    wanted = np.where((time_s // 3.0) % 2 == 0, 0.0, 20.0)
    given = np.round(follow(time_s, wanted, 0.2) / 2.0) * 2.0
    (stretch,) = segment_excitation(time_s, given)
    assert stretch.transitions == 4
    assert len(stretch.levels) == 2
    assert stretch.shortest_hold_s is not None
    assert stretch.shortest_hold_s > 2.0


@pytest.mark.parametrize("count", [20_000, 99_999, 300_000])
@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_a_long_log_has_windows_as_sharp_as_a_short_one(count: int, noise: float) -> None:
    """No window reaches into another level, and each misses its own by two samples at most.

    A step of a log has its place to the sample, of which a median of five leaves two in doubt; the
    levels lie 4 or more apart, twenty times the noise.
    """
    per_hold = count // 40
    rng = np.random.default_rng(3)
    levels = rng.permutation(np.arange(40) * 5.0 + rng.uniform(-0.5, 0.5, 40))
    truth = np.repeat(levels, per_hold)
    values = truth + noise * np.random.default_rng(4).standard_normal(truth.size)
    windows = settled_windows(np.arange(truth.size) * 0.001, values)
    assert len(windows) == levels.size
    for k, window in enumerate(windows):
        assert abs(window.start - k * per_hold) <= 2
        assert abs(window.stop - (k + 1) * per_hold) <= 2


def test_small_steps_of_a_staircase_are_no_free_motion() -> None:
    """Rungs 2.4 % of the range apart, within the tube of 3 %, are two windows each to the sample.

    A ramp of the same height has none: both its halves are as wide as they are apart.
    """
    rungs = np.array([0.0, 50.0, 52.4, 100.0, 97.3, 21.1, 33.4, 71.9])
    time_s = np.arange(2400) * 0.01
    windows = settled_windows(time_s, np.repeat(rungs, 300))
    assert [(w.start, w.stop, w.level) for w in windows] == [
        (300 * k, 300 * (k + 1), pytest.approx(rung)) for k, rung in enumerate(rungs)
    ]
    (found,) = segment_excitation(time_s, np.repeat(rungs, 300))
    assert (found.kind, found.start, found.stop) == ("staircase", 0, time_s.size)
    ramp = np.concatenate([np.zeros(300), np.linspace(0.0, 100.0, 1200), np.full(300, 100.0)])
    assert len(settled_windows(time_s[:1800], ramp)) == 2


def test_two_levels_without_one_between_have_their_median() -> None:
    """The median of as many samples at 1 as at 2 is 1.5, and no sample lies near it."""
    values = np.array([0.0] * 20 + [1.0, 2.0] * 20)
    motion = describe_motion(0.01 * np.arange(values.size), values)
    narrow = replace(motion, tolerance=1e-3, thinning=1, full=values)
    (window,) = windows_of(narrow, [(20, 60)], values)
    assert window.level == 1.5
