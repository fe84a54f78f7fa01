"""Pieces of a problem: the same samples, starts read off the data, no falling out of step."""

from __future__ import annotations

import numpy as np
import pytest

from softid.fitters.multiple_shooting import cut_into
from softid.fitters.objective import Objective
from softid.fitters.problem import Problem
from softid.log import Log
from softid.models.muscle import Muscle
from softid.simulation import simulate

TRUTH = {"M": 0.02, "a1": 0.01, "b1": 2.0, "c1": 0.1, "a2": 1e-4, "b2": 1.0, "c2": 0.01}


def ringing(model: Muscle, output: str) -> Log:
    """Steps answered by the model itself at 1 to 3 Hz with a damping ratio near 0.1, zero 4."""
    time_s = np.arange(600) * 0.02
    pressure = np.repeat([0.0, 90.0, 200.0, 60.0, 150.0, 30.0], 100)
    channels = {"pressure": pressure, output: time_s}
    blank = Log.from_arrays(time_s, channels, outputs=(output,))
    y = simulate(model, TRUTH, blank).outputs[output] + 4.0
    return Log.from_arrays(time_s, channels | {output: y}, outputs=(output,))


def test_pieces_hold_every_sample_once() -> None:
    """600 samples in 7 pieces: the times joined are the log's own."""
    problem = Problem(Muscle(), Muscle().parameters(), [ringing(Muscle(), "contraction")])
    cut = cut_into(problem, 7)
    assert len(cut.segments) == 7
    joined = np.concatenate([s.time_s for s in cut.segments])
    assert np.array_equal(joined, problem.segments[0].time_s)
    assert cut.at_rest == [True] + [False] * 6


@pytest.mark.parametrize(
    ("model", "output"),
    [
        (Muscle(), "contraction"),
        (Muscle(inverted=True), "contraction"),
        (Muscle(fixed_length_mm=400.0, diameter_mm=20.0), "length"),
    ],
)
def test_every_piece_starts_at_its_first_sample(model: Muscle, output: str) -> None:
    """The output is linear in the first state: its first residual vanishes but for the zero's move.

    With the true parameters the zero is known, so all residuals at a piece's start are alike.
    """
    problem = Problem(model, model.parameters(), [ringing(model, output)])
    cut = cut_into(problem, 6)
    blocks = list(cut.blocks(cut.started(TRUTH), derivatives=False))
    assert [b.residual[0] for b in blocks[1:]] == pytest.approx([0.0] * 5, abs=1e-9)


def test_pieces_bring_a_motion_back_into_step() -> None:
    """From half the stiffness and a tenth of the damping: M and c2 to 1 %, no noise to limit it."""
    model = Muscle()
    problem = Problem(model, model.parameters(), [ringing(model, "contraction")])
    cut = cut_into(problem, 30)
    away = TRUTH | {"M": 2.0 * TRUTH["M"], "c2": 0.1 * TRUTH["c2"], "b1": 1.6}
    z = Objective(cut, {"contraction": 1.0}).solve(cut.started(away), 60).point
    found = dict(zip(problem.parameters.names, cut.theta(z), strict=True))
    assert found["M"] == pytest.approx(TRUTH["M"], rel=0.01)
    assert found["b1"] == pytest.approx(TRUTH["b1"], rel=0.01)


def test_states_of_all_pieces_are_found_in_one_solve() -> None:
    """The motion is linear in its states: at the true parameters the data, without noise, remain.

    Started at its first sample a piece has no speed, which costs 10⁶ times more and above.
    """
    model = Muscle()
    problem = Problem(model, model.parameters(), [ringing(model, "contraction")])
    cut = cut_into(problem, 6)
    cost = Objective(cut, {"contraction": 1.0})
    started = cost(cut.started(TRUTH))
    assert cost(cut.with_best_states(started)).cost < 1e-6 * started.cost
