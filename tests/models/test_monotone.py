"""Inversion of monotone functions where plain Newton iterations fail."""

from __future__ import annotations

import numpy as np
import pytest

from softid.models.monotone import invert_monotone


def test_a_function_that_throws_newton_out_of_the_bracket():
    """arctan from its flat end: Newton alone diverges beyond |x| = 1.39; the root is tan(y)."""
    y = np.array([-1.5, -0.3, 0.0, 1.2, 1.55])
    found = invert_monotone(np.arctan, lambda x: 1 / (1 + x**2), y, -100.0, 60.0)
    assert found == pytest.approx(np.tan(y), rel=1e-12, abs=1e-12)


def test_a_falling_function_and_its_ends():
    """exp(−x) on [0, 5]: targets at both ends give the ends themselves."""
    y = np.exp(-np.array([0.0, 2.0, 5.0]))
    found = invert_monotone(lambda x: np.exp(-x), lambda x: -np.exp(-x), y, 0.0, 5.0)
    assert found == pytest.approx([0.0, 2.0, 5.0], abs=1e-12)


def test_a_flat_root_is_reached():
    """x⁵ at 0 has no slope; bisection halves 2 until the fifth root of the smallest number."""
    found = invert_monotone(lambda x: x**5, lambda x: 5 * x**4, np.array([0.0, 1e-10]), -1.0, 3.0)
    assert found == pytest.approx([0.0, 1e-2], abs=1e-9)
