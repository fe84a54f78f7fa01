"""Asymmetric damping: two time constants, one for each direction."""

from __future__ import annotations

import numpy as np
import pytest
from textbook_effects import oscillation, segment

from softid.effects.asymmetric_damping import AsymmetricDamping
from softid.models.oscillator import Oscillator


@pytest.mark.parametrize(("begin", "sign"), [(0.5, -1.0), (-0.5, 1.0)])
@pytest.mark.parametrize("eps", [0.4, -0.7])
def test_each_direction_has_its_time_constant(eps: float, begin: float, sign: float) -> None:
    """N (1 ± ε) x' + Q x = 0 with v0 → 0: x = x₀ exp(−t Q/(N (1 ± ε))).

    v0 is 1e-4 of the first speed, so that 2e-4 of x₀ is left to it.
    """
    time_s = np.arange(200) * 0.01
    found = oscillation(
        AsymmetricDamping(), {"eps": eps, "v0": 1e-4}, segment(time_s, np.zeros(200)),
        (0.0, 1.0, 2.0), start=(begin, 0.0), model=Oscillator(order="first"),
    )  # fmt: skip
    expected = begin * np.exp(-2.0 * time_s / (1.0 + sign * eps))
    np.testing.assert_allclose(found, expected, atol=2e-4 * abs(begin))
