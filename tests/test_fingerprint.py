"""The fingerprint of samples is that of their values."""

from __future__ import annotations

import numpy as np

from softid.fingerprint import data_fingerprint

TIME_S, ANGLE = np.arange(5) / 10.0, np.array([0.0, 1.0, np.nan, 3.0, 4.0])


def test_equal_samples_have_one_fingerprint() -> None:
    """In whatever order, layout and sign of zero; two channels do not change places."""
    both = {"angle": ANGLE, "force": TIME_S}
    known = data_fingerprint(TIME_S, both)
    spread = np.column_stack((ANGLE, ANGLE))[:, 0]
    assert data_fingerprint(TIME_S, {"force": TIME_S, "angle": spread}) == known
    assert data_fingerprint(TIME_S, {"force": -0.0 + TIME_S, "angle": ANGLE * 1.0}) == known
    assert data_fingerprint(np.where(TIME_S == 0.0, -0.0, TIME_S), both) == known
    assert data_fingerprint(TIME_S, {"angle": ANGLE, "force": -np.nan * ANGLE}) != known
    assert data_fingerprint(TIME_S, {"force": ANGLE, "angle": TIME_S}) != known


def test_one_other_bit_has_another() -> None:
    """A later start, one sample, one fewer."""
    known = data_fingerprint(TIME_S, {"angle": ANGLE})
    other = ANGLE.copy()
    other[1] = np.nextafter(1.0, 2.0)
    assert data_fingerprint(TIME_S, {"angle": other}) != known
    assert data_fingerprint(TIME_S + 1.0, {"angle": ANGLE}) != known
    assert data_fingerprint(TIME_S[:-1], {"angle": ANGLE[:-1]}) != known
