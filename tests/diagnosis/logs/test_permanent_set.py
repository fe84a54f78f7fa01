"""What remains of a motion when its input is back where it began."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from softid.diagnosis.logs.permanent_set import permanent_set_issues, residual_set
from softid.log import Log
from softid.readers import load
from softid.synthesis import hidden_pair

TIME_S = np.arange(4000) * 0.01


def cycled(left: float, *, noise: float = 0.0, tau_s: float = 0.1, back_kpa: float = 2.0) -> Log:
    """Rest, a cycle to 50 kPa of ten seconds and back, with what is left at the end."""
    pressure = np.repeat([2.0, 50.0, back_kpa, 50.0], 1000)
    levels = np.repeat([0.0, 1.0, left, 1.0], 1000)
    angle = levels.copy()
    for k in range(1, angle.size):
        angle[k] = angle[k - 1] + 0.01 / tau_s * (levels[k] - angle[k - 1])
    angle += noise * np.random.default_rng(0).standard_normal(angle.size)
    return Log.from_arrays(TIME_S, {"pressure": pressure, "angle": angle}, name="cycled")


def test_a_known_set_is_found() -> None:
    """Known truth: 0.2 of a range of 1, on noise of a hundredth."""
    found = residual_set(cycled(0.2, noise=0.01), "angle")
    assert found is not None
    assert found.before == pytest.approx(0.0, abs=0.005)
    assert found.after == pytest.approx(0.2, abs=0.005)
    assert found.share == pytest.approx(0.2, rel=0.1)
    assert found.input_level == pytest.approx(2.0)


@pytest.mark.parametrize(
    "log",
    [
        cycled(0.02, noise=0.01),
        cycled(0.0, tau_s=5.0),
        cycled(0.2, back_kpa=20.0),
        cycled(0.1, back_kpa=4.0),
    ],
    ids=["noise", "still moving", "another level", "what the pressure brings"],
)
def test_what_is_no_set(log: Log) -> None:
    """Less than five times the noise; a motion that goes on; a rest at another pressure.

    2 kPa of 48 bring an eighth of the range where the curve is three times as steep as on average.
    """
    assert residual_set(log, "angle") is None


def test_a_motion_that_ends_at_the_beginning_leaves_no_set() -> None:
    """The log begins while the output still comes down from 1, and is back at rest later."""
    log = cycled(0.0, noise=0.001)
    angle = log.channels["angle"]
    ending = np.where(TIME_S < 10.0, np.exp(-TIME_S / 0.3), angle.values)
    begun = replace(log, channels={**log.channels, "angle": replace(angle, values=ending)})
    assert residual_set(begun, "angle") is None


@pytest.mark.parametrize(("held", "leaves"), [(1, False), (30, True)], ids=["one sample", "0.3 s"])
def test_a_log_that_leaves_its_first_level_at_once_begins_in_motion(
    held: int, leaves: bool
) -> None:
    """Known truth: 0.2 of the range stay after a cycle, seen by who rested before it."""
    log = cycled(0.2, noise=0.001)
    first = int(np.argmax(log.pressure_kpa > log.pressure_kpa[0] + 1.0))
    begun = log.between(log.time_s[first - held], log.time_s[-1])
    assert (residual_set(begun, "angle") is not None) is leaves


def test_a_rest_that_is_short_against_the_motion_leaves_no_set() -> None:
    """Ten seconds are ten time constants of one second, and not yet three of four."""
    log = cycled(0.2, tau_s=1.0)
    assert residual_set(log, "angle", 1.0) is not None
    assert residual_set(log, "angle", 4.0) is None


def test_the_remark_tells_the_numbers() -> None:
    """Log, both positions and the share; a set of less than a twentieth is not told."""
    (remark,) = permanent_set_issues([cycled(0.2, noise=0.001), cycled(0.04, noise=0.001)], 0.1)
    assert "cycled: angle begins at" in remark.message
    assert "a set of 20 % of its range" in remark.message
    assert remark.remedy


def test_a_reading_that_is_nothing_is_told_as_nothing() -> None:
    """A filter leaves 1e-320 kPa of a step; no one reads that off a gauge."""
    (issue,) = permanent_set_issues([cycled(1.0, back_kpa=1e-320)], 0.1)
    assert "with the pressure back at 0 kPa" in issue.message


@pytest.mark.parametrize(("name", "leaves"), [("hysteresis", True), ("delay", False)])
def test_effects_that_leave_one(name: str, leaves: bool) -> None:
    """Known truth: a hysteresis begins without memory and keeps some; a delay keeps nothing."""
    assert bool(permanent_set_issues(hidden_pair([name], seed=3).logs[:1], 0.2)) is leaves


def test_the_arms_keep_a_bend(measured: Path) -> None:
    """The data's description: about 10° stay after the first cycle of the two-segment arm."""
    log = load(measured / "two-segment-arm" / "Jan5_1.csv")
    found = residual_set(log, "angle")
    assert found is not None
    assert np.degrees(found.after - found.before) == pytest.approx(9.5, abs=1.0)
