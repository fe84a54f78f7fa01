"""What the logs leave open of the motion, whatever the model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from handmade_diagnosis import cause, diagnosis
from linear_motion import TRUTH, linear_angle

from softid.diagnosis import diagnose
from softid.diagnosis.base.base_fit import BaseFit, Request
from softid.diagnosis.logs.one_frequency import sine_lag
from softid.diagnosis.report.motion_shown import (
    NEARLY_ALL,
    NEARLY_STATIC,
    ONE_FREQUENCY,
    motion_shown_issues,
    static_share,
)
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis_results import Alternative, Diagnosis, Verdict
from softid.errors import Issue
from softid.log import Log, LogSet
from softid.models.oscillator import Oscillator

Array = npt.NDArray[np.float64]

TIME_S = np.arange(0.0, 40.0, 0.02)
NOTHING = replace(diagnosis(Verdict.UNKNOWN), causes=(), descriptive=(), alternatives=())


def sine(hz: float, rest_s: float = 0.0) -> Array:
    moving_s = np.maximum(TIME_S - rest_s, 0.0)
    pressure: Array = 50.0 - 40.0 * np.cos(2.0 * np.pi * hz * moving_s)
    return pressure


def lagging(lag_s: float, *, sign: float = 1.0, hz: float = 0.5) -> Log:
    angle = 0.01 * sign * (50.0 - 40.0 * np.cos(2.0 * np.pi * hz * (TIME_S - lag_s)))
    return Log.from_arrays(TIME_S, {"pressure": sine(hz), "angle": angle})


def moving(pressure: Array, seed: int = 0) -> Log:
    """A linear motion with a little noise."""
    noise = 0.002 * np.random.default_rng(seed).standard_normal(TIME_S.size)
    angle = linear_angle(TIME_S, pressure) + noise
    return Log.from_arrays(TIME_S, {"pressure": pressure, "angle": angle}, name=f"log-{seed}")


def fitted(*logs: Log) -> BaseFit:
    return Request("oscillator", None, 0, lambda message, fraction: None).fit_base(
        LogSet(logs), (), thorough=False
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("lag_s", [0.05, 0.3, 0.8])
def test_the_lag_of_a_sine_is_found(lag_s: float, sign: float) -> None:
    """By hand: what is read later by so much, falling or rising."""
    found = sine_lag([lagging(lag_s, sign=sign)], "angle", falls=sign < 0.0)
    assert found == pytest.approx((0.5, lag_s), abs=0.005)


def test_more_than_one_frequency_has_no_single_lag() -> None:
    """Nor have steps."""
    steps = 50.0 + 40.0 * np.sign(np.sin(0.4 * np.pi * TIME_S))
    assert sine_lag([lagging(0.1), lagging(0.1, hz=0.25)], "angle") is None
    assert sine_lag([moving(steps)], "angle") is None
    assert sine_lag([lagging(0.1), moving(steps)], "angle") is None


def test_a_rest_beside_the_sine_does_not_count() -> None:
    found = sine_lag([moving(sine(0.5, rest_s=8.0))], "angle")
    assert found is not None


def test_drop_outs_are_left_out() -> None:
    log = lagging(0.3)
    spoiled = log.channels["angle"].values.copy()
    lost = np.zeros(TIME_S.size, bool)
    lost[::7] = True
    spoiled[lost] = 9.0
    channels = dict(log.channels) | {"angle": replace(log.channels["angle"], values=spoiled)}
    masked = replace(log, channels=channels).with_masked(lost)
    assert sine_lag([masked], "angle") == pytest.approx((0.5, 0.3), abs=0.005)


def test_the_share_of_a_static_curve_by_hand() -> None:
    """A parabola with a zero of its own in each of two logs is followed; steps with a lag are not.

    Where the model leaves nothing the share is that of the curve: 1 − SS/SS of the means.
    """
    pressure = sine(0.3)
    logs = [
        Log.from_arrays(
            TIME_S, {"pressure": pressure, "angle": zero + 1e-4 * pressure**2}, name=f"log-{zero}"
        )
        for zero in (0.0, 0.7)
    ]
    problem = fitted(*logs).candidate.problem
    assert static_share(problem, 0.0) == pytest.approx(1.0, abs=1e-9)
    steps = np.where(TIME_S % 2.0 < 1.0, 20.0, 80.0)
    shifted = np.where((TIME_S - 0.25) % 2.0 < 1.0, 0.2, 0.8)
    log = Log.from_arrays(TIME_S, {"pressure": steps, "angle": shifted})
    problem = fitted(log).candidate.problem
    # A quarter of the samples is off by the whole step: the means of both levels explain a quarter.
    assert static_share(problem, 0.0) == pytest.approx(0.25, abs=0.02)


def test_a_model_that_explains_nothing_has_no_static_share() -> None:
    """Of noise a curve explains all of the hundredth that a model does."""
    noise = np.random.default_rng(0).standard_normal(TIME_S.size)
    problem = fitted(
        Log.from_arrays(TIME_S, {"pressure": sine(0.3), "angle": noise})
    ).candidate.problem
    whole = float(np.sum((noise - noise.mean()) ** 2))
    assert static_share(problem, 0.99 * whole) == 0.0


def test_what_the_logs_show_is_told() -> None:
    """One frequency with a lag of more than 5 degrees; with care beside a lag, not beside a tie."""
    base = fitted(moving(sine(0.5)))
    (issue,) = motion_shown_issues(base, NOTHING)
    assert issue.code == ONE_FREQUENCY
    assert "which is a sine of 0.5 Hz and nothing else" in issue.message
    lag = cause("delay", (), before=1.0, after=0.5)
    named = replace(diagnosis(Verdict.NAMED), causes=(lag,), alternatives=())
    (cautious,) = motion_shown_issues(base, named)
    assert "that delay of the input is a part of it, and not another lag" in cautious.message
    tie = Alternative(("delay", "pneumatic_lag"), {"pneumatic_lag": 1.0}, "")
    assert motion_shown_issues(base, replace(named, alternatives=(tie,))) == ()


def test_what_is_held_out_may_hold_more() -> None:
    """A sine of another frequency there."""
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    held = moving(sine(0.9), seed=1)
    base = request.fit_base(LogSet((moving(sine(0.5)),)), (held,), thorough=False)
    (issue,) = motion_shown_issues(base, NOTHING)
    assert issue.remedy == "fit what is held out, too, which holds more"


def test_a_slow_input_is_nearly_static() -> None:
    (issue,) = motion_shown_issues(fitted(moving(sine(0.05))), NOTHING)
    assert issue.code == NEARLY_STATIC
    assert "angle is nearly static here: pressure changes slowly" in issue.message


def test_quick_steps_between_long_holds_are_not_nearly_static() -> None:
    """A motion three times as quick between levels of 10 s, reached in 2 s or at once: for all the
    holds a curve explains 98 % in either case, but steps show the motion."""
    begins_s, levels = 10.0 * np.arange(5), [20.0, 80.0, 20.0, 80.0, 20.0]
    quicker = {"M": TRUTH["M"] / 9.0, "N": TRUTH["N"] / 3.0, "Q": TRUTH["Q"]}
    for rise_s, is_told in ((0.04, False), (2.0, True)):
        corner_s = np.sort(np.concatenate((begins_s, begins_s[1:] - rise_s)))
        pressure = np.interp(TIME_S, corner_s, np.repeat(levels, 2)[:-1])
        noise = 0.002 * np.random.default_rng(0).standard_normal(TIME_S.size)
        angle = linear_angle(TIME_S, pressure, quicker) + noise
        base = fitted(Log.from_arrays(TIME_S, {"pressure": pressure, "angle": angle}))
        squares = base.candidate.squares * base.sigma["angle"] ** 2
        assert static_share(base.candidate.problem, squares) > NEARLY_ALL
        assert bool(motion_shown_issues(base, NOTHING)) == is_told


def test_steps_show_the_motion() -> None:
    steps = 50.0 + 40.0 * np.sign(np.sin(0.4 * np.pi * TIME_S))
    assert motion_shown_issues(fitted(moving(steps)), NOTHING) == ()


def test_a_drive_without_a_spring_has_no_static_curve() -> None:
    """Position is the integral of the input."""
    base = fitted(moving(sine(0.05)))
    problem = base.candidate.problem
    free = replace(
        base.candidate,
        problem=type(problem)(
            Oscillator(spring="none"), Oscillator(spring="none").parameters(), problem.logs
        ),
    )
    assert motion_shown_issues(replace(base, candidate=free), NOTHING) == ()


def told(code: str, found: Diagnosis) -> str:
    return write_summary(replace(found, issues=(Issue(code, "info", "so it is", "do so"),))).summary


def test_a_cause_explains_why_a_log_looks_static() -> None:
    """One frequency is always told, the curve where something is left that has no name."""
    assert "So it is." in told(NEARLY_STATIC, diagnosis(Verdict.UNKNOWN))
    assert "So it is." not in told(NEARLY_STATIC, diagnosis(Verdict.NAMED))
    assert "So it is." in told(ONE_FREQUENCY, diagnosis(Verdict.NAMED))


@pytest.mark.slow
def test_a_diagnosis_of_one_sine_says_so() -> None:
    found = diagnose(moving(sine(0.5)), model="oscillator", effects=["creep"])
    assert found.verdict is Verdict.ADEQUATE
    assert "one frequency does not tell whether that is a delay" in found.summary
