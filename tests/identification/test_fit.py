"""The whole road from a log to a result, on logs whose truth is known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import lmfit
import numpy as np
import pytest
from linear_motion import linear_log

from softid.errors import IdentificationError, InputError, UsageError
from softid.fitters import beginnings, output_error, rivals, scouting
from softid.identification import fit
from softid.log import Log
from softid.models import Muscle
from softid.readers import load
from softid.records import load_params, save_fit
from softid.simulation import simulate
from softid.synthesis import bundled_datasets, muscle_log, random_muscle_truth, read_manifest
from softid.synthesis.waveforms import Sine, Steps

DATA = bundled_datasets() / "data"
LEVELS_KPA = (0.0, 60.0, 120.0, 180.0, 240.0, 300.0, 210.0, 150.0, 90.0, 30.0, 0.0)


def pair(truth: dict[str, float], seed: int) -> list[Log]:
    """Steps up and down and four cycles of a 0.5 Hz sine, 0.3 mm and 0.2 kPa of white noise."""
    waves = (Steps(LEVELS_KPA, 2.0), Sine(0.0, 240.0, 0.5, 4))
    return [
        muscle_log(truth, wave, seed=100 * seed + k, name=f"log{k}").to_log()
        for k, wave in enumerate(waves)
    ]


def test_steps_and_a_sine_give_all_seven_parameters() -> None:
    """The bundled logs by an integrator of their own; every truth within 1.5 half-widths.

    One draw of the noise may leave a truth outside its 95 % interval (M lies 2 σ off here); the
    coverage over many draws is the slow test below.
    """
    (truth,) = {
        tuple(sorted(k.truth.items()))
        for k in read_manifest(bundled_datasets())
        if k.group == "muscle"
    }
    result = fit(
        [load(DATA / "muscle_steps.csv"), load(DATA / "muscle_sine_050.csv")],
        model="muscle",
        hold_out=[load(DATA / "muscle_sine_025.csv")],
    )
    assert result.success
    for name, value in truth:
        p = result.parameter(name)
        assert p.verdict == "identified"
        assert p.ci95 is not None
        middle, half = 0.5 * (p.ci95[0] + p.ci95[1]), 0.5 * (p.ci95[1] - p.ci95[0])
        assert abs(value - middle) < 1.5 * half, name


def test_all_that_the_pair_recorded_gives_every_truth_within_its_interval() -> None:
    """Contraction and distance carry independent noise: fitted together, the truths that one of
    them leaves by up to a tenth of a half-width all lie in shorter 95 % intervals.
    """
    names = ("muscle_steps", "muscle_sine_050", "muscle_sine_025")
    steps, sine, held = (
        load(DATA / f"{name}.csv", outputs=("contraction", "distance")) for name in names
    )
    model = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
    result = fit([steps, sine], model=model, hold_out=held)
    one = fit([load(DATA / f"{name}.csv") for name in names[:2]], model="muscle")
    truth = next(k.truth for k in read_manifest(bundled_datasets()) if k.group == "muscle")
    for p in result.parameters:
        assert p.ci95 is not None
        assert p.ci95[0] <= truth[p.name] <= p.ci95[1], p.name
        alone = one.parameter(p.name).stderr
        assert p.stderr is not None
        assert alone is not None
        assert p.stderr < 0.8 * alone
    assert all(row.rmse < 1.05 * 0.3 for row in result.statistics if not row.in_sample)


def test_the_held_out_sine_is_followed_down_to_the_noise() -> None:
    """0.25 Hz held out: the camera's noise is 0.3 mm, and 5 % more is all that the model adds."""
    result = fit(
        [load(DATA / "muscle_steps.csv"), load(DATA / "muscle_sine_050.csv")],
        model="muscle",
        hold_out=[load(DATA / "muscle_sine_025.csv")],
    )
    (row,) = [s for s in result.statistics if not s.in_sample]
    assert row.rmse < 1.05 * 0.3


def test_computed_quantities_have_errors_where_the_logs_determine_them() -> None:
    """x_max is 1/a1, whose error is that of a1 over a1²; of logs below the midpoint nothing is said
    of it, while the time constant, a ratio, is known all the same."""
    both = [load(DATA / "muscle_steps.csv"), load(DATA / "muscle_sine_050.csv")]
    result = fit(both, model="muscle")
    a1 = result.parameter("a1")
    assert a1.stderr is not None
    assert result.derived_stderr["x_max"] == pytest.approx(a1.stderr / a1.value**2, rel=1e-6)
    truth = random_muscle_truth(np.random.default_rng(5))
    low = muscle_log(truth, Steps((0.0, 20.0, 40.0, 20.0, 0.0), 2.0), seed=5).to_log()
    poor = fit(low, model="muscle")
    error = poor.derived_stderr["x_max"]
    assert error is not None
    assert error > poor.derived["x_max"][0]
    (tau,) = [name for name in poor.derived if name.startswith("time_constant")]
    known = poor.derived_stderr[tau]
    assert known is not None
    assert known < 0.2 * poor.derived[tau][0]


