"""No unit makes a fit another one: how far an unknown may move follows from the log itself."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from linear_motion import linear_angle, linear_log, linear_problem, pressure_course

from softid.fitters.problem import Problem
from softid.fitters.reach import FREE_REACH, motion_of, usual_motion
from softid.identification import fit
from softid.log import Log
from softid.models import Oscillator
from softid.results import FitResult, FitStatus

Array = npt.NDArray[np.float64]

RATE_HZ = 50.0


def moving_counts(*, factor: float, offset: float, samples: int = 500) -> Log:
    """Counts of a converter, in spans of the motion times a factor; the log begins in motion."""
    time_s = np.arange(samples + 100) / RATE_HZ
    pressure = pressure_course(time_s)
    angle = linear_angle(time_s, pressure)
    angle += 0.01 * np.ptp(angle) * np.random.default_rng(0).standard_normal(angle.size)
    counts = factor * (angle / np.ptp(angle) + offset)
    channels = {"pressure": pressure[100:], "adc": counts[100:]}
    return Log.from_arrays(time_s[100:], channels, outputs=("adc",), units={"adc": "1"})


def integrated(*, factor: float) -> Log:
    """The speed of a motion without a spring follows an input that rests at 40 in its unit."""
    time_s = np.arange(500) / RATE_HZ
    drive = 40.0 + 30.0 * np.sin(1.3 * time_s) + 10.0 * np.sin(4.1 * time_s)
    speed = (drive - 40.0) / 10.0
    x = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1])) / RATE_HZ))
    x += 0.01 * np.ptp(x) * np.random.default_rng(1).standard_normal(x.size)
    channels = {"drive": factor * drive, "adc": x}
    units = {"drive": "1", "adc": "1"}
    return Log.from_arrays(time_s, channels, input="drive", outputs=("adc",), units=units)


@given(exponent=st.floats(-6.0, 8.0), offset=st.sampled_from([0.0, 5.0]))
@example(exponent=float(np.log10(1.4e7)), offset=0.0)
@settings(max_examples=12, deadline=None)
def test_the_unit_of_an_output_changes_nothing(exponent: float, offset: float) -> None:
    """An identity: the motion times a factor has its coefficients divided by it.

    To a millionth, for an optimum is reached to a share of the standard errors. Counts of a
    converter of 24 bits ended far from the optimum, and were said not to have moved.
    """
    factor = 10.0**exponent
    usual, other = (
        fit(moving_counts(factor=f, offset=offset), model="oscillator") for f in (1.0, factor)
    )
    assert usual.status is FitStatus.CONVERGED
    assert other.status is FitStatus.CONVERGED
    assert other.free == usual.free
    assert other.statistics[0].fit_percent == pytest.approx(usual.statistics[0].fit_percent, 1e-6)
    for name in usual.free:
        assert other.values[name] * factor == pytest.approx(usual.values[name], rel=1e-6)


@cache
def fit_in_unit(factor: float) -> FitResult:
    """A fit to the log whose input is given in a unit smaller by the factor."""
    return fit(integrated(factor=factor), model=Oscillator(order="first", spring="none"))


@given(exponent=st.floats(-6.0, 8.0))
@example(exponent=7.0)
@settings(max_examples=8, deadline=None)
def test_the_unit_of_an_input_changes_nothing(exponent: float) -> None:
    """An identity: the coefficients and the input at rest, whose scale is linear, grow with it.

    To a hundredth of their standard errors: on which side of its tolerance the search ends may
    differ, for the sums are rounded otherwise.
    """
    factor = 10.0**exponent
    usual, other = fit_in_unit(1.0), fit_in_unit(factor)
    assert usual.status is other.status is FitStatus.CONVERGED
    assert "offset" in usual.free
    for name, stderr in ((p.name, p.stderr) for p in usual.parameters if p.name in usual.free):
        assert stderr is not None
        assert other.values[name] / factor == pytest.approx(usual.values[name], abs=0.01 * stderr)


def test_a_linear_parameter_reaches_as_far_as_a_channel_of_its_unit() -> None:
    """By definition: three spans of the input for what is in its unit and has no value yet."""
    model = Oscillator(spring="none", x_unit="rad", u_unit="kPa")
    log = linear_log()
    problem = Problem(model, model.parameters(), [log])
    span = float(np.ptp(log.channels["pressure"].values))
    assert problem.reach()[problem.free.index("offset")] == pytest.approx(3.0 * span)


def test_a_segment_that_stays_still_is_as_large_as_the_others() -> None:
    """By definition: in a segment of one value the start is sought within the span of all."""
    log = linear_log(noise=0.01)
    angle, time_s = log.channels["angle"].values.copy(), log.time_s.copy()
    angle[-20:] = angle[-20]
    time_s[-20:] += 10.0
    channels = {**log.channels, "angle": replace(log.channels["angle"], values=1e7 * angle)}
    still = replace(log, time_s=time_s, channels=channels)
    model = Oscillator(x_unit="rad", u_unit="kPa")
    problem = Problem(model, model.parameters(), [still])
    assert len(problem.segments) == 2
    whole = motion_of(problem.segments[0], "angle")
    assert motion_of(problem.segments[1], "angle") == (0.0, 0.0)
    reach = problem.reach()
    assert reach[problem.state_positions(1)] == pytest.approx(FREE_REACH * np.array(whole))
    assert reach[problem.zero_position(0, "angle")] == FREE_REACH * whole[0]


def test_an_output_that_never_moves_has_a_size() -> None:
    """By definition: 1."""
    segment = linear_log().segments()[0]
    still = replace(segment, outputs={"angle": np.full(segment.time_s.size, 7.0)})
    assert usual_motion([still], "angle") == (1.0, 1.0)


def test_other_segments_have_a_reach_of_their_own() -> None:
    """A log cut into two pieces that begin in motion has initial states that the whole has not."""
    problem = linear_problem([linear_log()])
    assert problem.reach().size == problem.size
    (segment,) = problem.segments
    middle = segment.time_s.size // 2
    pieces = [segment.part(slice(0, middle)), segment.part(slice(middle, None))]
    cut = Problem.with_segments(problem, pieces, [(0, True), (0, False)])
    assert cut.size > problem.size
    assert cut.reach().size == cut.size
