"""A log with uneven samples, read at even times."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from softid.diagnosis.logs.decimation import is_regular
from softid.diagnosis.logs.even_sampling import evenly_sampled
from softid.intersample import Intersample
from softid.log import Log

Array = npt.NDArray[np.float64]

N, PERIOD_S = 400, 0.02


def uneven_log(*, lost: slice = slice(0, 0), masked: int | None = None) -> Log:
    """Straight pressure and angle at times that scatter by 30 %, some of them lost."""
    scatter = np.random.default_rng(1).uniform(-0.3, 0.3, N)
    time_s = np.delete(PERIOD_S * (np.arange(N) + scatter), lost)
    log = Log.from_arrays(time_s, {"pressure": 2.0 * time_s, "angle": 5.0 - time_s})
    return log if masked is None else log.with_masked(np.arange(len(log)) == masked)


def test_an_even_log_is_the_same() -> None:
    time_s = PERIOD_S * np.arange(N)
    log = Log.from_arrays(time_s, {"pressure": time_s, "angle": time_s})
    assert evenly_sampled(log) is log


def test_lines_stand_between_samples() -> None:
    """What is straight stays so, at even times from the first to the last sample."""
    log = uneven_log()
    assert not is_regular(log)
    even = evenly_sampled(log)
    assert even is not None
    assert is_regular(even)
    assert even.time_s[0] == log.time_s[0]
    assert log.time_s[-1] - even.time_s[-1] < even.period_s
    assert even.period_s == pytest.approx(log.period_s)
    assert even.pressure_kpa == pytest.approx(2.0 * even.time_s)
    assert even.channels["angle"].values == pytest.approx(5.0 - even.time_s)
    assert even.masked is not None
    assert not even.masked.any()


@pytest.mark.parametrize(("count", "is_left_out"), [(1, False), (3, True)])
def test_no_line_stands_over_what_was_lost(count: int, is_left_out: bool) -> None:
    """One sample that is missing is bridged; three in a row are left out of the residuals."""
    log = uneven_log(lost=slice(200, 200 + count))
    even = evenly_sampled(log)
    assert even is not None
    assert even.masked is not None
    before, after = log.time_s[199], log.time_s[200]
    within = (even.time_s > before) & (even.time_s < after)
    assert within.any()
    assert even.masked[within].all() == even.masked.any() == is_left_out
    assert not even.masked[~within].any()


def test_neighbours_of_a_sample_left_out_are_left_out() -> None:
    log = uneven_log(masked=100)
    even = evenly_sampled(log)
    assert even is not None
    assert even.masked is not None
    left_out = even.time_s[even.masked]
    assert left_out.size > 0
    assert np.all((left_out > log.time_s[99]) & (left_out <= log.time_s[101]))


@pytest.mark.parametrize(
    ("intersample", "is_evened"),
    [("straight", True), ("smooth", True), ("held", False), ("zoh", False)],
)
def test_a_held_input_is_not_moved(intersample: Intersample, is_evened: bool) -> None:
    log = replace(uneven_log(), intersample=intersample)
    assert (evenly_sampled(log) is not None) is is_evened


def test_a_log_that_stalls_is_not_bridged() -> None:
    log = uneven_log(lost=slice(150, 300))
    assert len(log.segments()) > 1
    assert evenly_sampled(log) is None


def test_a_log_in_bursts_has_no_even_times() -> None:
    """Pairs 1 µs apart every 0.1 s: lines at median intervals would be 50,000 times as many."""
    first_s = 0.1 * np.arange(200)
    time_s = np.sort(np.concatenate((first_s, first_s + 1e-6)))
    log = Log.from_arrays(time_s, {"pressure": 2.0 * time_s, "angle": 5.0 - time_s})
    assert len(log.segments()) == 1
    assert evenly_sampled(log) is None
