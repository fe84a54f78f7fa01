"""Stretches of known excitation are recognised with their numbers."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from drawn_logs import follow, quantised

from softid.excitation import Stretch, excitation_and_holds, segment_excitation


def protocol(rate_hz: float) -> np.ndarray:
    """Staircase up and down, 0.5 Hz sine, chirp 0.1 to 2 Hz, a hold of 20 s, rest."""
    sine_s, chirp_s = np.arange(0, 20, 1 / rate_hz), np.arange(0, 40, 1 / rate_hz)
    rungs = [0.0, 0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 80.0, 60.0, 40.0, 20.0, 0.0]
    return np.concatenate(
        [
            np.repeat(rungs, int(4 * rate_hz)),
            50.0 - 50.0 * np.cos(2 * np.pi * 0.5 * sine_s),
            50.0 - 50.0 * np.cos(2 * np.pi * (0.1 * chirp_s + 0.5 * 1.9 / 40 * chirp_s**2)),
            np.full(int(20 * rate_hz), 70.0),
            np.zeros(int(15 * rate_hz)),
        ]
    )


MEASURED = {
    "exact": {},
    "noisy": {"noise": 1.0},
    "quantised": {"step": 1.0},
    "lagging": {"lag_s": 0.1, "noise": 0.2},
    "slow": {"lag_s": 0.5, "noise": 0.2},
    "coarse": {"rate_hz": 30.0, "lag_s": 0.2, "noise": 0.5, "step": 0.8},
    "irregular": {"lag_s": 0.2, "noise": 0.2, "jitter": 0.2},
}


@pytest.mark.parametrize("how", MEASURED)
def test_a_composite_protocol(how: str) -> None:
    """Kinds in order, edges within 2 s, frequencies within 2 % (sine) and 25 % (chirp ends).

    A chirp's frequency is the mean over its first and last cycle, hence the wider limit.
    """
    given = {"rate_hz": 100.0, "lag_s": 0.0, "noise": 0.0, "step": 0.0, "jitter": 0.0}
    given |= MEASURED[how]
    rng = np.random.default_rng(0)
    values = protocol(given["rate_hz"])
    time_s = np.arange(values.size) / given["rate_hz"]
    time_s = np.sort(time_s + given["jitter"] / given["rate_hz"] * rng.standard_normal(values.size))
    values = follow(time_s, values, given["lag_s"]) if given["lag_s"] else values
    values = quantised(values + given["noise"] * rng.standard_normal(values.size), given["step"])
    found = [s for s in segment_excitation(time_s, values) if s.duration_s > 1.0]
    assert [s.shape or s.kind for s in found] == ["staircase", "sine", "chirp", "step"]
    stairs, sine, chirp, step = found
    assert [s.start_s for s in found] == pytest.approx([0.0, 48.0, 68.0, 108.0], abs=2.0)
    assert stairs.levels == pytest.approx((0, 20, 40, 60, 80, 100), abs=0.7)
    assert stairs.transitions == 10
    assert sine.frequency_hz == pytest.approx(0.5, rel=0.02)
    assert sine.offset == pytest.approx(50.0, abs=1.0)
    assert sine.amplitude == pytest.approx(50.0 / np.hypot(1, np.pi * given["lag_s"]), rel=0.03)
    assert chirp.frequency_hz == pytest.approx(0.27, rel=0.25)
    assert chirp.frequency_end_hz == pytest.approx(2.0, rel=0.25)
    assert step.levels == pytest.approx((0.0, 70.0), abs=0.5)
    assert step.transitions == 1


def test_stretches_cover_the_log() -> None:
    """No sample is lost and none is told twice."""
    values = protocol(50.0)
    found = segment_excitation(np.arange(values.size) / 50.0, values)
    assert found[0].start == 0
    assert found[-1].stop == values.size
    assert all(a.stop == b.start for a, b in pairwise(found))


def test_a_triangle() -> None:
    """±20 about 30 at 0.1 Hz moves at 8 per second."""
    time_s = np.arange(6000) * 0.01
    values = 10.0 + 40.0 * (1.0 - np.abs(2.0 * ((0.1 * time_s) % 1.0) - 1.0))
    (found,) = segment_excitation(time_s, values)
    assert (found.kind, found.shape) == ("sweep", "triangle")
    assert found.frequency_hz == pytest.approx(0.1, rel=0.01)
    assert found.rate == pytest.approx(8.0, rel=0.01)
    assert found.amplitude == pytest.approx(20.0, rel=0.01)


def test_a_ramp_between_rests() -> None:
    """0 to 90 in 30 s after 5 s of rest: 3 per second."""
    time_s = np.arange(4000) * 0.01
    values = np.clip(3.0 * (time_s - 5.0), 0.0, 90.0)
    rest, ramp, top = segment_excitation(time_s, values)
    assert (rest.kind, ramp.shape, top.kind) == ("rest", "ramp", "rest")
    assert ramp.rate == pytest.approx(3.0, rel=0.01)


def test_a_single_step() -> None:
    """One change between two levels."""
    (found,) = segment_excitation(np.arange(200) * 0.05, np.repeat([0.0, 80.0], 100))
    assert (found.kind, found.transitions, found.levels) == ("step", 1, (0.0, 80.0))
    assert found.hold_s == pytest.approx(4.95)


def test_a_log_that_begins_in_a_change() -> None:
    """Two samples at 0 before the pump is switched on for 3 s: still one step stretch."""
    values = np.repeat([0.0, 100.0, 0.0], [2, 98, 98])
    (found,) = segment_excitation(np.arange(198) * 0.03, values)
    assert (found.kind, found.transitions) == ("step", 2)


def test_a_sum_of_sines_is_free() -> None:
    """Three frequencies without a common period of less than 100 s have no shape for most of it."""
    time_s = np.arange(6000) * 0.01
    parts = [20.0 * np.sin(2 * np.pi * f * time_s + f) for f in (0.13, 0.29, 0.47)]
    found = segment_excitation(time_s, sum(parts))
    assert sum(s.duration_s for s in found if s.kind == "free") > 40.0


def test_holds_come_along() -> None:
    """Both results in one call are those of the single calls where no wave is in the input."""
    values = np.repeat([0.0, 30.0, 60.0], 200)
    time_s = np.arange(600) * 0.01
    stretches, windows = excitation_and_holds(time_s, values)
    assert stretches == segment_excitation(time_s, values)
    assert [w.level for w in windows] == [0.0, 30.0, 60.0]


@pytest.mark.parametrize("n", [2, 3, 5, 9, 20])
def test_short_logs(n: int) -> None:
    """Any two samples make a log; each answer covers it."""
    rng = np.random.default_rng(n)
    for values in (np.zeros(n), np.arange(n, dtype=float), rng.standard_normal(n)):
        found: tuple[Stretch, ...] = segment_excitation(np.arange(n) * 0.1, values)
        assert (found[0].start, found[-1].stop) == (0, n)
