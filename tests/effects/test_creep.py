"""Creep in proportion to the deflection; that of a solid stands among the motions."""

from __future__ import annotations

import numpy as np
import pytest
from muscle_rig import SCALE, times
from textbook_effects import oscillation
from textbook_effects import segment as drive

from softid.effects.creep import Creep, SeriesCreep


@pytest.mark.parametrize("sampling", ["100 Hz", "irregular"])
def test_a_step_goes_on_by_its_share(sampling: str) -> None:
    """Settled before, 1 + c on it; behind a step of 1 the reading is 1 + c (1 − e^{−t/τ}).

    To 1e-3 c: between two samples the step counts as straight, which is late by half an interval.
    """
    time_s = times(sampling)
    jump = np.flatnonzero(time_s > 2.0)[0]
    y = np.where(np.arange(time_s.size) < jump, 3.0, 4.0)
    found = SeriesCreep().apply(np.array([0.2, 4.0]), time_s, y, SCALE)
    np.testing.assert_allclose(found[:jump], 3.0 * 1.2, rtol=1e-12)
    since_s = time_s[jump:] - time_s[jump - 1 : jump + 1].mean()
    expected = 3.0 * 1.2 + 1.0 - 0.2 * np.expm1(-since_s / 4.0)
    np.testing.assert_allclose(found[jump:], expected, rtol=0.0, atol=1e-3 * 0.2)


def test_without_inertia_it_is_the_creep_of_a_solid() -> None:
    """By hand: Q x + k (x − z) = u and τ ż = x − z give, behind a step of u,

    x = u/(Q + k) [1 + c (1 − e^{−t/T})] with c = k/Q and T = τ (Q + k)/Q: the series' law on a
    spring of Q + k. softid's simulator of the solid agrees to 1e-3 of the step, with a damping that
    dies out in 2 ms.
    """
    stiffness, k, tau = 2.0, 0.5, 1.5
    time_s = np.arange(400) * 0.02
    u = np.where(time_s > 1.0, 1.0, 0.0)
    solid = oscillation(
        Creep(), {"k": k, "tau": tau}, drive(time_s, u), (1e-9, 0.002 * stiffness, stiffness),
    )  # fmt: skip
    eta = np.array([k / stiffness, tau * (stiffness + k) / stiffness])
    series = SeriesCreep().apply(eta, time_s, u / (stiffness + k), SCALE)
    late = time_s > 1.1
    np.testing.assert_allclose(series[late], solid[late], rtol=0.0, atol=1e-3 / stiffness)
