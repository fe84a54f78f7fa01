"""A slow log tells little of the motion; a fast one tells whether any of the model is missing."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import linear_angle

from softid.diagnosis import diagnose
from softid.diagnosis.base.base_fit import Recordings, Request
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.fitted_together import (
    NOT_TOGETHER,
    TOLD_TOGETHER,
    Together,
    fitted_together,
)
from softid.diagnosis_results import Verdict
from softid.effects import effects_of
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]

TRUTH = {"M": 1.3, "N": 6.4, "Q": 170.0}
TIME_S = np.arange(3000) / 100.0
RAMP = np.interp(TIME_S, [0.0, 4.0, 14.0, 16.0, 26.0, 30.0], [0.0, 0.0, 80.0, 80.0, 0.0, 0.0])
SQUARE = np.where(TIME_S % 4.0 < 2.0, 10.0, 70.0)


def recorded(
    pressure: Array,
    name: str,
    *,
    delay_s: float = 0.0,
    stiffer: float = 0.0,
    noise: float = 0.004,
    seed: int = 1,
) -> Log:
    """A motion that rings at 1.8 Hz, with 0.3 kPa of noise of the gauge."""
    rng = np.random.default_rng((seed, len(name)))
    late = np.interp(TIME_S - delay_s, TIME_S, pressure)
    angle = linear_angle(TIME_S, late, TRUTH | {"Q": (1.0 + stiffer) * TRUTH["Q"]})
    angle += noise * rng.standard_normal(TIME_S.size)
    gauge = pressure + 0.3 * rng.standard_normal(TIME_S.size)
    return Log.from_arrays(TIME_S, {"pressure": gauge, "angle": angle}, name=name)


def asked(train: Log, judge: Log) -> Together | None:
    """What a fit to both says of an oscillator, before any search for a cause."""
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    recordings = Recordings(LogSet((train,)), (judge,))
    base = request.fit_base(recordings.logs, recordings.hold_out, thorough=False)
    search = CauseSearch(base, effects_of(()), 0, lambda message, fraction: None)
    return fitted_together(recordings, request, search)


@pytest.mark.parametrize(("seed", "before"), [(1, "could not be seen"), (2, "1.54")])
def test_an_inertia_that_only_a_fast_log_tells_is_not_missing(seed: int, before: str) -> None:
    """Known truth: an oscillator. A fit to a ramp leaves its inertia out, or has it as wrong as the
    noise makes it, and errs in the square wave; fitted to both it is the true one."""
    train, judge = recorded(RAMP, "ramp", seed=seed), recorded(SQUARE, "square", seed=seed)
    found = diagnose([train], hold_out=[judge], model="oscillator")
    assert (found.verdict, found.causes) == (Verdict.ADEQUATE, ())
    told = next(issue for issue in found.issues if issue.code == TOLD_TOGETHER)
    assert f"M is 1.3 kPa/rad·s² then, and {before} before" in told.message
    assert "misses angle by 0.0" in found.summary
    assert "fit ramp and square together" in found.summary


@pytest.mark.parametrize(
    "of_all", [{"delay_s": 0.03}, {"delay_s": 0.06}], ids=["delay-30ms", "delay-60ms"]
)
def test_what_no_parameter_makes_up_for_is_still_missing(of_all: dict[str, float]) -> None:
    """Known truth: a delay is in both logs, and the ramp does not show it."""
    found = asked(recorded(RAMP, "ramp", **of_all), recorded(SQUARE, "square", **of_all))
    assert found is not None
    assert found.alone is None
    assert found.issue.code == NOT_TOGETHER
    assert "something is missing that ramp alone hardly shows" in found.issue.message


def test_another_actuator_is_not_explained() -> None:
    """Known truth: what is held out is stiffer by a twentieth, and one fit follows one of both."""
    found = asked(recorded(RAMP, "ramp"), recorded(SQUARE, "square", stiffer=0.05))
    assert found is not None
    assert found.alone is None


def test_louder_noise_in_the_other_log_is_no_misfit() -> None:
    """Known truth: nothing is missing, and what is held out has five times the noise."""
    found = asked(recorded(RAMP, "ramp"), recorded(SQUARE, "square", noise=0.02))
    assert found is not None
    assert found.alone is not None


def test_a_log_that_tells_all_asks_for_no_second_fit() -> None:
    """Known truth: square waves foretell each other, so the question does not arise."""
    train, judge = recorded(SQUARE, "train"), recorded(SQUARE[::-1].copy(), "square")
    assert asked(train, judge) is None
