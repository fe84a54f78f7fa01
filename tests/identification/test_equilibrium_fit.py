"""Fits of the equilibrium model: recovery, coverage, choice, cautions, and what ignoring costs.

The logs come from the generator's own law; its truth is C_d = 4.5e-4, (a, b, c) = (0.2, −0.3, 1.3).
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from softid.identification import fit
from softid.log import Log
from softid.models import Equilibrium
from softid.models.actuator_geometry import Actuator
from softid.readers import load
from softid.records import load_params, save_fit
from softid.results import FitResult
from softid.simulation import simulate
from softid.synthesis import SyntheticLog, bundled_datasets, load_recipe, synthesize
from softid.synthesis.waveforms import Sequence

FOLDER = bundled_datasets()
TRUTH = {"C_d": 4.5e-4, "a": 0.2, "b": -0.3, "c": 1.3, "stiffness": 1.0}
ANGLE_NOISE_RAD, PRESSURE_NOISE_KPA = np.deg2rad(0.2), 0.02
DRAWS = 100


@cache
def clean(level_kpa: float, drift: bool = False) -> SyntheticLog:
    """A bundled recipe at another level."""
    recipe = load_recipe(FOLDER / "recipes" / f"equilibrium_20{'_drift' if drift else ''}.toml")
    assert isinstance(recipe.excitation, Sequence)
    rest, hold = recipe.excitation.parts
    parts = (rest, replace(hold, level_kpa=level_kpa))  # type: ignore[type-var]
    name = f"step_{'minus_' if level_kpa < 0 else ''}{abs(level_kpa):.0f}"
    return synthesize(replace(recipe, name=name, excitation=Sequence(parts)))


def drawn(
    level_kpa: float, rng: np.random.Generator, *, drift: bool = False, ideal: bool = False
) -> Log:
    """The true response with fresh noise; ``ideal`` takes the command for the pressure."""
    made = clean(level_kpa, drift)
    pressure = made.truth_columns["pressure_kpa"]
    if ideal:
        pressure = np.where(made.time_s < 0.5, 0.0, level_kpa)
    angle = np.deg2rad(made.truth_columns["angle_deg"])
    channels = {
        "pressure": pressure + PRESSURE_NOISE_KPA * rng.standard_normal(angle.size),
        "angle": angle + ANGLE_NOISE_RAD * rng.standard_normal(angle.size),
    }
    return Log.from_arrays(made.time_s, channels, name=made.name)


def covered(result: FitResult) -> dict[str, bool]:
    found = {}
    for name, truth in TRUTH.items():
        interval = result.parameter(name).ci95
        assert interval is not None
        found[name] = interval[0] <= truth <= interval[1]
    return found


def test_two_steps_of_other_level_and_sign() -> None:
    """20 and −10 kPa: every truth within four standard errors, a and b to about 5 %."""
    rng = np.random.default_rng(3)
    result = fit([drawn(20.0, rng), drawn(-10.0, rng)], model="equilibrium")
    assert result.success
    for name, truth in TRUTH.items():
        estimate = result.parameter(name)
        assert estimate.stderr is not None
        assert abs(estimate.value - truth) < 4.0 * estimate.stderr, name
        assert estimate.verdict == "identified"
    assert result.parameter("a").stderr == pytest.approx(0.052 * 0.2, rel=0.3)
    assert result.parameter("b").stderr == pytest.approx(0.043 * 0.3, rel=0.3)


@pytest.mark.slow
def test_coverage_of_the_intervals() -> None:
    """100 draws of two steps: nominal 95 %, so 88 of 100 or fewer has a chance of 0.5 %."""
    inside = dict.fromkeys(TRUTH, 0)
    for seed in range(DRAWS):
        rng = np.random.default_rng(9000 + seed)
        result = fit([drawn(20.0, rng), drawn(-10.0, rng)], model="equilibrium", seed=seed)
        assert result.success, seed
        for name, holds in covered(result).items():
            inside[name] += holds
    assert min(inside.values()) > 0.88 * DRAWS, inside


def test_drift_that_is_ignored_biases_and_modelled_does_not() -> None:
    """0.02 rad/s: golden a = 0.33 with the stiffness held, −0.19 with it free; 0.20 modelled."""
    log = drawn(20.0, np.random.default_rng(5), drift=True)
    base = Equilibrium().parameters()
    held = fit(log, model="equilibrium", parameters=base.with_fixed({"stiffness": 1.0}))
    modelled = fit(log, model=Equilibrium(drift="linear"))
    assert abs(held.values["a"] - 0.2) > 0.08
    assert abs(modelled.values["a"] - 0.2) < 0.05
    drift = modelled.parameter("drift")
    assert drift.stderr is not None
    assert abs(drift.value - 0.02) < 4.0 * drift.stderr


def test_a_lag_that_is_ignored_hides_in_the_mass() -> None:
    """30 ms taken as an ideal step: golden (a, b, c) = (2.7, −4.4, 2.9), and a good fit all the
    same; driven by the measured pressure the bias is gone."""
    rng = np.random.default_rng(6)
    wrong = fit(drawn(20.0, rng, ideal=True), model="equilibrium")
    right = fit(drawn(20.0, rng), model="equilibrium")
    assert wrong.values["a"] > 1.0
    assert wrong.values["b"] < -2.0
    assert wrong.values["c"] > 2.0
    assert wrong.statistics[0].fit_percent > 90.0
    assert abs(right.values["a"] - 0.2) < 0.05


def test_a_free_drive_leaves_only_ratios() -> None:
    """Scaling C_d, a, b, c, stiffness and drive together changes nothing: the verdicts say so."""
    rng = np.random.default_rng(7)
    result = fit([drawn(20.0, rng), drawn(-10.0, rng)], model=Equilibrium(driving="free"))
    verdicts = {p.name: p.verdict for p in result.parameters if not p.fixed}
    assert verdicts["drive"] == "not identified"
    assert verdicts["C_d"] == "not identified"
    assert verdicts["c"] == "not identified"
    ratio = result.values["C_d"] / result.values["drive"]
    assert ratio == pytest.approx(4.5e-4, rel=0.02)


def test_cautions_are_issues_of_the_fit() -> None:
    """One step alone, an assumed geometry: both are told with the fit."""
    result = fit(load(FOLDER / "data" / "equilibrium_20.csv"), model="equilibrium")
    codes = {issue.code for issue in result.issues}
    assert codes >= {"compensation-not-separated", "assumed-geometry", "ratios-only"}


def test_a_geometry_makes_it_the_choice_for_a_ringing_step() -> None:
    """With a geometry it comes first and no other gains 5 %; without one it is not tried."""
    log = load(FOLDER / "data" / "equilibrium_20.csv")
    given = Equilibrium.of(Actuator(assumed=""))
    chosen = fit(log, preferred=(given,))
    assert chosen.model.name == "equilibrium"
    assert chosen.choice is not None
    assert chosen.choice.startswith("equilibrium: error on blocks left out")
    assert fit(log).model.name != "equilibrium"


@pytest.mark.slow
def test_a_better_rival_beats_a_given_geometry() -> None:
    """An overdamped muscle's log: the geometry came first and still loses."""
    log = load(FOLDER / "data" / "demo_step.csv")
    chosen = fit(log, preferred=(Equilibrium.of(Actuator(assumed="")),))
    assert chosen.model.name == "muscle"


def test_the_file_alone_simulates(tmp_path) -> None:
    """params.json holds the geometry: read back it gives the same numbers to 1e-12."""
    log = load(FOLDER / "data" / "equilibrium_20_drift.csv")
    model = Equilibrium.of(Actuator(assumed="rib_m"), drift="linear")
    result = fit(log, model=model)
    save_fit(result, tmp_path / "params.json")
    saved = load_params(tmp_path / "params.json")
    assert saved.build_model() == model
    again = simulate(saved.build_model(), saved.values, log, nuisance=saved.nuisance_for(log))
    there = result.simulations[0].outputs["angle"]
    np.testing.assert_allclose(again.outputs["angle"], there, rtol=1e-12, atol=1e-13)
