"""Readings at other times than their stamps say: what is left is the speed times a random time."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import linear_angle

from softid.diagnosis import diagnose
from softid.diagnosis.report.timing import UNCERTAIN_TIMES
from softid.diagnosis.residual.structure import ResidualContext
from softid.diagnosis.residual.uncertain_times import UncertainTimes, uncertain_times
from softid.diagnosis_results import Verdict
from softid.log import Log

Array = npt.NDArray[np.float64]

PERIOD_S = 0.01
TIME_S = np.arange(4000) * PERIOD_S
PHASE = 2.0 * np.pi * (0.1 * TIME_S + 0.02 * TIME_S**2)
X, V = np.sin(PHASE), 2.0 * np.pi * (0.1 + 0.04 * TIME_S) * np.cos(PHASE)
"""A chirp from 0.1 to 1.7 Hz."""


def told(residual: Array) -> UncertainTimes | None:
    part = ResidualContext(TIME_S, X, V, X, residual, True)
    return uncertain_times([part], PERIOD_S)


@pytest.mark.parametrize("sd_s", [2e-3, 5e-3])
@pytest.mark.parametrize("seed", range(5))
def test_the_size_of_the_times_is_told(sd_s: float, seed: int) -> None:
    """Known truth: normal times, and noise; 4000 samples tell a standard deviation to 3 %."""
    rng = np.random.default_rng(seed)
    noise, times = 0.004 * rng.standard_normal(X.size), sd_s * rng.standard_normal(X.size)
    found = told(V * times + noise)
    assert found is not None
    assert found.sd_s == pytest.approx(sd_s, rel=0.05)
    assert found.still == pytest.approx(0.004, rel=0.15)
    made = float(np.mean((sd_s * V) ** 2))
    assert found.share == pytest.approx(made / (made + 0.004**2), rel=0.1)


@pytest.mark.parametrize("seed", range(40))
def test_noise_of_other_kinds_is_none(seed: int) -> None:
    """White noise, noise with long tails, and noise that grows with the reading."""
    rng = np.random.default_rng(seed)
    assert told(rng.standard_normal(X.size)) is None
    assert told(rng.standard_t(4.0, X.size)) is None
    assert told((0.2 + X - X.min()) * rng.standard_normal(X.size)) is None


def test_a_detail_and_whole_readings_are_none() -> None:
    """Known truth: times that make a fifth of what is left, and times of five readings."""
    rng = np.random.default_rng(3)
    random = rng.standard_normal(X.size)
    speed = float(np.sqrt(np.mean(V**2)))
    assert told(V * 2e-3 * random + 4e-3 * speed * rng.standard_normal(X.size)) is None
    assert told(V * 5.0 * PERIOD_S * random) is None
    assert told(np.zeros(X.size)) is None


def test_a_motion_of_one_speed_tells_nothing() -> None:
    """A ramp, and no motion at all: there is no other speed to hold the noise against."""
    residual = np.random.default_rng(4).standard_normal(X.size)
    for speed in (0.0, 2.0):
        part = ResidualContext(TIME_S, speed * TIME_S, np.full(X.size, speed), X, residual, True)
        assert uncertain_times([part], PERIOD_S) is None


def recorded(name: str, seed: int, *, jitter_s: float) -> Log:
    """An oscillator in a chirp, read at times that are off their stamps."""
    rng = np.random.default_rng((seed, len(name)))
    fine_s = np.arange(TIME_S.size * 10) * PERIOD_S / 10.0
    chirp = 40.0 - 30.0 * np.cos(2.0 * np.pi * (0.1 * fine_s + 0.02 * fine_s**2))
    angle = linear_angle(fine_s, chirp, {"M": 1.3, "N": 16.0, "Q": 170.0})
    read_s = TIME_S + jitter_s * rng.standard_normal(TIME_S.size)
    readings = np.interp(read_s, fine_s, angle) + 1e-3 * rng.standard_normal(TIME_S.size)
    return Log.from_arrays(TIME_S, {"pressure": chirp[::10], "angle": readings}, name=name)


def test_the_report_says_how_far_the_times_are_off() -> None:
    """Known truth: nothing is missing, but readings are 5 ms off; told beside "adequate"."""
    train, judge = (recorded(name, 1, jitter_s=5e-3) for name in ("train", "hold-out"))
    found = diagnose(train, hold_out=[judge], model="oscillator")
    assert found.verdict is Verdict.ADEQUATE
    (issue,) = (issue for issue in found.issues if issue.code == UNCERTAIN_TIMES)
    assert "grows with the speed, from 0.00" in issue.message
    assert any(f"{ms} ms rms off their time stamps" in issue.message for ms in ("4.9", "5", "5.1"))
    assert issue.message[1:] in found.summary
    assert found.next_experiment == issue.remedy


def test_the_report_is_silent_where_the_times_are_right() -> None:
    """Known truth: the same log without the jitter."""
    train, judge = (recorded(name, 1, jitter_s=0.0) for name in ("train", "hold-out"))
    found = diagnose(train, hold_out=[judge], model="oscillator")
    assert found.verdict is Verdict.ADEQUATE
    assert not [issue for issue in found.issues if issue.code == UNCERTAIN_TIMES]
