"""Noise of the recorded input counts neither as information nor as motion."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import RATE_HZ, linear_angle
from scipy.signal import sawtooth

from softid import FitResult, Log, fit
from softid.identification.errors_in_variables import with_input_errors
from softid.identification.input_errors import NO_INPUT_ERRORS, InputErrors
from softid.identification.parameter_covariance import errors_of
from softid.identification.workflow import identify

Array = npt.NDArray[np.float64]

TRUTH = {"M": 1.3, "N": 6.4, "Q": 170.0}
TIME_S = np.arange(40 * RATE_HZ) / RATE_HZ
SLOW_SINE = 40.0 - 40.0 * np.cos(2.0 * np.pi * 0.1 * TIME_S)
TRIANGLE = 40.0 + 40.0 * sawtooth(2.0 * np.pi * 0.1 * TIME_S, 0.5)
SQUARE = np.where(TIME_S % 8.0 < 4.0, 0.0, 80.0)
DRAWS = 12
MOST_MISSED = 2
"""Of twelve intervals of 95 % more than two miss in one of 50 tests."""


def noisy_log(pressure: Array, seed: int, *, noise: float = 0.5, is_ripple: bool = False) -> Log:
    """A motion that rings at 1.8 Hz, and a gauge whose noise is that of the pressure or its own."""
    rng = np.random.default_rng(seed)
    shaking = noise * rng.standard_normal(TIME_S.size)
    angle = linear_angle(TIME_S, pressure + is_ripple * shaking, TRUTH)
    angle += 0.005 * rng.standard_normal(TIME_S.size)
    return Log.from_arrays(TIME_S, {"pressure": pressure + shaking, "angle": angle})


def fits_of(pressure: Array) -> list[FitResult]:
    """Fits of a few draws of `noisy_log`."""
    logs = (noisy_log(pressure, seed) for seed in range(200, 200 + DRAWS))
    return [fit(log, model="oscillator") for log in logs]


def missed(fits: list[FitResult], name: str) -> int:
    """How many intervals do not hold the truth; one that has no limits does."""
    intervals = [found.parameter(name).ci95 for found in fits]
    return sum(ci is not None and not ci[0] <= TRUTH[name] <= ci[1] for ci in intervals)


def growth(log: Log, name: str) -> float:
    """Factor by which the error of a parameter is wider for the noise."""
    identified = identify(log, model="oscillator")
    problem, optimum = identified.found.problem, identified.found.optimum
    told = errors_of(problem, optimum).covariance
    assert told is not None
    errors = InputErrors.as_recorded(identified.logs)
    allowing = with_input_errors(told, problem, optimum, errors)
    row = told.names.index(name)
    return float(np.sqrt(allowing.matrix[row, row] / told.matrix[row, row]))


def test_a_damping_that_calms_the_noise_is_as_unsure_as_that_makes_it() -> None:
    """Known truth: a slow triangle tells little of the damping, and the fit takes more of it for
    the simulation to tremble less: the residuals alone put it two standard errors off."""
    fits = fits_of(TRIANGLE)
    assert all(missed(fits, name) <= MOST_MISSED for name in TRUTH)
    too_sure = [found.parameter("N").value > 1.1 * TRUTH["N"] for found in fits]
    told = [issue.message for issue in fits[0].issues if issue.code == "noisy-input"]
    assert any(too_sure)
    assert "the noise of pressure, 0.49 kPa" in told[0]
    assert "N" in told[0].split("tells on")[1]


def test_an_inertia_of_which_only_noise_tells_is_not_identified() -> None:
    """Known truth: a slow sine follows Q − Mω² and knows neither apart; what the simulation does
    with the noise seemed to tell M to 5 %, and it was three times too large."""
    fits = fits_of(SLOW_SINE)
    assert {found.parameter("M").verdict for found in fits} == {"not identified"}
    assert missed(fits, "Q") <= MOST_MISSED
    kept = [found for found in fits if "M" in found.free]
    assert any("Q can make up for it" in found.parameter("M").reason for found in kept)


def test_a_ripple_that_the_actuator_follows_tells_what_it_does() -> None:
    """The same size is a ripple of the pressure in one log and noise of the gauge in the other."""
    assert growth(noisy_log(TRIANGLE, 1, noise=1.5, is_ripple=True), "N") == 1.0
    assert growth(noisy_log(TRIANGLE, 1, noise=1.5), "N") > 1.5


def test_steps_tell_so_much_that_noise_is_nothing_beside_it() -> None:
    """Edges move the actuator farther than the noise moves the simulation."""
    assert growth(noisy_log(SQUARE, 1), "M") < 1.05


def test_the_error_grows_as_least_squares_with_exact_pressure_has_it() -> None:
    """Against fits of the same angles to the pressure that was there: how far noise moves the
    damping on the average, and how much wider that error is, come from no formula of ours."""
    moves, allowed = [], []
    for seed in range(DRAWS):
        log = noisy_log(TRIANGLE, seed)
        channels = {"pressure": TRIANGLE, "angle": log.channels["angle"].values}
        exact = fit(Log.from_arrays(TIME_S, channels), model="oscillator").parameter("N")
        found = fit(log, model="oscillator").parameter("N")
        assert found.stderr is not None
        moves.append(np.log(found.value / exact.value))
        allowed.append(found.stderr / found.value)
    assert np.mean(moves) > 0.05
    assert 0.7 * np.mean(moves) < np.mean(allowed) < 2.0 * np.mean(moves)


def test_an_input_without_noise_leaves_the_covariance_as_it_is() -> None:
    """The same object, for nothing was simulated."""
    log = noisy_log(SQUARE, 1, noise=0.0)
    identified = identify(log, model="oscillator")
    problem, optimum = identified.found.problem, identified.found.optimum
    told = errors_of(problem, optimum).covariance
    assert told is not None
    for errors in (InputErrors.as_recorded(identified.logs), NO_INPUT_ERRORS):
        assert with_input_errors(told, problem, optimum, errors) is told


@pytest.mark.parametrize("seed", [1, 2])
def test_no_variance_becomes_less_and_the_matrix_stays_one(seed: int) -> None:
    """A covariance of coloured residuals is none of JᵀJ alone."""
    identified = identify(noisy_log(SLOW_SINE, seed), model="oscillator")
    problem, optimum = identified.found.problem, identified.found.optimum
    told = errors_of(problem, optimum).covariance
    assert told is not None
    errors = InputErrors.as_recorded(identified.logs)
    allowing = with_input_errors(told, problem, optimum, errors)
    assert (np.diag(allowing.matrix) >= np.diag(told.matrix) * (1.0 - 1e-9)).all()
    scale = np.sqrt(np.diag(allowing.matrix))
    assert np.linalg.eigvalsh(allowing.matrix / np.outer(scale, scale)).min() > -1e-9
    assert allowing.sd == pytest.approx(scale)
