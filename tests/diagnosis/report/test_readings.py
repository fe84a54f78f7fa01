"""Limits and places of causes, told as the logs read them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade import fit_result
from handmade_diagnosis import cause, diagnosis, estimate

from softid.diagnosis.report.readings import reading_issues
from softid.diagnosis_results import Diagnosis, Verdict
from softid.models import Muscle

PLAIN = Muscle()
"""Whose angle is its position."""


def found(key: str, name: str, value: float, *, unit: str = "rad") -> Diagnosis:
    """A diagnosis of one cause over a fit whose log has a sensor zero of a thirtieth of a rad."""
    told = cause(key, [estimate(name, value, unit)], before=0.02, after=0.01)
    return replace(diagnosis(Verdict.NAMED), causes=(told,), extended=fit_result())


@pytest.mark.parametrize(
    ("key", "name"),
    [("sensor_clipping.lower", "sensor_clipping_lower"), ("contact", "contact_xw")],
)
def test_a_limit_is_told_with_the_zero(key: str, name: str) -> None:
    """By hand: 0.2 rad and a zero of 0.1/3 rad are 13.4 deg in the fitted log; others are not."""
    (issue,) = reading_issues(found(key, name, 0.2), PLAIN)
    reading = np.rad2deg(0.2 + 0.1 / 3)
    short = name.rpartition("_")[2]
    assert issue.message == f"{key}: {short} is a reading of {reading:.3g} deg in step_1"


def test_what_is_no_reading_is_not_told() -> None:
    """A time; a place in another unit than the output's; a zero that makes no difference."""
    assert reading_issues(found("delay", "delay_tau", 0.2, unit="s"), PLAIN) == ()
    assert reading_issues(found("contact", "contact_xw", 0.2, unit="mm"), PLAIN) == ()
    small = over_a_wide_range("contact", "contact_xw", 1.0)
    assert reading_issues(small, PLAIN) == ()


def test_a_zero_beyond_the_interval_of_a_limit_is_told() -> None:
    """A zero of 0.1/3 rad is 0.07 % of the range, and far outside an interval of ±0.005 rad."""
    known = over_a_wide_range("sensor_clipping", "sensor_clipping_upper", 0.1)
    (issue,) = reading_issues(known, PLAIN)
    assert "upper is a reading of 7.64 deg in step_1" in issue.message


@pytest.mark.parametrize(
    ("key", "name", "reading"),
    [("contact", "contact_xw", 112.0), ("sensor_clipping", "sensor_clipping_upper", 188.0)],
)
def test_a_place_is_told_as_its_output_reads_it(key: str, name: str, reading: float) -> None:
    """By hand: at a contraction of 38 mm a body of 150 mm is 112 mm long, with the zero that holds
    the 150; a limit of the sensor is one of the length itself."""
    made = found(key, name, 38.0, unit="mm")
    fit = made.extended
    assert fit is not None
    body = replace(
        fit,
        outputs=("length",),
        statistics=tuple(
            replace(s, channel="length", unit="mm", display_unit="mm", display_factor=1.0)
            for s in fit.statistics
        ),
        nuisances=tuple(replace(n, zero={"length": 150.0}) for n in fit.nuisances),
        fitted_range={"pressure": (0.0, 80.0), "length": (80.0, 150.0)},
    )
    (issue,) = reading_issues(replace(made, extended=body), PLAIN)
    assert f"is a reading of {reading:.3g} mm in step_1" in issue.message


def over_a_wide_range(key: str, name: str, value: float) -> Diagnosis:
    """The same in a log whose range is fifty times as large."""
    made = found(key, name, value)
    assert made.extended is not None
    wide = replace(made.extended, fitted_range={"pressure": (0.0, 80.0), "angle": (0.0, 50.0)})
    return replace(made, extended=wide)
