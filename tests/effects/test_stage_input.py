"""The input that arrives at the stages of every integration step."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from muscle_rig import SCALE, extended, pressure, segment

from softid.effects import Scale
from softid.effects.base import InputEffect
from softid.effects.delay import Delay
from softid.effects.extension.extended_model import ExtendedModel
from softid.effects.extension.stage_input import arriving_input
from softid.effects.pneumatic_lag import LevelPneumaticLag, PneumaticLag, SeparatePneumaticLag
from softid.kernels.radau import STAGES
from softid.log import Log
from softid.models.division import divided
from softid.models.second_order import Division

RADAU_WEIGHTS = np.array([(16.0 - np.sqrt(6.0)) / 36.0, (16.0 + np.sqrt(6.0)) / 36.0, 1.0 / 9.0])
"""Those of the three-stage rule (Hairer and Wanner II, §IV.5): exact for a parabola's mean."""


class Curved(Delay):
    """Replaces the input by a parabola in time."""

    name: ClassVar[str] = "curved"

    def apply(self, eta: np.ndarray, time_s: np.ndarray, u: np.ndarray, scale: Scale) -> np.ndarray:
        return 3.0 - 2.0 * time_s + 0.7 * time_s**2


def test_without_effects_it_is_the_recorded_input() -> None:
    """The stages of the plan themselves, so that nothing changes for a model without effects."""
    model, theta = extended()
    s = segment("irregular")
    plan = model.plan(theta, s)
    first, stages = arriving_input([], s, plan, SCALE)
    assert first == s.input[0]
    np.testing.assert_array_equal(stages, plan.stage_input)


def test_a_parabola_arrives_as_itself() -> None:
    """Least squares by a parabola returns it, at every stage of divided steps, to rounding."""
    s = segment("irregular")
    plan = divided(s.time_s, s.input, np.full(s.time_s.size - 1, 3))
    first, stages = arriving_input([(Curved(), np.zeros(1))], s, plan, SCALE)
    at_s = plan.stage_s
    assert first == 3.0
    np.testing.assert_allclose(stages, 3.0 - 2.0 * at_s + 0.7 * at_s**2, rtol=0.0, atol=1e-9)


def test_the_time_of_an_effect_begins_with_the_log() -> None:
    """A log from 1000 s on is that from 0 s on, with its plan and with what arrives."""
    model, theta = extended("delay")
    model = ExtendedModel(model.model, (Curved(),), SCALE)
    early = segment("irregular")
    late = replace(early, time_s=early.time_s + 1000.0, log_start_s=early.log_start_s + 1000.0)
    plans = [model.plan(theta, s) for s in (early, late)]
    arriving = [
        arriving_input([(Curved(), np.zeros(1))], s, plan, SCALE)
        for s, plan in zip((early, late), plans, strict=True)
    ]
    assert plans[0].stage_s.shape == plans[1].stage_s.shape
    assert arriving[0][0] == pytest.approx(arriving[1][0])
    np.testing.assert_allclose(arriving[0][1], arriving[1][1], atol=1e-6)


@pytest.mark.parametrize("tau_s", [0.0031, 0.0437])
def test_the_mean_of_a_step_is_kept(tau_s: float) -> None:
    """Mean pressure over each interval of a delayed step, within 1e-3 of the 70 kPa it rises.

    Reading the stages alone is off by more than 0.5 kPa where the input bends inside a step.
    """
    s = segment()
    plan = divided(s.time_s, s.input, np.ones(s.time_s.size - 1, np.intp))
    _, stages = arriving_input([(Delay(), np.array([tau_s]))], s, plan, SCALE)
    fine_s = np.linspace(s.time_s[0], s.time_s[-1], 1000 * (s.time_s.size - 1) + 1)
    fine = pressure(fine_s - tau_s)
    middles = 0.5 * (fine[1:] + fine[:-1])
    expected = middles.reshape(-1, 1000).mean(axis=1)
    assert np.max(np.abs(stages @ RADAU_WEIGHTS - expected)) < 0.07
    read = pressure(s.time_s[:-1, None] + 0.01 * STAGES - tau_s) @ RADAU_WEIGHTS
    assert np.max(np.abs(read - expected)) > 0.5


