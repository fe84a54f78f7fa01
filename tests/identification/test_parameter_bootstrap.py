"""Bootstrap of a fit: agrees with the covariance where that is right, whoever does the refits."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import RATE_HZ, linear_angle
from noise import ar1

from softid.errors import UsageError
from softid.identification import bootstrap_parameters, fit, profile_parameter
from softid.intersample import HELD
from softid.log import Log

Array = npt.NDArray[np.float64]

N, NOISE = 1500, 0.01
TIME_S = np.arange(N) / RATE_HZ


def steps(seed: int) -> Array:
    levels = np.random.default_rng(seed).uniform(10.0, 100.0, N // 50)
    return np.concatenate((np.zeros(50), np.repeat(levels, 50)[: N - 50]))


def log_of(pressure: Array, angle: Array, *, memory: float = 0.0, seed: int = 1) -> Log:
    """With noise that remembers: its correlation from sample to sample is ``memory``."""
    noise = NOISE * ar1(np.random.default_rng(seed), N, memory)
    channels = {"pressure": pressure, "angle": angle + noise}
    return Log.from_arrays(TIME_S, channels, name=f"log-{seed}")


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_errors_are_those_of_the_covariance(memory: float) -> None:
    """A nearly linear problem: to 20 % with 300 draws, also where the noise has a memory, which
    makes the error of the stiffness three times that of white noise."""
    pressure = steps(3)
    log = log_of(pressure, linear_angle(TIME_S, pressure), memory=memory)
    result = fit(log, model="oscillator")
    found = bootstrap_parameters(result, log, draws=300)
    assert found.names == ("M", "N", "Q")
    assert found.failed == 0
    assert found.estimates.shape == (300, 3)
    assert (found.block > 1) == (memory > 0.0)
    for name in ("N", "Q"):
        estimate = result.parameter(name)
        assert estimate.stderr is not None
        assert found.stderr[name] == pytest.approx(estimate.stderr, rel=0.2)
        low, high = found.ci95[name]
        assert low < estimate.value < high
        assert high - low == pytest.approx(3.92 * found.stderr[name], rel=0.15)


def test_draws_do_not_depend_on_who_makes_them() -> None:
    pressure = steps(3)
    log = log_of(pressure, linear_angle(TIME_S, pressure))
    result = fit(log, model="oscillator")
    alone, two = (bootstrap_parameters(result, log, draws=20, workers=k) for k in (1, 2))
    np.testing.assert_array_equal(alone.estimates, two.estimates)


def test_several_logs_and_samples_that_are_missing() -> None:
    """Two logs, one of them with a gap in its output: the errors are those of all that is used."""
    pressures = [steps(3), steps(4)]
    angles = [linear_angle(TIME_S, pressure) for pressure in pressures]
    angles[0][300:500] = np.nan
    logs = [
        log_of(pressure, angle, seed=seed)
        for seed, (pressure, angle) in enumerate(zip(pressures, angles, strict=True))
    ]
    result = fit(logs, model="oscillator")
    found = bootstrap_parameters(result, logs, draws=200)
    stderr = result.parameter("Q").stderr
    assert stderr is not None
    assert found.failed == 0
    assert found.stderr["Q"] == pytest.approx(stderr, rel=0.25)


def test_a_held_input_stays_held() -> None:
    """The fit found that its input is held at every sample: refits, and a profile, take it so.

    Taken as straight lines the response comes half an interval late, and N with it.
    """
    pressure, fine = steps(3), 20
    pressure += 3.0 * np.random.default_rng(5).standard_normal(N)
    fine_s = np.arange(N * fine) / (fine * RATE_HZ)
    angle = linear_angle(fine_s, np.repeat(pressure, fine) - pressure[0])[::fine]
    log = log_of(pressure, angle)
    result = fit(log, model="oscillator")
    assert result.intersample in HELD
    value = result.parameter("N").value
    low, high = bootstrap_parameters(result, log, draws=100).ci95["N"]
    assert low < value < high
    profile = profile_parameter(result, log, "N")
    assert profile.better_value is None
    assert profile.ci95[0] is not None
    assert profile.ci95[1] is not None
    assert profile.ci95[0] < value < profile.ci95[1]


def test_what_cannot_be_drawn_is_refused() -> None:
    pressure = steps(3)
    log = log_of(pressure, linear_angle(TIME_S, pressure))
    result = fit(log, model="oscillator")
    with pytest.raises(UsageError, match="more bootstrap draws"):
        bootstrap_parameters(result, log, draws=5)
    for draws in (50.5, "50", None):
        with pytest.raises(UsageError, match="draws: this is not a whole number"):
            bootstrap_parameters(result, log, draws=draws)  # type: ignore[arg-type]
    for workers in (0, -1, 1.5):
        with pytest.raises(UsageError, match="workers: this is not a whole number from 1 on"):
            bootstrap_parameters(result, log, draws=20, workers=workers)  # type: ignore[arg-type]
