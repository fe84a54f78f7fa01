"""Places that explain about as much: poles in a row in another order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate, TemperedPrior, advance
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.equivalent_places import LIGHTER, exchanged
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.effects import effect_of

LAG = effect_of("pneumatic_lag")
OVERDAMPED = {"M": 0.18, "N": 2.7, "Q": 9.0}
"""Poles of 0.2 and 0.1 s."""


def with_lag(values: dict[str, float], tau: float) -> Candidate:
    base = linear_problem([linear_log(noise=0.01)])
    unknowns = base.unknowns({**TRUTH, **values})
    problem = extend(base, [LAG], scale_of(base, unknowns))
    z = start_unknowns(problem, base, unknowns, {"pneumatic_lag_tau": tau})
    return replace(standing(problem, z), effects=(LAG,))


def test_inertia_and_lag_change_places() -> None:
    """Closed form: 0.04 s of inertia go to a lag of 0.01 s, and a tenth of the mass stays.

    A lag that is larger than all that the law takes stays.
    """
    moved, *_ = exchanged(with_lag({}, 0.01))
    assert moved.parameters["pneumatic_lag_tau"] == pytest.approx(TRUTH["M"] / TRUTH["N"])
    assert moved.parameters["M"] == pytest.approx(LIGHTER * TRUTH["M"])
    assert moved.parameters["N"] == pytest.approx(TRUTH["N"])
    assert exchanged(with_lag({}, 10.0)) == []


def test_the_slow_pole_goes_to_the_lag() -> None:
    """Closed form: of a law with 0.2 and 0.1 s and a lag of 0.05 s, the lag gets 0.2 s.

    N/Q = 0.05 + 0.1 s and M/Q = 0.05 · 0.1 s² are left: the same three poles, and as good a fit.
    """
    candidate = with_lag(OVERDAMPED, 0.05)
    *_, moved = exchanged(candidate)
    expected = {"pneumatic_lag_tau": 0.2, "N": 9.0 * 0.15, "M": 9.0 * 0.005, "Q": 9.0}
    assert {name: moved.parameters[name] for name in expected} == pytest.approx(expected)
    before, after = (advance(c, SIGMA, 0).minimum.normal.cost for c in (candidate, moved))
    assert after == pytest.approx(before, rel=1e-3)


def test_a_valve_takes_the_pole_in_the_time_of_its_own_law() -> None:
    """A valve that is as late as a lag of 0.2 s has three times its time, and gives as much back.

    A drive whose slow pole is the filling of its chamber left the valve where it began.
    """
    valve = effect_of("valve_flow")
    base = linear_problem([linear_log(noise=0.01)])
    unknowns = base.unknowns({**TRUTH, **OVERDAMPED})
    problem = extend(base, [valve], scale_of(base, unknowns))
    start = {"valve_flow_tau": 3.0 * 0.05, "valve_flow_b": 0.3}
    z = start_unknowns(problem, base, unknowns, start)
    *_, moved = exchanged(replace(standing(problem, z), effects=(valve,)))
    expected = {"valve_flow_tau": 3.0 * 0.2, "N": 9.0 * 0.15, "M": 9.0 * 0.005}
    assert {name: moved.parameters[name] for name in expected} == pytest.approx(expected)


def test_a_law_that_swings_has_no_pole_to_give() -> None:
    """Its inertia's time alone goes to the lag, for no chain of lags swings."""
    assert len(exchanged(with_lag({**OVERDAMPED, "N": 0.5}, 0.05))) == 1


def test_a_candidate_that_is_moved_is_as_good_as_before() -> None:
    """Its sum of squares stays, although the prior asks another price of the new place.

    Else the price would be taken off the squares, down to zero, and with them the prior's weight.
    """
    candidate = with_lag({}, 0.01)
    z = candidate.minimum.point
    prior = TemperedPrior(z, np.full(z.size, 1e6))
    for moved in exchanged(replace(candidate, prior=prior)):
        assert prior.cost(moved.minimum.point) > candidate.squares
        assert moved.squares == pytest.approx(candidate.squares)
        assert advance(moved, SIGMA, 1).prior.variance > 0.0
