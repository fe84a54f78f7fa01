"""Rivals of an optimum: found where the residual has structure, not sought in white noise."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import softid.fitters.output_error as fitter
import softid.fitters.rivals as rivals
from softid.fitters.levenberg_marquardt import Minimum
from softid.fitters.objective import SCOUT_EVALUATIONS, Objective
from softid.fitters.output_error import Optimum, output_error
from softid.fitters.problem import Problem
from softid.fitters.rivals import best_rival, has_structure, residual_oscillates
from softid.log import Log
from softid.models.muscle import Muscle
from softid.synthesis import muscle_log, random_muscle_truth
from softid.synthesis.waveforms import Sine, Steps

LEVELS = (0.0, 60.0, 120.0, 180.0, 240.0, 300.0, 210.0, 150.0, 90.0, 30.0, 0.0)
RINGING = {
    "M": 0.008,
    "a1": 0.0047,
    "b1": 3.58,
    "c1": 0.022,
    "a2": 1.5e-5,
    "b2": 2.9,
    "c2": 0.018,
}
"""Natural frequency 0.26 Hz without pressure and 25 Hz at 300 kPa, damping ratio 0.69 and 0.01."""


SWINGING = {
    "M": 0.0111,
    "a1": 0.003421,
    "b1": 3.786,
    "c1": 0.02221,
    "a2": 8.705e-06,
    "b2": 2.837,
    "c2": 0.01545,
}
"""Much like it, and its starts end a hundred times above the noise."""

UNSTABLE = {
    "M": 1.104,
    "a1": 0.003879,
    "b1": 3.723,
    "c1": 0.2292,
    "a2": 1.021,
    "b2": -1.242,
    "c2": 0.09983,
}
"""A sine swings its stiffness and so its motion up to a hundred times what steps reach."""


def problem(truth: Mapping[str, float] = RINGING) -> Problem:
    logs: list[Log] = []
    for k, excitation in enumerate((Steps(LEVELS, 2.0), Sine(0.0, 240.0, 0.5, 4))):
        made = muscle_log(truth, excitation, seed=k, name=f"log_{k}", noise_mm=1.0)
        logs.append(made.to_log())
    return Problem(Muscle(), Muscle().parameters(), logs)


def searched(problem: Problem, truth: Mapping[str, float] = RINGING) -> tuple[Optimum, float]:
    """The fit from data alone, and its cost over that of a start at the truth."""
    guesses = problem.model.guess(problem.segments, "contraction")
    found = output_error(problem, [g.values_dict() for g in guesses], rng=np.random.default_rng(0))
    known = Objective(problem, found.sigma).solve(problem.unknowns(truth), 400)
    return found, found.cost / known.normal.cost


def test_a_ringing_muscle_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """As good as a start at the truth; without rivals the cost is more than five times that."""
    whole = problem(SWINGING)
    found, ratio = searched(whole, SWINGING)
    assert found.status.success
    assert ratio == pytest.approx(1.0, abs=1e-4)

    def no_rival(
        problem: Problem, sigma: object, best: Minimum, *, thorough: bool
    ) -> tuple[npt.NDArray[np.float64], int]:
        del problem, sigma, thorough
        return best.point, 0

    monkeypatch.setattr(fitter, "best_rival", no_rival)
    assert searched(whole, SWINGING)[1] > 5.0


@pytest.mark.parametrize("enough", [500, pytest.param(1000, marks=pytest.mark.slow)])
def test_a_ringing_muscle_is_found_on_a_part_of_a_long_log(
    enough: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As good as a start at the truth over all samples, of which a rival saw a part.

    Other forms of damping may lead there, too, and are left out.
    """
    whole = problem(SWINGING)
    monkeypatch.setattr(Muscle, "alternatives", lambda self, values: ())
    assert whole.n_samples > 2 * enough
    monkeypatch.setattr(rivals, "SAMPLES_TO_SEARCH", enough)
    seen: list[int] = []
    through = rivals._ringing_rival

    def watched(problem: Problem, *others: Any) -> tuple[npt.NDArray[np.float64], int]:
        seen.append(problem.n_samples)
        return through(problem, *others)

    monkeypatch.setattr(rivals, "_ringing_rival", watched)
    found, ratio = searched(whole, SWINGING)
    assert found.status.success
    assert ratio == pytest.approx(1.0, abs=1e-4)
    assert seen
    assert enough <= max(seen) < whole.n_samples


def test_a_false_optimum_is_left_by_way_of_the_pieces() -> None:
    """As good as a start at the truth, where the first optimum costs nine hundred times that.

    Its pieces start anywhere in a motion a hundred times larger than the steps', and those of the
    false optimum lead to the true one.
    """
    found, ratio = searched(problem(UNSTABLE), UNSTABLE)
    assert found.status.success
    assert ratio == pytest.approx(1.0, abs=1e-4)


