"""How well the others are known beside a term that no sample shows."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import RATE_HZ, linear_angle

from softid.identification import fit
from softid.log import Log
from softid.models import Oscillator

TRUTH = {"M": 1.3, "N": 6.4, "Q": 170.0}
NOISE = 0.005
SLOW_HZ = 0.1


TIME_S = np.arange(40 * RATE_HZ) / RATE_HZ
PRESSURE = 40.0 - 40.0 * np.cos(2.0 * np.pi * SLOW_HZ * TIME_S)


def slow_log(seed: int) -> Log:
    """Four periods of a sine that begins at rest, far below the natural frequency of 1.8 Hz."""
    angle = linear_angle(TIME_S, PRESSURE, TRUTH)
    angle += NOISE * np.random.default_rng(seed).standard_normal(TIME_S.size)
    return Log.from_arrays(TIME_S, {"pressure": PRESSURE, "angle": angle}, name=f"slow-{seed}")


def stiffness_error(names: tuple[str, ...]) -> float:
    """Standard deviation of Q in least squares of some parameters and a zero, at a small inertia.

    By the columns of a linear model that scipy solves, which are differences of two motions.
    """
    columns = [np.ones_like(TIME_S)]
    for name in names:
        motions = [
            linear_angle(TIME_S, PRESSURE, small | {name: small[name] + change})
            for small in [TRUTH | {"M": 0.01}]
            for change in (1e-4, -1e-4)
        ]
        columns.append((motions[0] - motions[1]) / 2e-4)
    rows = np.column_stack(columns)
    return NOISE * float(np.linalg.inv(rows.T @ rows)[-1, -1] ** 0.5)


def test_the_stiffness_is_as_sure_as_it_is_with_an_inertia() -> None:
    """A slow sine follows Q − Mω²: with M left out Q is off by that, and its interval holds it."""
    drawn = [fit(slow_log(seed), model="oscillator") for seed in range(12)]
    without = [found for found in drawn if "M" not in found.free]
    assert len(without) >= 3
    alone, beside = stiffness_error(("N", "Q")), stiffness_error(("M", "N", "Q"))
    assert beside > 10.0 * alone
    for stiffness in (found.parameter("Q") for found in without):
        assert stiffness.stderr == pytest.approx(beside, rel=0.1)
        low, high = stiffness.ci95
        assert low < TRUTH["Q"] < high
        assert abs(stiffness.value - TRUTH["Q"]) > 1.96 * alone


def test_a_model_that_was_named_without_a_term_has_none() -> None:
    """Who says that there is no inertia knows the stiffness to what the sine tells of it."""
    found = fit(slow_log(0), model=Oscillator(order="first"))
    assert found.parameter("Q").stderr == pytest.approx(stiffness_error(("N", "Q")), rel=0.1)