@pytest.mark.slow
def test_intervals_cover_the_truth() -> None:
    """60 muscles and noises; 95 % of 60 is 57, and 52 is four standard deviations below it."""
    inside: dict[str, int] = {}
    for seed in range(60):
        truth = random_muscle_truth(np.random.default_rng(9000 + seed))
        result = fit(pair(truth, seed), model="muscle")
        for p in result.parameters:
            assert p.ci95 is not None
            inside[p.name] = inside.get(p.name, 0) + (p.ci95[0] <= truth[p.name] <= p.ci95[1])
    assert min(inside.values()) >= 52, inside


def test_a_fit_that_stops_at_once_is_no_success(monkeypatch: pytest.MonkeyPatch) -> None:
    """With one evaluation per run the optimiser cannot move: the result must not claim it did."""
    for name in ("SCOUT_EVALUATIONS", "POLISH_EVALUATIONS", "DRAFT_EVALUATIONS"):
        monkeypatch.setattr(output_error, name, 1)
    monkeypatch.setattr(scouting, "SCOUT_EVALUATIONS", 1)
    for name in ("SCOUT_EVALUATIONS", "SORTING_EVALUATIONS"):
        monkeypatch.setattr(rivals, name, 1)
    for name in ("SCOUT_EVALUATIONS", "DRAFT_EVALUATIONS"):
        monkeypatch.setattr(beginnings, name, 1)
    result = fit(load(DATA / "demo_step.csv"), model="muscle")
    assert not result.success
    assert result.issues[0].code == "not-converged"


def test_lmfit_parameters_at_the_face() -> None:
    """Fixed, bounded and tied as lmfit users know it."""
    log = load(DATA / "demo_step.csv")
    wishes = lmfit.Parameters()
    wishes.add("b1", value=2.8, vary=False)
    wishes.add("M", value=0.1, min=0.05, max=0.2)
    wishes.add("c2", value=7.0)
    wishes.add("a2", expr="0.017 * c2")
    result = fit(log, model="muscle", parameters=wishes)
    assert result.success
    assert result.parameter("b1").verdict == "fixed"
    assert result.parameter("b1").value == 2.8
    assert 0.05 < result.parameter("M").value < 0.2
    assert result.parameter("a2").verdict == "tied"
    assert result.values["a2"] == pytest.approx(0.017 * result.values["c2"], rel=1e-12)


def test_an_unknown_parameter_is_refused() -> None:
    wishes = lmfit.Parameters()
    wishes.add("stiffness", value=1.0)
    with pytest.raises(UsageError, match="stiffness"):
        fit(load(DATA / "demo_step.csv"), model="muscle", parameters=wishes)


def test_a_tie_to_nothing_is_refused_in_a_sentence() -> None:
    """lmfit itself would raise a NameError from deep inside."""
    parameters = Muscle(x_unit="rad").parameters()
    tied = parameters.replacing(replace(parameters["a2"], tie="0.1 * nonsense"))
    with pytest.raises(UsageError, match="nonsense"):
        fit(load(DATA / "demo_step.csv"), model="muscle", parameters=tied)


def test_parameters_need_a_model() -> None:
    with pytest.raises(UsageError, match="no meaning before the model is chosen"):
        fit(load(DATA / "demo_step.csv"), parameters=lmfit.Parameters())


def test_constant_pressure_identifies_nothing() -> None:
    time = np.arange(0.0, 5.0, 0.01)
    log = Log.from_arrays(time, {"pressure": np.full(500, 50.0), "angle": np.sin(time)}, name="c")
    with pytest.raises(InputError, match="pressure is constant"):
        fit(log)


def test_fewer_samples_than_unknowns_are_refused() -> None:
    time = np.arange(6.0)
    log = Log.from_arrays(time, {"pressure": 10 * time, "angle": time**2}, name="few")
    said = "6 samples cannot tell the 10 unknowns of the muscle model; record longer, fix param"
    with pytest.raises(IdentificationError, match=said):
        fit(log, model="muscle")


def test_too_few_samples_for_the_model_that_softid_chose() -> None:
    """The user named no model, so that another one is not the first remedy."""
    log = Log.from_arrays([0.0, 0.1], {"pressure": [0.0, 10.0], "angle": [0.0, 1.0]}, name="two")
    said = r"2 samples cannot tell the \d unknowns of the oscillator model; record longer, or name"
    with pytest.raises(IdentificationError, match=said):
        fit(log)


def test_a_slow_sine_alone_does_not_know_the_damping_by_pressure() -> None:
    """From one 0.5 Hz sine a2 is known to ±394 % (figures of the identifiability study)."""
    truth = random_muscle_truth(np.random.default_rng(5))
    log = muscle_log(truth, Sine(0.0, 240.0, 0.5, 6), seed=5).to_log()
    result = fit(log, model="muscle")
    p = result.parameter("a2")
    assert p.verdict != "identified"
    assert p.remedy.startswith("record ")


def test_distance_and_contraction_together() -> None:
    """Two outputs linked by the arc: the truth from both at once."""
    geometry = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
    log = load(DATA / "muscle_steps.csv", outputs=("contraction", "distance"))
    result = fit(log, model=geometry)
    assert result.success
    assert {row.channel for row in result.statistics} == {"contraction", "distance"}
    assert 1.0 / result.values["a1"] == pytest.approx(69.93, abs=0.1)


