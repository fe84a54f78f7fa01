"""Softening: the stiffness goes by the path covered, and stands still in a rest."""

from __future__ import annotations

import numpy as np
from textbook_effects import oscillation, segment

from softid.effects.softening import Softening
from softid.models.oscillator import Oscillator

VALUES = {"s": 0.3, "W0": 1.5}


def test_stiffness_follows_the_path() -> None:
    """x = u/(Q (1 − s (1 − exp(−W/W0)))), with W added up from the positions found, to 1e-4."""
    time_s = np.arange(2000) * 0.01
    cycles = np.interp(time_s % 4.0, [0.0, 1.0, 2.0, 4.0], [0.0, 1.0, 0.0, 0.0])
    x = oscillation(
        Softening(), VALUES, segment(time_s, cycles), (0.0, 0.0, 2.0),
        model=Oscillator(order="static"),
    )  # fmt: skip
    path = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(x)))))
    left = 1.0 - VALUES["s"] * (1.0 - np.exp(-path / VALUES["W0"]))
    np.testing.assert_allclose(x, cycles / (2.0 * left), atol=1e-4 * np.ptp(x))
    assert path[-1] > 2.0 * VALUES["W0"]


def test_a_rest_changes_nothing() -> None:
    """Two cycles with a rest of 20 s between them end as two without it do, to 1e-9."""
    once = np.interp(np.arange(200) * 0.01, [0.0, 1.0, 2.0], [0.0, 1.0, 0.0])
    model, found = Oscillator(order="static"), []
    for pause in (0, 2000):
        u = np.concatenate((once, np.zeros(1 + pause), once))
        drive = segment(np.arange(u.size) * 0.01, u)
        found.append(oscillation(Softening(), VALUES, drive, (0.0, 0.0, 2.0), model=model))
    np.testing.assert_allclose(found[1][-200:], found[0][-200:], atol=1e-9)
    assert np.max(found[0][-200:]) > 1.02 * np.max(found[0][:200])
