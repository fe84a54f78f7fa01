"""Verdicts, correlations and condition numbers."""

from __future__ import annotations

import numpy as np
import pytest

from softid.uncertainty import (
    Covariance,
    companions,
    condition_number,
    judge,
    relative_sd,
    strongest_partner,
)
from softid.uncertainty.identifiability import IDENTIFIED_BELOW, WEAK_BELOW

NAN = np.nan


def known(matrix: np.ndarray, *undetermined: tuple[str, ...]) -> Covariance:
    names = ("a2", "b2", "c2", "M")[: len(matrix)]
    sd = tuple(float(np.sqrt(v)) if v == v else None for v in np.diag(matrix))
    blank = np.ones(len(matrix))
    return Covariance(names, matrix, sd, sd, blank, blank, 1.0, undetermined, ())


def test_condition_number_ignores_units_and_knows_dependence() -> None:
    """Columns at angle 60°: eigenvalues of the Gram matrix 1 ± ½, so cond = √3, in any unit."""
    jacobian = np.array([[1.0, 0.5], [0.0, np.sqrt(0.75)]])
    assert condition_number(jacobian * [1.0, 1e9]) == pytest.approx(np.sqrt(3.0))
    assert condition_number(np.ones((5, 2))) == np.inf
    assert condition_number(np.eye(3)[:, [0, 1, 2]] * [1.0, 0.0, 1.0]) == np.inf


def test_strongest_partner_and_companions() -> None:
    """The largest |correlation| but one's own; the names that share an undetermined direction."""
    matrix = np.array([[1.0, -0.98, 0.1], [-0.98, 1.0, 0.2], [0.1, 0.2, 1.0]])
    assert strongest_partner(known(matrix), "a2") == ("b2", pytest.approx(-0.98))
    assert strongest_partner(known(np.array([[1.0]])), "a2") is None
    apart = np.array([[4.0, NAN, -3.0], [NAN, NAN, NAN], [-3.0, NAN, 9.0]])  # b2 is unknown
    assert strongest_partner(known(apart), "a2") == ("c2", pytest.approx(-0.5))
    assert strongest_partner(known(apart), "b2") is None
    groups = known(matrix, ("a2", "b2"), ("a2", "c2"))
    assert companions(groups, "a2") == ("b2", "c2")
    assert companions(groups, "b2") == ("a2",)


@pytest.mark.parametrize(
    ("sd", "verdict"),
    [
        (0.0, "identified"),
        (IDENTIFIED_BELOW - 1e-9, "identified"),
        (IDENTIFIED_BELOW, "weakly identified"),
        (WEAK_BELOW - 1e-9, "weakly identified"),
        (WEAK_BELOW, "not identified"),
        (None, "not identified"),
        (np.inf, "not identified"),
    ],
)
def test_verdict_follows_the_named_limits(sd: float | None, verdict: str) -> None:
    """The rule of the docstring, on a logarithmic scale, at its edges."""
    assert judge(3.0, "log", sd)[0] == verdict


def test_linear_scale_uses_value_or_range() -> None:
    """sd 1 at value 2 is 50 %, within bounds 100 apart 1 %; at zero without bounds unknown."""
    assert relative_sd(-2.0, "linear", 1.0) == 0.5
    assert relative_sd(2.0, "linear", 1.0, lower=-50.0, upper=50.0) == 0.01
    assert relative_sd(2.0, "linear", 1.0, lower=-np.inf, upper=50.0) == 0.5
    assert judge(0.0, "linear", 1.0)[0] == "not identified"
    assert judge(0.0, "linear", 0.0)[0] == "identified"


def test_reasons_name_the_partner_the_bound_and_the_companions() -> None:
    """Sentences without a full stop; a partner below 0.95 is not named."""
    assert "b2" in judge(1.0, "log", 0.5, partner=("b2", -0.98))[1]
    assert "b2" not in judge(1.0, "log", 0.5, partner=("b2", 0.9))[1]
    assert judge(1.0, "log", 0.1, partner=("b2", 0.99)) == ("identified", "")
    bound = judge(0.0, "linear", 0.1, at_bound=True, lower=0.0, upper=9.0)
    assert bound[0] == "not identified"
    assert "lower bound" in bound[1]
    assert "upper bound" in judge(9.0, "linear", 0.1, at_bound=True, lower=0.0, upper=9.0)[1]
    bounded = judge(0.001, "linear", 30.0, lower=-50.0, upper=50.0)[1]
    assert bounded == "its standard error is 30 % of the distance between its bounds"
    beyond = judge(0.001, "linear", 300.0, lower=-50.0, upper=50.0)[1]
    assert beyond == "its standard error is as large as the distance between its bounds"
    assert judge(100.0, "linear", 30.0, lower=-50.0, upper=50.0)[1].endswith("30 % of it")
    assert "b2 and c2" in judge(1.0, "log", None, companions=("b2", "c2"))[1]
    assert "does not change the response" in judge(1.0, "log", None)[1]


def test_companions_are_named_once() -> None:
    """A parameter of two undetermined directions stands in both, and yet is one name."""
    reason = judge(1.0, "log", None, companions=("c1", "a2", "c1", "a2"))[1]
    assert reason == "c1 and a2 can make up for it exactly"
    assert judge(1.0, "log", None, companions=("c2", "c2"))[1].startswith("c2 can")
