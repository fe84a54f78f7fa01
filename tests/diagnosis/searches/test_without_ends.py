"""A record that was smoothed there and back by another tool, and ends while the actuator moves."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import linear_log
from scipy.signal import butter, filtfilt

from softid.diagnosis import diagnose
from softid.diagnosis.searches.without_ends import SMOOTHED_ENDS, without_ends
from softid.diagnosis_results import Diagnosis, Verdict
from softid.log import Log
from softid.synthesis import hidden_pair

Array = npt.NDArray[np.float64]

RATE_HZ, CUT_OFF_HZ, ORDER = 100.0, 2.5, 2


def smoothed(log: Log) -> Log:
    """The log up to the middle of a motion, with its output filtered by scipy's own ends."""
    (name,) = log.outputs
    speed = np.abs(np.gradient(log.channels[log.input].values))
    late = np.flatnonzero(log.time_s > 0.8 * log.time_s[-1])
    stop = late[int(np.argmax(speed[late]))] + 4
    b, a = butter(ORDER, CUT_OFF_HZ / (0.5 * RATE_HZ))
    values = log.channels[name].values[:stop]
    channels = {log.input: log.channels[log.input].values[:stop], name: filtfilt(b, a, values)}
    units = {key: log.channels[key].unit for key in channels}
    return Log.from_arrays(log.time_s[:stop], channels, outputs=(name,), units=units, name=log.name)


@cache
def answer_to(seed: int) -> Diagnosis:
    """One diagnosis for the tests that look at it."""
    train, judge = (smoothed(log) for log in hidden_pair((), seed=seed).logs)
    return diagnose([train], hold_out=[judge], model="muscle", effects=["smoothing"])


@pytest.mark.slow
@pytest.mark.parametrize("seed", [5, 6, 7, 8, 9, 10])
def test_the_ends_of_a_smoothed_record_cost_nothing(seed: int) -> None:
    """Stands on the filter's own numbers: the cut-off is within a tenth, and known that well."""
    found = answer_to(seed)
    assert found.verdict is Verdict.NAMED
    (cause,) = found.causes
    period, order = cause.parameters
    assert period.value == pytest.approx(1.0 / CUT_OFF_HZ, rel=0.1)
    assert order.value == pytest.approx(ORDER, rel=0.15)
    for told in (period, order):
        assert told.ci95 is not None
        assert told.ci95[1] < 1.3 * told.ci95[0]


def test_the_ends_are_told() -> None:
    """Those of both logs, with the time that a smoothed reading reaches."""
    told = [issue.message for issue in answer_to(5).issues if issue.code == SMOOTHED_ENDS]
    assert len(told) == 2
    assert all("within 0.8" in message for message in told)


def test_ends_are_left_out_unless_they_are_most_of_a_log() -> None:
    """A closed form: samples nearer than the reach to the first or the last one."""
    log = linear_log()
    reach_s = 0.05 * (log.time_s[-1] - log.time_s[0])
    short = without_ends(log, reach_s)
    inner = (log.time_s >= log.time_s[0] + reach_s) & (log.time_s <= log.time_s[-1] - reach_s)
    assert np.array_equal(short.masked, ~inner)
    assert [issue.code for issue in short.issues][-1:] == [SMOOTHED_ENDS]
    assert without_ends(log, 3.0 * reach_s) is log
