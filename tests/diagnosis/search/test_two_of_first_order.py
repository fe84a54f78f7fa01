"""A lag and a delay, which one cause of second order that does not ring nearly is."""

from __future__ import annotations

import pytest
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing

import softid
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search.bic_ranking import is_likelier
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.search.two_of_first_order import chain_of_first_order
from softid.effects import EFFECTS, effect_of
from softid.fitters.problem import Problem
from softid.synthesis import hidden_pair


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 4])
def test_both_are_named(seed: int) -> None:
    """The second takes a few per cent of what the first does."""
    pair = hidden_pair(["pneumatic_lag", "delay"], seed=seed)
    train, hold_out = pair.logs
    found = softid.diagnose(train, hold_out=[hold_out], model="muscle")
    assert sorted(cause.effect for cause in found.causes) == ["delay", "pneumatic_lag"]


def test_without_a_cause_of_second_order_nothing_is_tried() -> None:
    """The base alone."""
    problem = linear_problem([linear_log(noise=0.01)])
    base = standing(problem, problem.unknowns(TRUTH))
    scale = scale_of(problem, base.minimum.point)
    assert chain_of_first_order(Chain((), None, base), base, (), scale, SIGMA) is None


def test_a_law_of_second_order_knows_its_lag_where_it_does_not_ring() -> None:
    """The two resonances, from a damping ratio of 0.7 on; no other effect is of second order."""
    well_damped, ringing = ({"period": 1.0, "zeta": zeta} for zeta in (0.7, 0.69))
    lags = {key: effect_of(key).first_order(well_damped) for key in EFFECTS}
    of_second_order = {key: lag for key, lag in lags.items() if lag is not None}
    assert of_second_order == {"line_resonance": "pneumatic_lag", "sensor_resonance": "sensor_lag"}
    assert all(effect_of(key).first_order(ringing) is None for key in EFFECTS)


def test_the_likelier_of_two_models_leaves_less() -> None:
    """The truth against a stiffness that is held 5 % off: fewer unknowns, and more that is left."""
    log = linear_log(noise=0.01)
    true = linear_problem([log])
    true_one = standing(true, true.unknowns(TRUTH))
    off_values = TRUTH | {"Q": 1.05 * TRUTH["Q"]}
    held = Problem(true.model, true.parameters.with_fixed(off_values), [log])
    off_one = standing(held, held.unknowns(off_values))
    assert is_likelier(true_one, off_one, SIGMA)
    assert not is_likelier(off_one, true_one, SIGMA)
