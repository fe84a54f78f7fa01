"""A fit simulated from Python, by the rules of `softid simulate`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from handmade import MUSCLE_VALUES, fit_result, step_log
from linear_motion import linear_log

import softid
from softid.identification import fit
from softid.log import Log
from softid.models.muscle import Muscle
from softid.prediction import simulate
from softid.records import SavedModel, load_params, save_fit
from softid.results import FitResult, LogNuisance, Simulation
from softid.simulation import simulate as simulate_as_it_is

ZERO_RAD = 0.1 / 3  # the hand-made sensor zero of both logs


def slow_gauge(samples: int = 500) -> Log:
    """A sine of 0.5 Hz, in rows of 50 Hz from a gauge of 10 Hz, and nothing measured."""
    time_s = np.arange(samples) / 50.0
    read_s = time_s[np.arange(samples) // 5 * 5]
    pressure = 40.0 + 39.0 * np.sin(np.pi * read_s)
    nothing = np.full(samples, np.nan)
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": nothing}, name="slow")


@pytest.fixture(scope="module")
def fitted() -> FitResult:
    return fit(linear_log(noise=0.01), model="oscillator")


def test_a_model_with_values_takes_the_log_as_it_is() -> None:
    """The staircase of a slow gauge stays one, and no sensor zero is added."""
    log = slow_gauge()
    as_it_is = simulate(Muscle(damping="constant"), MUSCLE_VALUES, log)
    as_fitted = simulate(fit_result(), log)
    assert as_it_is.issues == ()
    assert any("repeats each value" in issue.message for issue in as_fitted.issues)
    bare = simulate_as_it_is(Muscle(damping="constant"), MUSCLE_VALUES, log)
    np.testing.assert_array_equal(as_it_is.outputs["angle"], bare.outputs["angle"])
    apart = as_fitted.outputs["angle"] - as_it_is.outputs["angle"]
    assert apart.mean() == pytest.approx(ZERO_RAD, abs=0.1 * ZERO_RAD)
    assert np.ptp(apart) > ZERO_RAD


def test_a_fitted_log_gets_its_zero_and_start_back(fitted: FitResult, tmp_path: Path) -> None:
    """A log of arrays is known by its samples; from the file to 1e-12, as every number of it."""
    log = linear_log(noise=0.01)
    save_fit(fitted, tmp_path / "params.json")
    (own,) = fitted.simulations
    assert fitted.nuisances[0].zero["angle"] != 0.0
    for model in (fitted, load_params(tmp_path / "params.json")):
        found = simulate(model, log=log)
        np.testing.assert_allclose(found.outputs["angle"], own.outputs["angle"], rtol=1e-12)
    other = simulate(fitted, linear_log(noise=0.01, seed=1))
    mean = fitted.nuisances[0].zero["angle"]
    bare = simulate_as_it_is(
        SavedModel.of(fitted).build_model(),
        fitted.values,
        linear_log(noise=0.01, seed=1).with_intersample(fitted.intersample),
        nuisance=LogNuisance("log", {"angle": mean}, {"angle": None}, ()),
    )
    np.testing.assert_array_equal(other.outputs["angle"], bare.outputs["angle"])


def test_a_zero_that_is_given_replaces_the_mean(fitted: FitResult) -> None:
    """It is added to the output, so two zeros differ by their difference."""

    def with_zero(zero: float) -> Simulation:
        own = LogNuisance("log", {"angle": zero}, {"angle": None}, ())
        return simulate(fitted, linear_log(seed=1), nuisance=own)

    apart = with_zero(2.5).outputs["angle"] - with_zero(0.5).outputs["angle"]
    np.testing.assert_allclose(apart, 2.0, rtol=1e-9)


def test_beyond_the_fitted_range_is_an_issue() -> None:
    """The fit ended at 80 kPa."""
    far = Log.from_arrays([0.0, 0.1, 0.2], {"pressure": [0.0, 100.0, 200.0], "angle": [0.0] * 3})
    codes = [issue.code for issue in simulate(fit_result(), far).issues]
    assert codes == ["extrapolation"]
    assert simulate(fit_result(), step_log()).issues == ()


def test_another_driving_channel_is_refused() -> None:
    """A command is not the pressure that the model was fitted to."""
    log = Log.from_arrays(
        [0.0, 0.1], {"pressure_command": [0.0, 1.0], "angle": [0.0, 0.0]}, input="pressure_command"
    )
    with pytest.raises(softid.UsageError, match=r"pressure drives the model.*input='pressure'"):
        simulate(fit_result(), log)


def test_what_is_no_table_of_values_is_refused() -> None:
    """A model needs values; a fit has them."""
    with pytest.raises(softid.UsageError, match=r"Log.*name → value.*fit"):
        simulate(Muscle(), step_log())  # type: ignore[call-overload]
    with pytest.raises(softid.UsageError, match="not a log"):
        simulate(fit_result())  # type: ignore[call-overload]


def test_a_fit_is_what_its_file_says(fitted: FitResult, tmp_path: Path) -> None:
    """Field by field, but for the name of the file."""
    save_fit(fitted, tmp_path / "params.json")
    saved = load_params(tmp_path / "params.json")
    assert vars(replace(SavedModel.of(fitted), path=saved.path)) == vars(saved)
