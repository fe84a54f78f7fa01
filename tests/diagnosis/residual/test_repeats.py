"""Blocks in which the motion brings the same, on inputs whose rests and cycles are known."""

from __future__ import annotations

import numpy as np
import pytest

from softid.diagnosis.residual.repeats import cycling_runs, resting_runs
from softid.diagnosis.residual.structure import ResidualContext

MOTION_S = 0.2
PERIOD_S = 0.02


def under(u: np.ndarray, *, noise: float = 0.3) -> list[ResidualContext]:
    """A residual of nothing under an input from 0 to 100 with the noise of a pressure sensor."""
    time_s = PERIOD_S * np.arange(u.size)
    read = u + noise * np.random.default_rng(0).standard_normal(u.size)
    return [ResidualContext(time_s, u, np.gradient(u, time_s), read, np.zeros(u.size))]


def test_a_rest_is_cut_into_equal_blocks() -> None:
    """40 s after a sine of 20 s; five time constants of 0.2 s are the motion's and stay out."""
    time_s = PERIOD_S * np.arange(3000)
    u = np.where(time_s < 20.0, 50.0 - 50.0 * np.cos(2.0 * np.pi * 0.2 * time_s), 0.0)
    (run,) = resting_runs(under(u), MOTION_S, 2.0)
    assert run.part == 0
    assert run.edges_s[0] == pytest.approx(21.0, abs=0.6)
    assert run.edges_s[-1] == pytest.approx(60.0, abs=0.05)
    assert np.diff(run.edges_s) == pytest.approx(np.full(19, np.diff(run.edges_s)[0]))
    assert np.diff(run.edges_s)[0] >= 2.0
    assert not resting_runs(under(u[:2300]), MOTION_S, 2.0)


@pytest.mark.parametrize("cycle_s", [0.7, 5.0, 12.0])
def test_blocks_are_whole_cycles(cycle_s: float) -> None:
    """Each block is the smallest number of cycles that lasts 2 s, to a sample either way."""
    time_s = PERIOD_S * np.arange(6001)
    u = 50.0 - 50.0 * np.cos(2.0 * np.pi * time_s / cycle_s)
    (run,) = cycling_runs(under(u), MOTION_S, 2.0)
    block_s = cycle_s * np.ceil(2.0 / cycle_s)
    assert np.diff(run.edges_s) == pytest.approx(np.full(run.edges_s.size - 1, block_s), abs=0.04)
    assert run.edges_s[-1] - run.edges_s[0] > 120.0 - 3.0 * block_s - 2.0


def test_a_cycle_may_rise_more_than_once() -> None:
    """A staircase over three peaks of unlike height repeats after 9 s, not after 3 s."""
    peaks = np.repeat([100.0, 0.0, 60.0, 10.0, 80.0, 5.0], 75)
    (run,) = cycling_runs(under(np.tile(peaks, 10)), MOTION_S, 2.0)
    assert np.diff(run.edges_s) == pytest.approx(np.full(run.edges_s.size - 1, 9.0), abs=0.04)


def test_what_does_not_repeat_has_no_cycles() -> None:
    """A chirp, random levels, and four cycles, which are too few."""
    time_s = PERIOD_S * np.arange(3000)
    chirp = 50.0 - 50.0 * np.cos(2.0 * np.pi * (0.1 + 0.01 * time_s) * time_s)
    levels = np.repeat(np.random.default_rng(1).uniform(0.0, 100.0, 60), 50)
    four = np.where(time_s < 8.0, 50.0 - 50.0 * np.cos(np.pi * time_s), 0.0)
    for u in (chirp, levels, four):
        assert not cycling_runs(under(u), MOTION_S, 2.0)
