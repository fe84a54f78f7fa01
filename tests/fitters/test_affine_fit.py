"""The compiled optimiser against the Python loop, which is the reference for every step."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from softid.fitters import objective as objectives
from softid.fitters.affine_fit import looked_at, run
from softid.fitters.levenberg_marquardt import Minimum
from softid.fitters.normal_equations import linearise, summed
from softid.fitters.objective import Objective
from softid.fitters.problem import Problem
from softid.kernels.affine_descent import NEEDS_COLUMNS, SINGULAR
from softid.log import Log
from softid.models.base import Model
from softid.models.muscle import Muscle
from softid.models.oscillator import Oscillator
from softid.simulation import simulate

Array = npt.NDArray[np.float64]
TRUTH = {"M": 2e-3, "a1": 1 / 70, "b1": 2.8, "c1": 1.0, "a2": 0.02, "b2": 1.6, "c2": 0.25}
DRIVE = {"M": 0.3, "N": 1.1, "Q": 20.0, "G": 1.0, "offset": 0.0}
CASES: dict[str, tuple[Model, dict[str, float], tuple[str, ...]]] = {
    "muscle": (Muscle(), TRUTH, ("contraction",)),
    "two outputs": (
        Muscle(fixed_length_mm=150.0, diameter_mm=20.0, inverted=True),
        TRUTH,
        ("angle", "length"),
    ),
    "first order": (
        Muscle(order="first", damping="constant"),
        TRUTH | {"M": 0.0, "a2": 0.0, "b2": 0.0},
        ("contraction",),
    ),
    "oscillator": (Oscillator(), DRIVE, ("position",)),
    "no spring": (Oscillator(spring="none"), DRIVE | {"Q": 0.0, "offset": 90.0}, ("position",)),
}


def simulated(model: Model, truth: dict[str, float], log: Log) -> dict[str, Array]:
    return dict(simulate(model, truth, log).outputs)


def moved(model: Model, truth: dict[str, float], log: Log) -> dict[str, Array]:
    """The same from a start of its own, for a law that knows no rest."""
    theta, begin = np.array(list(truth.values())), np.array([0.5, 0.1])
    parts = [
        model.response(theta, s, log.outputs, start=begin, derivatives=False).outputs
        for s in log.segments()
    ]
    return {name: np.concatenate([part[name] for part in parts]) for name in log.outputs}


def problem(name: str, n: int = 300) -> Problem:
    """Two noisy logs, one moving at its start and with a stall, with samples left out."""
    model, truth, outputs = CASES[name]
    rng = np.random.default_rng(3)
    logs = []
    for moving in (False, True):
        time_s = np.cumsum(rng.uniform(0.008, 0.012, n))
        u = 100.0 + (80.0 * np.sin(9 * time_s) if moving else np.where(time_s < 0.6, 0, 90.0))
        if moving:
            time_s = np.where(time_s > 1.6, time_s + 3.0, time_s)
        empty = dict.fromkeys(outputs, time_s)
        blank = Log.from_arrays(time_s, {"pressure": u, **empty}, outputs=outputs)
        found = (
            moved(model, truth, blank) if name == "no spring" else simulated(model, truth, blank)
        )
        noisy = {k: y + 0.3 + rng.normal(0.0, 0.01 * np.ptp(y), y.size) for k, y in found.items()}
        log = Log.from_arrays(time_s, {"pressure": u, **noisy}, outputs=outputs, name="ab"[moving])
        logs.append(log.with_masked(rng.random(n) < 0.1))
    return Problem(model, model.parameters(), logs)


def solved(p: Problem, z: Array, *, compiled: bool, prior: bool = False) -> tuple[Minimum, int]:
    objective = Objective(p, {name: 1.0 + k for k, name in enumerate(p.outputs)})
    if prior:
        objective.set_prior(z, Minimum(z, objective(z), 1, 0.0))
    if not compiled:
        p.__dict__["arrays"] = None
    found = objective.solve(z, 200, tolerance=1e-7)
    p.__dict__.pop("arrays", None)
    return found, objective.evaluations


def away_in_errors(one: Minimum, other: Minimum) -> float:
    """Largest distance of two optima in standard errors, the others being refitted."""
    variance = 2.0 * other.normal.cost / other.normal.n
    errors = np.sqrt(variance * np.diag(np.linalg.pinv(other.normal.matrix)))
    return float(np.max(np.abs(one.point - other.point) / errors))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("prior", [False, True])
def test_both_reach_the_same_optimum(name: str, prior: bool) -> None:
    """Same steps, so the same point to 1e-6 standard errors; rounding alone lies between, and where
    it stops one of them short, what that one says it lacks, for the farthest of ten unknowns."""
    p = problem(name)
    assert p.arrays is not None
    z = p.unknowns(CASES[name][1]) + 0.2 * np.random.default_rng(8).normal(size=p.size)
    one, _ = solved(p, z, compiled=True, prior=prior)
    other, _ = solved(p, z, compiled=False, prior=prior)
    assert away_in_errors(one, other) < max(1e-6, 10.0 * max(one.reach, other.reach))
    assert one.normal.cost == pytest.approx(other.normal.cost, rel=1e-11)
    assert max(one.reach, other.reach) <= 1e-6


@pytest.mark.parametrize("name", CASES)
def test_sums_are_those_of_python(name: str) -> None:
    """Cost, gradient, matrix and columns at one point: to rounding, 1e-10 of the largest."""
    p = problem(name)
    z = p.unknowns(CASES[name][1]) + 0.05
    sigma = {channel: 1.0 + k for k, channel in enumerate(p.outputs)}
    plans = p.plans(z)
    python = linearise(p, z, sigma, plans=plans, keep=True)
    assert p.arrays is not None
    limits = (*p.bounds(), p.reach())
    found = run(p.arrays, z, plans, sigma, limits, None, evaluations=1, tolerance=0.0, keep=True)
    made = summed(p, found, sigma, plans, has_prior=False)
    again = summed(p, found, sigma, plans, has_prior=True)
    for one in (made, again):
        assert one.cost == pytest.approx(python.cost, rel=1e-10)
        assert one.n == python.n
        np.testing.assert_allclose(one.point, python.point, rtol=1e-12)
        for value, wanted in ((one.gradient, python.gradient), (one.matrix, python.matrix)):
            np.testing.assert_allclose(value, wanted, atol=1e-10 * np.abs(wanted).max())
    pairs = zip(made.blocks(p, derivatives=True), python.blocks(p, derivatives=True), strict=True)
    for block, wanted in pairs:
        np.testing.assert_allclose(block.residual, wanted.residual, atol=1e-9)
        np.testing.assert_allclose(block.jacobian, wanted.jacobian, rtol=1e-9, atol=1e-9)


def test_long_steps_bend_alike_with_columns_asked_for_late(monkeypatch: Any) -> None:
    """From far off, with columns kept from the begin, from the first long step on, or in Python:
    the same optimum; the second takes more evaluations, for it begins anew when it asks."""
    p = problem("muscle", 500)
    z = p.unknowns(TRUTH)
    z[:7] += [0.6, -0.2, 0.1, -0.3, 0.4, -0.4, 0.4]
    early, used = solved(p, z, compiled=True)
    monkeypatch.setattr(objectives, "CHEAP_ENTRIES", 0)
    late, more = solved(p, z, compiled=True)
    python, theirs = solved(p, z, compiled=False)
    assert away_in_errors(early, python) < 1e-6
    assert away_in_errors(late, python) < 1e-6
    assert used <= theirs + 1
    assert used < more


def test_the_python_loop_goes_on_where_a_system_is_singular(monkeypatch: Any) -> None:
    """The compiled run is made to stop after one evaluation; the end stays where it was."""
    p = problem("muscle")
    z = p.unknowns(TRUTH) + 0.1

    def stopped(*arguments: Any, **options: Any) -> Any:
        options["evaluations"] = 1
        return replace(run(*arguments, **options), how=SINGULAR)

    whole, _ = solved(p, z, compiled=True)
    monkeypatch.setattr(objectives, "run", stopped)
    found, _ = solved(p, z, compiled=True)
    assert away_in_errors(found, whole) < 1e-6


def test_without_columns_it_stops_before_a_long_step() -> None:
    """NEEDS_COLUMNS at the start itself, unless told not to bend."""
    p = problem("muscle")
    z = p.unknowns(TRUTH)
    z[:7] += [1.5, -0.5, 0.4, -1.0, 1.0, -1.0, 1.0]
    assert p.arrays is not None
    limits = (*p.bounds(), p.reach())
    sigma = {"contraction": 1.0}
    asked = run(
        p.arrays, z, p.plans(z), sigma, limits, None, evaluations=50, tolerance=1e-3, keep=False
    )
    assert asked.how == NEEDS_COLUMNS
    assert asked.used == 1
    straight = run(
        p.arrays, z, p.plans(z), sigma, limits, None,
        evaluations=50, tolerance=1e-3, keep=False, bends=False,
    )  # fmt: skip
    assert straight.how != NEEDS_COLUMNS
    assert straight.cost < asked.cost


def test_a_look_finds_zeros_and_states_at_once() -> None:
    """Both enter linearly: at the found unknowns their part of the gradient is gone, to 1e-8."""
    p = problem("muscle")
    z = looked_at(p, TRUTH, {"contraction": 1.0})
    assert z is not None
    normal = Objective(p, {"contraction": 1.0})(z)
    size = np.sqrt(np.diag(normal.matrix) * 2.0 * normal.cost)
    assert np.max(np.abs(normal.gradient / size)[len(p.free) :]) < 1e-8


@pytest.mark.parametrize("why", ["tie", "distance", "free gain"])
def test_what_needs_python_has_no_arrays(why: str) -> None:
    """A tie, an output that bends with x, and a gain whose slope is no single column."""
    p = problem("oscillator" if why == "free gain" else "muscle")
    parameters, model = p.parameters, p.model
    if why == "tie":
        parameters = parameters.replacing(replace(parameters["c2"], tie="2 * a2"))
    elif why == "free gain":
        parameters = parameters.replacing(replace(parameters["G"], fixed=False))
    else:
        model = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
        log = p.logs[0]
        logs = [
            Log.from_arrays(
                log.time_s,
                {"pressure": log.channels["pressure"].values, "distance": log.time_s + 100.0},
                outputs=("distance",),
            )
        ]
        assert Problem(model, model.parameters(), logs).arrays is None
        return
    assert Problem(model, parameters, p.logs).arrays is None
