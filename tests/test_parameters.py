"""Declared parameters: bounds, order, holding, and the way to lmfit and back."""

from __future__ import annotations

import numpy as np
import pytest

from softid.errors import UsageError
from softid.parameters import Parameter, ParameterSet

SET = ParameterSet(
    (
        Parameter("M", 2.0, lower=1e-15, upper=1e15, scale="log", unit="kg"),
        Parameter("b", 0.5, lower=-3.0, upper=3.0),
        Parameter("G", 1.0, fixed=True),
        Parameter("K", 4.0, tie="2*M"),
    )
)


def test_order_and_roles() -> None:
    """The order is the declared one; fixed and tied parameters are not free."""
    assert SET.names == tuple(SET) == ("M", "b", "G", "K")
    assert SET.free == ("M", "b")
    assert SET.values_vector().tolist() == [2.0, 0.5, 1.0, 4.0]
    assert SET.values_dict() == {"M": 2.0, "b": 0.5, "G": 1.0, "K": 4.0}
    assert len(SET) == 4
    assert "absent" not in SET


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"value": 1.0, "lower": 2.0, "upper": 0.0}, "lower bound is above"),
        ({"value": 5.0, "upper": 4.0}, "not within"),
        ({"value": float("nan")}, "not within"),
        ({"value": float("inf")}, "not within"),
        ({"value": 1.0, "lower": -1.0, "scale": "log"}, "positive.*logarithmic.*got -1"),
        ({"value": 0.0, "lower": 0.0, "upper": 0.0, "scale": "log"}, "positive.*bounds above zero"),
    ],
)
def test_impossible_parameters_are_refused(arguments, says: str) -> None:
    """The error names the parameter."""
    with pytest.raises(UsageError, match=says) as error:
        Parameter("stiffness", **arguments)
    assert "stiffness" in str(error.value)


def test_twice_declared() -> None:
    """A name can be there only once."""
    with pytest.raises(UsageError, match="twice"):
        ParameterSet((Parameter("M", 1.0), Parameter("M", 2.0)))


def test_values_are_clipped_to_bounds_and_unknown_names_refused() -> None:
    """with_values never makes an impossible set; a typo is named."""
    moved = SET.with_values({"b": 9.0, "M": 0.0})
    assert moved["b"].value == 3.0
    assert moved["M"].value == 1e-15
    with pytest.raises(UsageError, match="no parameter m"):
        SET.with_values({"m": 1.0})


def test_holding_moves_a_bound_that_is_in_the_way() -> None:
    """Zero lies outside the bounds of a positive parameter, yet it may be held there."""
    held = SET.with_fixed({"M": 0.0, "K": 3.0})
    assert (held["M"].value, held["M"].lower, held["M"].fixed) == (0.0, 0.0, True)
    assert held["K"].tie is None
    assert held.free == ("b",)
    with pytest.raises(UsageError, match="no parameter Q"):
        SET.with_fixed({"Q": 1.0})


def test_replacing() -> None:
    """One exchanged, the order kept."""
    other = SET.replacing(Parameter("b", 1.0, fixed=True))
    assert other.names == SET.names
    assert other.free == ("M",)
    with pytest.raises(UsageError):
        SET.replacing(Parameter("Q", 1.0))


def test_to_lmfit_and_back() -> None:
    """Value, bounds, vary and expr survive the round trip; unit and scale are softid's own."""
    table = SET.to_lmfit()
    assert table["K"].value == 4.0
    assert table["K"].expr == "2*M"
    assert not table["G"].vary
    table["M"].set(value=3.0, max=10.0)
    table["b"].vary = False
    back = SET.updated_from_lmfit(table)
    assert back["M"] == Parameter("M", 3.0, lower=1e-15, upper=10.0, scale="log", unit="kg")
    assert back["b"].fixed
    assert back["K"].tie == "2*M"
    assert back["K"].value == pytest.approx(6.0)
    assert SET.updated_from_lmfit(SET.to_lmfit()) == SET


def test_from_lmfit_without_bounds_keeps_a_log_scale_positive() -> None:
    """lmfit's default bound is −∞, which a logarithm cannot have; a missing name stays."""
    import lmfit

    table = lmfit.Parameters()
    table.add("M", value=5.0)
    back = SET.updated_from_lmfit(table)
    assert (back["M"].lower, back["M"].upper) == (0.0, np.inf)
    assert back["b"] == SET["b"]
    table.add("Q", value=1.0)
    with pytest.raises(UsageError, match="no parameter Q"):
        SET.updated_from_lmfit(table)


@pytest.mark.parametrize("bounds", [(-1.0, 0.0), (-1.0, 10.0), (None, 0.0), (None, -1.0)])
def test_bounds_of_lmfit_leave_a_logarithm_positive(bounds: tuple[float | None, float]) -> None:
    """The command refuses the same with ``--bound M=-1:0``."""
    table = SET.to_lmfit()
    lower, upper = bounds
    table["M"].set(min=-np.inf if lower is None else lower, max=upper)
    with pytest.raises(UsageError, match=r"parameter M: M must be positive.*bounds above zero"):
        SET.updated_from_lmfit(table)


def test_equal_bounds_are_a_held_value_for_lmfit() -> None:
    """lmfit refuses min == max; the value is the only one possible, so it does not vary."""
    narrow = ParameterSet((Parameter("b", 1.0, lower=1.0, upper=1.0), Parameter("K", 2.0)))
    table = narrow.to_lmfit()
    assert table["b"].value == 1.0
    assert not table["b"].vary
