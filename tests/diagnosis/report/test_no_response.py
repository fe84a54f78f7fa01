"""Outputs that have nothing to do with the input."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import linear_angle
from noise import ar1

from softid.diagnosis import diagnose
from softid.diagnosis.report.motion_shown import NEARLY_STATIC
from softid.diagnosis.report.no_response import NO_RESPONSE
from softid.diagnosis_results import Diagnosis, Verdict
from softid.errors import InputError
from softid.log import Log

Array = npt.NDArray[np.float64]

TIME_S = np.arange(0.0, 40.0, 0.02)
STEPS = 90.0 + 90.0 * np.sign(np.sin(0.4 * np.pi * TIME_S))
MODELS = ("oscillator", "muscle")


def noise_of(rho: float, seed: int) -> Array:
    """White for a ``rho`` of 0."""
    return ar1(np.random.default_rng(seed), TIME_S.size, rho)


def found(model: str, angles: list[Array]) -> Diagnosis:
    fitted, held = (
        Log.from_arrays(TIME_S, {"pressure": STEPS, "angle": angle}, name=name)
        for name, angle in zip(("fitted", "held"), angles, strict=True)
    )
    return diagnose(fitted, hold_out=held, model=model, effects=["creep"])


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("rho", [0.0, 0.9])
def test_a_dead_sensor_is_told(model: str, rho: float) -> None:
    """Noise of 0.01 rad about 0.3 rad, white and autoregressive, while the pressure steps."""
    told = found(model, [0.3 + 0.01 * noise_of(rho, seed) for seed in (1, 2)])
    codes = {issue.code for issue in told.issues}
    assert told.verdict is Verdict.UNKNOWN
    assert NO_RESPONSE in codes
    assert NEARLY_STATIC not in codes
    assert not any("in which the actuator moves" in (i.remedy or "") for i in told.issues)
    check = "check that the sensor of angle works, and that the right columns are read"
    assert told.next_experiment == check
    assert {i.remedy for i in told.issues if i.code == "poor-fit"} == {check}
    assert "Angle does not visibly answer to pressure" in told.summary
    assert "nothing to mend" not in told.summary


def test_a_dead_sensor_that_drifts_is_told() -> None:
    """A motion of no end follows a drift, too, and looks like an answer."""
    drift = 0.002 * TIME_S
    told = found("oscillator", [drift + 0.01 * noise_of(0.0, seed) for seed in (1, 2)])
    assert told.verdict is Verdict.UNKNOWN
    assert "a straight line in time explains angle as well as the model does" in told.summary


@pytest.mark.slow
def test_a_sensor_that_is_dead_in_what_is_held_out_is_told() -> None:
    """The fitted log is followed to its noise; in the other one nothing moves."""
    noise = 0.01 * noise_of(0.0, 3)
    told = found("oscillator", [linear_angle(TIME_S, STEPS) + noise, 0.3 + 0.1 * noise])
    assert told.verdict is Verdict.UNKNOWN
    assert "In held, which is held out, angle stays still where the model moves" in told.summary
    assert "runs away" not in told.summary
    assert told.next_experiment is not None
    assert told.next_experiment.startswith("check that the sensor of angle works")
    assert not any("in which the actuator moves" in (i.remedy or "") for i in told.issues)


@pytest.mark.parametrize("model", MODELS)
def test_an_output_that_stays_constant_is_refused(model: str) -> None:
    """Nothing can be fitted to it."""
    with pytest.raises(InputError, match="never changes although the input does"):
        found(model, [np.full(TIME_S.size, 0.3)] * 2)


@pytest.mark.parametrize("model", MODELS)
def test_a_motion_deep_in_noise_is_none_of_it(model: str) -> None:
    """The noise is twice as large as the motion, of whose power four fifths are unexplained."""
    motion = linear_angle(TIME_S, STEPS)
    noise = 2.0 * float(np.std(motion))
    told = found(model, [motion + noise * noise_of(0.0, seed) for seed in (1, 2)])
    assert told.verdict is Verdict.ADEQUATE
    assert NO_RESPONSE not in {issue.code for issue in told.issues}
