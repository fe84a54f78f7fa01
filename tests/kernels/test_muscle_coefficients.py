"""Coefficients of the muscle law, packed for the integrator in one pass."""

from __future__ import annotations

import numpy as np

from softid.models.muscle_law import NAMES, MuscleLaw
from softid.models.second_order import Law

THETA = np.array([2e-3, 1 / 70, 2.8, 1.0, 0.02, 1.6, 0.25])


def test_packed_is_what_any_law_packs() -> None:
    """The general way, column by column from N, Q and P, to rounding; the last column is zero."""
    law = MuscleLaw(THETA)
    pressure = np.random.default_rng(0).uniform(0.0, 240.0, (50, 3))
    packed, by = law.packed(pressure, derivatives=True)
    expected, expected_by = Law.packed(law, pressure, derivatives=True)
    np.testing.assert_allclose(packed, expected, rtol=1e-14)
    np.testing.assert_allclose(by, expected_by, rtol=1e-14)
    assert not by.reshape(50, 3, 4, -1)[..., len(NAMES) :].any()
    assert law.packed(pressure, derivatives=False)[1].shape[0] == 0