@pytest.mark.slow
def test_starts_that_have_met_go_on_as_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Starts with three shapes of damping meet over longer pieces: fewer simulations, same end."""
    whole = problem()
    objective = Objective(whole, {"contraction": 1.0})
    best = objective.solve(whole.unknowns(RINGING | {"M": 0.05}), 30)
    monkeypatch.setattr(rivals, "WORTH_PURSUING", 1e3)
    monkeypatch.setattr(rivals, "has_structure", lambda problem, z: True)  # no start is the last
    point, used = best_rival(whole, objective.sigma, best)
    assert point is not best.point
    monkeypatch.setattr(rivals, "SAME_COST", -1.0)
    alone, all_used = best_rival(whole, objective.sigma, best)
    assert used < 0.95 * all_used
    assert objective(point).cost == pytest.approx(objective(alone).cost, rel=1e-3)


def test_no_ringing_is_looked_for_in_white_noise() -> None:
    """At the optimum only the sensor's noise is left: the point itself, and no search that is long.

    Two other forms of damping take a scout's evaluations each; a search that shall not be thorough
    leaves them out.
    """
    whole = problem()
    objective = Objective(whole, {"contraction": 1.0})
    best = objective.solve(whole.unknowns(RINGING), 100)
    point, used = best_rival(whole, objective.sigma, best)
    assert point is best.point
    assert 0 < used <= 1 + 3 * (SCOUT_EVALUATIONS + 1)
    assert best_rival(whole, objective.sigma, best, thorough=False) == (best.point, 0)


def test_damping_of_another_form_is_found_behind_white_noise() -> None:
    """A draw of a usual muscle whose first optimum has damping that hardly grows with the pressure.

    Its residual is as white as that at the truth, and its cost higher by 7.5 times the variance of
    the noise, more than the 99 % quantile of χ² for one parameter.
    """
    seed, number = 50_000, 15
    truth = random_muscle_truth(np.random.default_rng(seed + number))
    made = [
        muscle_log(
            truth,
            excitation,
            seed=1000 * number + k,
            name=f"log_{k}",
            noise_mm=0.005 / truth["a1"],
        ).to_log()
        for k, excitation in enumerate((Steps(LEVELS, 2.0), Sine(0.0, 240.0, 0.5, 4)))
    ]
    found, ratio = searched(Problem(Muscle(), Muscle().parameters(), made), truth)
    assert found.status.success
    assert ratio == pytest.approx(1.0, abs=1e-5)


def test_structure_is_told_from_noise() -> None:
    """3.000 samples: white at the truth; with a tenth of the damping it rings on."""
    whole = problem()
    assert not has_structure(whole, whole.unknowns(RINGING))
    assert has_structure(whole, whole.unknowns(RINGING | {"c2": 0.1 * RINGING["c2"]}))


STATIC = {"a1": 1.0, "c1": 1e-9, "b1": 1e-3}
"""A curve so flat that what is added to a constant output is left behind as it is."""

TIME_S = 0.01 * np.arange(4000)
SQUARE = np.where(TIME_S % 8.0 < 4.0, 150.0, 20.0)
SINE = 85.0 + 65.0 * np.sin(2 * np.pi * 0.25 * TIME_S)
SINCE_STEP_S = TIME_S % 4.0


def left_behind(residual: np.ndarray, pressure: np.ndarray) -> Problem:
    """A problem whose residual at `STATIC` is the given one and a hundredth of noise."""
    noise = 0.01 * np.random.default_rng(0).standard_normal(residual.size)
    log = Log.from_arrays(
        TIME_S,
        {"pressure": pressure, "contraction": 5.0 + residual + noise},
        units={"contraction": "mm"},
    )
    model = Muscle(order="static")
    return Problem(model, model.parameters(), [log])


def swings_left(residual: np.ndarray, pressure: np.ndarray) -> bool:
    left = left_behind(residual, pressure)
    assert has_structure(left, left.unknowns(STATIC))
    return residual_oscillates(left, left.unknowns(STATIC))


def test_a_drift_does_not_swing_and_ringing_does() -> None:
    """A decay's autocorrelation only falls; a sine's goes to −1 and back within a period."""
    pressure = np.where(TIME_S < 1.0, 20.0, 150.0)
    decay = np.exp(-TIME_S / 8.0)
    assert not swings_left(decay, pressure)
    assert swings_left(decay + np.sin(2 * np.pi * 2.0 * TIME_S), pressure)


@pytest.mark.parametrize("sign", [np.sign(SQUARE - 85.0), np.ones_like(TIME_S)])
def test_what_every_step_leaves_behind_does_not_swing(sign: np.ndarray) -> None:
    """Spikes of 0.3 s, of the step's sign or all of one: they come back with the steps, after 4 s.

    A look at all lags sees their autocorrelation fall to zero or below and rise to 0.9 or 0.
    """
    assert not swings_left(sign * np.exp(-SINCE_STEP_S / 0.3), SQUARE)


def test_ringing_after_every_step_swings() -> None:
    """A damping ratio of 0.1 at 1 Hz: the second extreme is half of the first, long before 4 s."""
    ringing = np.exp(-0.63 * SINCE_STEP_S) * np.cos(2 * np.pi * SINCE_STEP_S)
    assert swings_left(ringing * np.sign(SQUARE - 85.0), SQUARE)


def test_a_bent_curve_under_a_sine_does_not_swing() -> None:
    """Second and third harmonics of 0.25 Hz come back with it; 3 Hz comes back before."""
    phase = 2 * np.pi * 0.25 * TIME_S
    assert not swings_left(np.cos(2 * phase), SINE)
    assert not swings_left(np.cos(2 * phase) + 0.3 * np.sin(3 * phase), SINE)
    assert swings_left(np.cos(2 * phase) + 0.7 * np.sin(12 * phase), SINE)


def test_rivals_of_a_law_beyond_all_numbers_are_none() -> None:
    """A damping of 1e200 squares to more than a float holds: no rival, and no exception."""
    degenerate = {"M": 1.0, "a1": 1.0, "b1": 1.0, "c1": 1.0, "a2": 0.0, "b2": 0.0, "c2": 1e200}
    lost = degenerate | {"c1": 1e-200}
    assert Muscle().alternatives(lost) == ()
    assert all(s["c2"].value > 0.0 for s in Muscle().alternatives(degenerate | {"c2": 1.0}))