def test_all_of_a_held_jump_arrives_whatever_its_delay() -> None:
    """Closed form: 50 kPa from 0.3 s + τ on, within 50 kPa times 1/256 of an interval, and 50 kPa
    less a second of delay; with unequal weights of the nodes a third more and less, in turns."""
    ticks = np.arange(101) / 100.0
    log = Log.from_arrays(ticks, {"pressure": 50.0 * (ticks > 0.295), "angle": ticks})
    (held,) = log.with_intersample("held").segments()
    plan = divided(held.time_s, held.input, np.ones(held.time_s.size - 1, np.intp))
    taus = 0.1 + 0.01 * np.linspace(0.0, 1.0, 41)
    arrived = []
    for tau in taus:
        _, stages = arriving_input([(Delay(), np.array([tau]))], held, plan, SCALE)
        arrived.append(float(plan.step_s @ (stages @ RADAU_WEIGHTS)))
    np.testing.assert_allclose(arrived, 50.0 * (0.7 - taus), atol=50.0 * 0.01 / 256.0)
    np.testing.assert_allclose(np.diff(arrived) / np.diff(taus), -50.0, rtol=0.05)


@pytest.mark.parametrize(
    ("effect", "eta"),
    [
        (PneumaticLag(), [0.02]),
        (SeparatePneumaticLag(), [0.04, 0.5]),
        (LevelPneumaticLag(), [0.04, 4.0]),
    ],
)
def test_few_nodes_show_what_hardly_bends(effect: InputEffect, eta: list[float]) -> None:
    """Times of two steps, the shortest: with 4 nodes as with 16, to 1e-4 of a rise of 70 kPa."""
    s = segment()
    ones = np.ones(s.time_s.size - 1, np.intp)
    values = np.array(eta)
    bends_in_s = effect.bends_in_s(values)
    assert bends_in_s == pytest.approx(0.02)
    few, many = (
        divided(s.time_s, s.input, ones, bends_in_s=bends_in_s + 1e-9),
        divided(s.time_s, s.input, ones),
    )
    assert (few.nodes_per_step, many.nodes_per_step) == (4, 16)
    seen, expected = (arriving_input([(effect, values)], s, plan, SCALE)[1] for plan in (few, many))
    np.testing.assert_allclose(seen, expected, rtol=0.0, atol=1e-4 * 70.0)


def test_a_few_long_intervals_ask_for_no_more_nodes_elsewhere() -> None:
    """A computer that is busy now and then reads every 10 ms but for a tenth of a second: there is
    a step more for each 10 ms, and where half of the intervals are so long there are more nodes."""
    period_s = np.full(400, 0.01)
    for longer, nodes in ((4, 4), (201, 16)):
        period_s[:longer] = 0.1
        time_s = np.cumsum(period_s)
        plan = divided(time_s, time_s, np.ones(399, np.intp), bends_in_s=0.02)
        assert plan.nodes_per_step == nodes
        assert plan.steps == (399 + 9 * 3 if nodes == 4 else 399)
        assert plan.step_s.sum() == pytest.approx(np.ptp(time_s))


def test_a_delay_beside_a_lag_keeps_its_nodes() -> None:
    """Its corner may be anywhere."""
    s = segment()
    lag, both = extended("pneumatic_lag"), extended("pneumatic_lag", "delay")
    plans = [model.plan(theta, s) for model, theta in (lag, both)]
    assert plans[1].nodes_per_step == 16
    assert plans[0].bends_in_s > plans[1].bends_in_s == 0.0


def test_a_single_sample_has_no_steps() -> None:
    """Nothing to integrate is no error."""
    s = segment()
    lone = replace(s, time_s=s.time_s[:1], input=s.input[:1])
    nothing = Division(lone.time_s, lone.input, np.zeros(0, np.int16), "radau")
    first, stages = arriving_input([(Delay(), np.array([0.1]))], lone, nothing, SCALE)
    assert first == s.input[0]
    assert stages.shape == (0, 3)
