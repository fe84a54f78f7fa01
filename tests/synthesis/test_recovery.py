"""Parameters of a cause against their truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade import fit_result
from handmade_diagnosis import cause, estimate
from recovery import is_recovered, true_values

from softid.diagnosis_results import Cause
from softid.results import ModelSpec
from softid.synthesis import hidden_pair


def cause_with(*values: float, half_width: float = 0.0) -> Cause:
    """A creep with parameters q0, q1, … and intervals of one width."""
    rows = [
        replace(estimate(f"creep_q{k}", v, ""), ci95=(v - half_width, v + half_width))
        for k, v in enumerate(values)
    ]
    return cause("creep", rows, before=2.0, after=0.5)


@pytest.mark.parametrize(
    ("value", "half_width", "found"), [(1.19, 0.0, True), (1.21, 0.0, False), (1.5, 0.51, True)]
)
def test_within_the_interval_or_a_fifth(value: float, half_width: float, found: bool) -> None:
    """The truth is 1; what has no true value is not judged."""
    told = cause_with(value, 7.0, half_width=half_width)
    assert is_recovered(told, {"q0": 1.0}) is found


def test_nothing_is_known() -> None:
    """A law of another form has no parameters in common with the one that is named."""
    assert is_recovered(cause_with(1.0), {}) is None


def test_knots_are_judged_by_their_shape() -> None:
    """A straight line added to the knots is that of the base; a bend of half the size is not."""
    bow = np.array([-1.2, -1.8, -1.8, -1.2, 0.0])
    truth = {f"q{k}": v for k, v in enumerate(bow.tolist())}
    assert is_recovered(cause_with(*(bow + 3.0 * np.arange(1.0, 6.0)).tolist()), truth)
    assert not is_recovered(cause_with(*(0.5 * bow).tolist()), truth)


def test_a_power_of_the_speed_is_one_law_at_any_largest_speed() -> None:
    """By hand: d2 v_m^(2 − n) is common, so twice the largest speed makes d2 of n = 3 twice."""
    pair = hidden_pair(["quadratic_damping.power"], seed=2, protocol="step")
    (truth,) = pair.hidden.values()
    wider = replace(
        fit_result(), model=ModelSpec("muscle", scale={"v_max": 2.0 * pair.sizes.v_max})
    )
    told = cause("quadratic_damping", [], before=2.0, after=1.0)
    found = true_values(told, pair, wider)
    assert found["n"] == truth["n"]
    assert found["d2"] == pytest.approx(truth["d2"] * 2.0 ** (truth["n"] - 2.0))
    assert true_values(replace(told, effect="creep"), pair, wider) == {}


def test_a_lag_that_differs_by_level_is_one_law_over_any_range() -> None:
    """By hand: over the upper half of the range τ is that at three quarters, and ρ its root."""
    pair = hidden_pair(["pneumatic_lag.level"], seed=2, protocol="step")
    (truth,) = pair.hidden.values()
    low, high = pair.sizes.p_low, pair.sizes.p_high
    half = {"u_low": 0.5 * (low + high), "u_high": high}
    fitted = replace(fit_result(), model=ModelSpec("muscle", scale=half))
    told = cause("pneumatic_lag", [], before=2.0, after=1.0)
    found = true_values(told, pair, fitted)
    assert found["tau"] == pytest.approx(truth["tau"] * truth["ratio"] ** 0.25)
    assert found["ratio"] == pytest.approx(np.sqrt(truth["ratio"]))
