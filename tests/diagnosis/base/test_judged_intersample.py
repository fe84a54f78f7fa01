"""What a command does between its samples, where only the logs that judge tell."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import TRUTH, linear_angle

import softid
from softid.diagnosis_results import Verdict
from softid.identification.intersample_choice import HELD_INPUT
from softid.intersample import Intersample
from softid.log import Log

RATE_HZ, FINE, NOISE = 25.0, 40, 1e-3


def commanded(kind: str, *, held: bool, seed: int, declared: Intersample | None = None) -> Log:
    """40 s of the linear actuator under a command that is held at every sample, or goes straight.

    It is a sum of slow sines, or steps; between two samples the angle is exact.
    """
    rng = np.random.default_rng(seed)
    time_s = np.arange(40.0 * RATE_HZ) / RATE_HZ
    course = 60.0 - sum(10.0 * np.cos(rate * time_s) for rate in (0.5, 1.1, 1.7))
    if kind == "steps":
        course = np.repeat(rng.uniform(30.0, 90.0, 20), int(2.0 * RATE_HZ))
        course[:30] = course[0]
    fine_s = np.arange(time_s.size * FINE) / (RATE_HZ * FINE)
    arriving = np.repeat(course, FINE) if held else np.interp(fine_s, time_s, course)
    angle = linear_angle(fine_s, arriving - course[0])[::FINE] + course[0] / TRUTH["Q"]
    angle += NOISE * rng.standard_normal(time_s.size)
    channels = {"pressure_command": course, "angle": angle}
    asked = {"input": "pressure_command", "outputs": ("angle",)}
    log = Log.from_arrays(time_s, channels, **asked, name=f"{kind}-{seed}")
    return log.with_intersample(declared)


def told(found: softid.Diagnosis) -> list[str]:
    """What is said of how the command is held."""
    return [issue.message for issue in found.issues if issue.code == HELD_INPUT]


@pytest.mark.parametrize("held", [True, False])
def test_what_is_held_out_tells_how_a_command_is_held(held: bool) -> None:
    """Known truth: slow sines do not tell 20 ms of a time constant of 200 ms, and steps do."""
    fitted, judge = commanded("sines", held=held, seed=1), commanded("steps", held=held, seed=2)
    found = softid.diagnose(fitted, hold_out=[judge], model="oscillator")
    assert found.verdict is Verdict.ADEQUATE
    said = [message for message in told(found) if "do not tell" in message]
    assert bool(said) is held


@pytest.mark.slow
def test_what_is_declared_stays() -> None:
    """Then what is held out misses something, whatever another behaviour explains."""
    fitted = commanded("sines", held=True, seed=1, declared="straight")
    judge = commanded("steps", held=True, seed=2, declared="straight")
    found = softid.diagnose(fitted, hold_out=[judge], model="oscillator")
    assert found.verdict is not Verdict.ADEQUATE
    assert not told(found)
