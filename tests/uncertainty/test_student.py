"""Student's t without scipy.special on the way of a plain fit."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import stdtrit

from softid.uncertainty.student import MANY, student_quantile


@pytest.mark.parametrize("probability", [0.5, 0.6, 0.9, 0.975, 0.995, 0.9999])
def test_quantiles_equal_those_of_scipy(probability: float) -> None:
    """scipy's own to 1e-9, on both sides of where the expansion takes over."""
    counts = [*np.geomspace(0.5, 1e7, 40), 1.0, 2.0, MANY * 0.999, MANY * 1.001]
    found = [student_quantile(count, probability) for count in counts]
    assert found == pytest.approx(stdtrit(counts, probability), rel=1e-9, abs=1e-12)


def test_one_and_two_degrees_of_freedom_have_closed_forms() -> None:
    """tan(π(p − ½)), and 2(p − ½)·√(2/(4p(1 − p)))."""
    p = 0.975
    assert student_quantile(1.0, p) == pytest.approx(np.tan(np.pi * (p - 0.5)), rel=1e-12)
    two = 2.0 * (p - 0.5) * np.sqrt(2.0 / (4.0 * p * (1.0 - p)))
    assert student_quantile(2.0, p) == pytest.approx(two, rel=1e-12)


def test_an_unknown_count_has_no_quantile() -> None:
    """NaN in, NaN out, at once."""
    assert np.isnan(student_quantile(float("nan"), 0.975))
