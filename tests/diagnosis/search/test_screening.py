"""Signatures of effects against the residual, where everything is linear and known."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, Bow, Gain, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate, advance
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.residual.projection import project_out
from softid.diagnosis.search.screening import (
    LARGEST_AMPLITUDE,
    SMALLEST_AMPLITUDE,
    residual_of,
    screen,
)
from softid.effects import effect_of
from softid.effects.scale import Scale
from softid.fitters.problem import Problem
from softid.log import Log

DRIFT = effect_of("sensor_drift")
BOW_SIZE = 0.02


def base_of(log: Log, *, fixed: bool = True) -> tuple[Candidate, Scale]:
    """The truth with the best sensor zero; fixed, nothing but that zero is unknown."""
    problem: Problem = linear_problem([log], fixed=fixed)
    z = problem.unknowns(TRUTH)
    return standing(problem, z), scale_of(problem, z)


def drifting(rate: float, *, noise: float = 0.0) -> Log:
    """The linear actuator under a sensor that drifts, in rad/s."""
    plain = linear_log()
    return linear_log(noise=noise, added=rate * plain.time_s)


def bowed(size: float) -> Log:
    plain = linear_log()
    return linear_log(added=size * (plain.time_s / plain.time_s[-1]) ** 2)


@pytest.mark.parametrize("rate", [0.004, -0.01])
def test_the_true_effect_promises_the_true_drop(rate: float) -> None:
    """Closed form: output and zero are linear, so one straight step takes away everything.

    The scaled start is the true rate, and the zero moves to the true zero, which is none.
    """
    base, scale = base_of(drifting(rate))
    (found,) = screen(base, [DRIFT], scale, SIGMA)
    assert found.drop == pytest.approx(base.squares, rel=1e-6)
    assert found.values["rate"] == pytest.approx(rate, rel=1e-5)
    assert base.minimum.point + found.shift == pytest.approx([0.0], abs=1e-5)


def test_what_the_base_can_mimic_promises_nothing() -> None:
    """With M, N and Q free the signature of a gain is in their span: a softer spring does the same.

    The reading is 5 % too large under noise. With the base held the gain takes that away; with the
    base free only rounding is left of its signature, whose direction is as good as any of 1000.
    """
    plain = linear_log()
    log = linear_log(noise=0.01, added=0.05 * plain.channels["angle"].values)
    drops, squares = [], []
    for fixed in (True, False):
        base, scale = base_of(log, fixed=fixed)
        base = advance(base, SIGMA, 30)
        (found,) = screen(base, [Gain()], scale, SIGMA)
        drops.append(found.drop)
        squares.append(base.squares)
    assert squares[0] - drops[0] == pytest.approx(squares[1], rel=0.02)
    assert drops[0] > 0.3 * squares[0]
    assert drops[1] < 0.01 * squares[1]


def test_the_span_of_the_jacobian_is_taken_out() -> None:
    """Invariant: every column of the Jacobian is projected to nothing, twice is as once."""
    base, _ = base_of(linear_log(noise=0.01), fixed=False)
    residual = residual_of(base.problem, base.minimum.point, SIGMA)
    (block,) = base.problem.blocks(base.minimum.point, derivatives=True)
    assert block.jacobian is not None
    assert residual.span.basis.shape == (1000, base.problem.size)
    for column in (block.jacobian / SIGMA["angle"]).T:
        left = np.linalg.norm(project_out(residual.span.basis, column))
        assert left < 1e-8 * np.linalg.norm(column)
    values = np.random.default_rng(0).standard_normal(1000)
    once = project_out(residual.span.basis, values)
    assert project_out(residual.span.basis, once) == pytest.approx(once, abs=1e-12)
    assert residual.rows == pytest.approx(block.residual / SIGMA["angle"])


def test_coordinates_lead_back_to_the_unknowns() -> None:
    """Invariant: a known move of the unknowns, seen through the Jacobian, is found again."""
    base, _ = base_of(linear_log(), fixed=False)
    residual = residual_of(base.problem, base.minimum.point, SIGMA)
    (block,) = base.problem.blocks(base.minimum.point, derivatives=True)
    assert block.jacobian is not None
    move = np.array([0.3, -0.2, 0.1, 0.05])
    seen = block.jacobian / SIGMA["angle"] @ move
    assert residual.span.combinations @ (residual.span.basis.T @ seen) == pytest.approx(
        move, rel=1e-6
    )


def test_the_most_promising_comes_first() -> None:
    """Either of two curves of time is found when it is the true one, before the other."""
    for log, key in ((drifting(0.01), "sensor_drift"), (bowed(BOW_SIZE), "bow")):
        base, scale = base_of(log)
        found = screen(base, [DRIFT, Bow()], scale, SIGMA)
        assert found[0].effect.key == key
        assert found[0].drop > found[1].drop > 0.0


def test_an_effect_of_one_sign_promises_nothing_against_it() -> None:
    """The parabola may only open upward; a residual that opens downward is not its own."""
    base, scale = base_of(bowed(-BOW_SIZE))
    (found,) = screen(base, [Bow()], scale, SIGMA)
    assert found.drop == 0.0
    assert found.values["c"] == pytest.approx(0.1 * SMALLEST_AMPLITUDE)


@pytest.mark.parametrize(
    ("size", "factor"), [(1e-4, SMALLEST_AMPLITUDE), (0.1, 1.0), (3.0, LARGEST_AMPLITUDE)]
)
def test_the_amplitude_of_a_start_stays_within_its_factors(size: float, factor: float) -> None:
    """The start of 0.1 is scaled to what the residual asks for, but not beyond a twentieth or 5."""
    base, scale = base_of(bowed(size))
    (found,) = screen(base, [Bow()], scale, SIGMA)
    assert found.values["c"] == pytest.approx(0.1 * factor, rel=1e-5)


def test_an_effect_that_overflows_is_left_out() -> None:
    """What is not finite promises nothing and stops nobody."""

    class Wild(Bow):
        name = "wild"

        def apply(self, eta, time_s, y, scale):  # type: ignore[no-untyped-def]
            return y + np.inf * eta[0]

    base, scale = base_of(bowed(BOW_SIZE))
    assert [s.effect.key for s in screen(base, [Wild(), Bow()], scale, SIGMA)] == ["bow"]
