"""The incomplete beta function and the tail of R² against scipy."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import betainc, fdtrc

from softid.uncertainty.incomplete_beta import incomplete_beta, r_squared_tail


@given(a=st.floats(0.5, 1e4), b=st.floats(0.5, 1e4), x=st.floats(0.0, 1.0))
def test_the_function_equals_that_of_scipy(a: float, b: float, x: float) -> None:
    """scipy's own to 1e-9: the difference of logarithms of Γ(10⁴) loses five digits."""
    assert incomplete_beta(a, b, x, 1.0 - x) == pytest.approx(betainc(a, b, x), abs=1e-9)


@given(
    r_squared=st.floats(1e-6, 1.0 - 1e-6), unknowns=st.integers(1, 30), freedom=st.integers(1, 9999)
)
def test_the_tail_is_that_of_an_f_test(r_squared: float, unknowns: int, freedom: int) -> None:
    """scipy's F distribution, by the definition of the test."""
    ratio = r_squared / unknowns / ((1.0 - r_squared) / freedom)
    found = r_squared_tail(r_squared, unknowns, freedom)
    assert found == pytest.approx(fdtrc(unknowns, freedom, ratio), abs=1e-9)


def test_without_a_sample_to_spare_all_is_chance() -> None:
    """By definition; nothing explained is nothing, and all of it with samples to spare is none."""
    assert r_squared_tail(1.0, 7, 0) == r_squared_tail(-0.1, 7, 9) == 1.0
    assert r_squared_tail(1.0, 7, 9) == 0.0
