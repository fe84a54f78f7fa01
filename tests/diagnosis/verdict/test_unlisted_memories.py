"""Laws in no catalogue that remember."""

from __future__ import annotations

import numpy as np
import pytest
from extended_fits import scale_of as sizes_of
from linear_motion import TRUTH, linear_log, linear_problem

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend
from softid.diagnosis.verdict.unlisted_memories import (
    OwnBranches,
    PositionHysteresis,
    SecondCreep,
    SecondHysteresis,
)
from softid.effects import effect_of
from softid.kernels.terms import FORCE, RATE


def test_a_second_hysteresis_follows_the_law_of_a_hysteresis() -> None:
    """By hand: α z = 3·0.4, and (v − |v| z)/zs = (−2 − 2·0.4)/0.5, as the catalogue has it."""
    for law in (SecondHysteresis(), effect_of("hysteresis")):
        out = np.zeros(8)
        law.step(0.5, -2.0, 0.4, 0.0, 0.0, np.array([3.0, 0.5]), out)  # type: ignore[union-attr]
        assert out[FORCE] == pytest.approx(1.2)
        assert out[RATE] == pytest.approx(-5.6)


def test_a_second_creep_follows_the_law_of_a_creep() -> None:
    """By hand: k (x − z) = 3·0.4 and (x − z)/τ = 0.4/2, as the creep of the catalogue has them."""
    for law in (SecondCreep(), effect_of("creep")):
        out = np.zeros(8)
        law.step(0.5, 0.0, 0.1, 0.0, 0.0, np.array([3.0, 2.0]), out)  # type: ignore[union-attr]
        assert out[FORCE] == pytest.approx(1.2)
        assert out[RATE] == pytest.approx(0.2)


def test_a_slider_behind_a_spring_follows_the_law_of_a_hysteresis() -> None:
    """By hand: with z = (x − s)/zs = 0.2 the force is 3·0.2, and zs ż = v − |v| z as ṡ = 0.4."""
    out, speed = np.zeros(8), -2.0
    OwnBranches.step(0.5, speed, 0.1, 0.0, 0.0, np.array([3.0, 2.0]), out)
    assert out[FORCE] == pytest.approx(0.6)
    assert out[RATE] == pytest.approx(0.4)
    assert speed - out[RATE] == pytest.approx(speed - abs(speed) * 0.2)


def test_each_log_at_rest_begins_with_a_slider_of_its_own() -> None:
    """Where it has one, position and velocity are free, too; of a plain hysteresis nothing is."""
    problem = linear_problem([linear_log(), linear_log(seed=1)])
    scale = scale_of(problem, problem.unknowns(TRUTH))
    for law, count in ((effect_of("hysteresis"), 0), (OwnBranches(), 3)):
        extended = extend(problem, (law,), scale)
        assert [len(extended.state_positions(k)) for k in range(2)] == [count, count]


def test_a_hysteresis_goes_with_the_position() -> None:
    """By hand: half way through the range its loop has gained half its share; it turns as ever."""
    scale, law = sizes_of("muscle"), PositionHysteresis()
    eta = np.array([2.0, 0.5, 3.0, *law.constants(scale)])
    out = np.zeros(8)
    law.step(scale.x_low + 0.5 * scale.x_span, -1.0, 0.4, 0.0, 0.0, eta, out)
    assert out[FORCE] == pytest.approx(2.0 * 0.4 * 2.5)
    assert out[RATE] == pytest.approx((-1.0 - 0.4) / 0.5)
    assert law.rate(eta[:3], scale) > law.rate(np.array([2.0, 0.5, 0.0]), scale) > 0.0
