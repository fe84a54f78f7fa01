"""Laws in no catalogue that take the place of a drift."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from handmade_rounds import ranked
from linear_motion import TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.base.base_fit import Request
from softid.diagnosis.refit.candidates import (
    begun,
    extend,
    named_values,
    start_unknowns,
)
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search.forward_selection import Link, converged
from softid.diagnosis.verdict.equivalence import CHANGING, DRIFTS, UNLISTED
from softid.diagnosis.verdict.unlisted_laws import (
    UNLISTED_LAWS,
    LoadDrift,
    PressureDrift,
    PressureGainDrift,
    with_unlisted_rivals,
)
from softid.effects import EFFECTS, effect_of
from softid.effects.base import Effect
from softid.log import LogSet
from softid.synthesis import hidden_pair


def link_of(key: str) -> Link:
    base, chosen = ranked((), 0.0), ranked((key,), -500.0)
    return Link(base, (chosen, base), chosen, (key,), (), 100.0)


def residual_with(effect: Effect, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Times and what an effect takes from the exact answer of the linear actuator."""
    problem = linear_problem([linear_log()])
    z = problem.unknowns(TRUTH)
    extended = extend(problem, [effect], scale_of(problem, z))
    at = start_unknowns(extended, problem, z, {f"{effect.name}_rate": rate})
    (block,) = extended.blocks(at, derivatives=False)
    return problem.logs[0].time_s, block.residual


def test_a_load_that_changes_moves_by_its_compliance() -> None:
    """Closed form: x = −f (t − N/Q)/Q once the start has died away, 1e-3 of its end."""
    rate = 0.5
    time_s, residual = residual_with(LoadDrift(), rate)
    late = time_s > 3.0
    expected = rate * (time_s - TRUTH["N"] / TRUTH["Q"]) / TRUTH["Q"]
    np.testing.assert_allclose(residual[late], expected[late], atol=1e-3 * expected[-1])


@pytest.mark.parametrize(
    ("law", "expected"), [(PressureGainDrift(), [10.0, 18.0]), (PressureDrift(), [10.0, 19.9])]
)
def test_what_arrives(law: Any, expected: list[float]) -> None:
    """10 kPa at 0 s and 20 kPa at 2 s, at −0.05 a second."""
    found = law.apply(np.array([-0.05]), np.array([0.0, 2.0]), np.array([10.0, 20.0]), None)
    np.testing.assert_allclose(found, expected)


def test_they_are_told_and_are_in_no_catalogue() -> None:
    names = {law.name for law in UNLISTED_LAWS}
    assert names == set(CHANGING.effects) <= set(UNLISTED)
    assert not names & {key.split(".")[0] for key in EFFECTS}
    assert set(DRIFTS) <= set(EFFECTS)


def test_a_linear_model_has_its_class_for_them() -> None:
    """Nothing is refitted there: no base is asked for."""
    problem = linear_problem([linear_log()])
    z = problem.unknowns(TRUTH)
    extended = extend(problem, [effect_of("sensor_drift")], scale_of(problem, z))
    final = standing(extended, start_unknowns(extended, problem, z, {"sensor_drift_rate": 0.01}))
    link = link_of("sensor_drift")
    base: Any = None
    assert with_unlisted_rivals([link], [True], final, base) == [link]


@pytest.mark.parametrize(
    ("hidden", "drifts"),
    [
        ("load_drift", ("sensor_drift", "sensor_gain_drift")),
        ("pressure_gain_drift", ("sensor_gain_drift",)),
        ("sensor_drift", ("sensor_drift",)),
        ("sensor_gain_drift", ("sensor_gain_drift",)),
    ],
)
def test_what_explains_as_much_in_the_place_of_drifts(hidden: str, drifts: tuple[str, ...]) -> None:
    """Stands on the generator: two drifts of a sensor follow a load where a pressure stiffens the
    actuator, and the drift that is hidden has no rival."""
    (log, judge) = hidden_pair([hidden], seed=710001).logs
    request = Request("muscle", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((log,)), (judge,), thorough=False)
    known, effects = base.candidate.problem, tuple(effect_of(name) for name in drifts)
    problem = extend(known, effects, base.scale)
    starts = [named_values(e, {e.amplitude: 1e-4 * base.scale.y_span}) for e in effects]
    values = {name: value for start in starts for name, value in start.items()}
    z = start_unknowns(problem, known, base.candidate.minimum.point, values)
    final = converged(begun(base.candidate, effects, problem, z), base.sigma)
    links = [link_of(name) for name in drifts]
    for link in with_unlisted_rivals(links, [True] * len(links), final, base):
        assert (hidden in link.rivals[1:]) == (hidden not in drifts)
        assert len(link.rivals) == 1 or hidden not in drifts