def test_every_log_has_its_own_zero() -> None:
    """The same muscle recorded twice with zeros 7 mm apart: one set of parameters, two zeros."""
    truth = random_muscle_truth(np.random.default_rng(2))
    steps = Steps((0.0, 100.0, 200.0, 280.0, 120.0, 0.0), 1.5)
    first = muscle_log(truth, steps, seed=1, name="first").to_log()
    second = muscle_log(truth, steps, seed=2, name="second").to_log()
    moved = Log.from_arrays(
        second.time_s,
        {
            "pressure": second.pressure_kpa,
            "contraction": second.channels["contraction"].values + 7.0,
        },
        outputs=("contraction",),
        name="second",
    )
    result = fit([first, moved], model="muscle")
    zeros = {n.log: n.zero["contraction"] for n in result.nuisances}
    assert zeros["second"] - zeros["first"] == pytest.approx(7.0, abs=0.1)


def test_a_log_cannot_be_fitted_and_held_out(tmp_path: Path) -> None:
    again = tmp_path / "again.csv"
    again.write_bytes((DATA / "demo_step.csv").read_bytes())
    with pytest.raises(UsageError, match="the same samples as demo_step"):
        fit(load(DATA / "demo_step.csv"), model="muscle", hold_out=[load(again)])
    with pytest.raises(UsageError, match="the same samples as demo_step, which is fitted; give"):
        fit([load(DATA / "demo_step.csv"), load(again)], model="muscle")


def test_a_dead_output_is_not_held_out() -> None:
    """It would judge every model alike, and a diagnosis by it would drop what is right."""
    log = load(DATA / "demo_step.csv")
    channels = {"pressure": log.channels["pressure"].values, "angle": np.full(len(log), 0.2)}
    dead = Log.from_arrays(log.time_s, channels, name="dead")
    with pytest.raises(InputError, match="angle never changes although the input does"):
        fit(log, model="muscle", hold_out=dead)


@pytest.mark.slow
def test_a_held_out_log_without_motion_is_told_from_one_badly_followed() -> None:
    """Held at one pressure the output is the sensor's noise: a fit of 0 % is no fault of the model.

    The fitted log has a slow wave of 2 mm that no pressure explains, far more than 0.3 mm of noise.
    """
    moving = pair(random_muscle_truth(np.random.default_rng(3)), 3)[0]
    y = moving.channels["contraction"].values + 2.0 * np.sin(3.0 * moving.time_s)
    noise = 0.3 * np.random.default_rng(0).standard_normal(moving.time_s.size)
    pressure = moving.channels["pressure"].values
    fitted, still = (
        Log.from_arrays(
            moving.time_s, {"pressure": p, "contraction": x}, outputs=("contraction",), name=name
        )
        for name, p, x in (("fitted", pressure, y), ("still", 0.0 * pressure + 100.0, noise))
    )
    found = {i.code: i.message for i in fit(fitted, model="muscle", hold_out=still).issues}
    assert "still (held out): contraction moves by only 0.3" in found["nothing-to-score"]
    assert "poor-fit" not in found


def test_a_growing_length_is_fitted_like_the_position_it_is(tmp_path: Path) -> None:
    """L = L0 + x has the parameters of x itself: the same samples under two names, to 1e-6.

    The sign is saved with the options, so a reloaded model follows the log as well.
    """
    (log,) = pair(random_muscle_truth(np.random.default_rng(5)), 5)[:1]
    x = log.channels["contraction"].values
    named = {
        name: Log.from_arrays(log.time_s, {"pressure": log.pressure_kpa, name: x + offset})
        for name, offset in (("position", 0.0), ("length", 100.0))
    }
    grown, moved = (fit(named[name], model="muscle") for name in ("length", "position"))
    assert grown.model.options["inverted"] is True
    for name, value in moved.values.items():
        assert grown.values[name] == pytest.approx(value, rel=1e-6), name
    save_fit(grown, tmp_path / "params.json")
    back = load_params(tmp_path / "params.json")
    found = simulate(
        back.build_model(),
        back.values,
        named["length"],
        nuisance=next(iter(back.nuisances.values())),
    )
    left = found.outputs["length"] - named["length"].channels["length"].values
    assert np.std(left) < 0.1 * np.std(x)


def test_a_remedy_names_the_argument_beside_the_option() -> None:
    """Who calls the library has no command line."""
    log = linear_log()
    with pytest.raises(UsageError, match=r"--model \(model= in Python\)"):
        fit(log, parameters=lmfit.Parameters())
    still = np.full(len(log), 20.0)
    constant = Log.from_arrays(log.time_s, {"pressure": still, "position": log.time_s})
    with pytest.raises(InputError, match=r"--input \(input= in Python\)"):
        fit(constant, model="oscillator")
    with pytest.raises(UsageError, match=r"fixed_length_mm= and diameter_mm= in Python"):
        Muscle(fixed_length_mm=150.0)
