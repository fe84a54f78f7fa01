"""Another input is ruled out by a part of a long log, or by all of it where that is not clear."""

from __future__ import annotations

import numpy as np
import pytest

from softid.fitters.output_error import draft_fit
from softid.fitters.problem import Problem
from softid.identification.liveliest_part import LEAST_SAVING, LOOK, LiveliestPart
from softid.log import Log, LogSet
from softid.models import Oscillator

PERIOD_S, TAU_S, NOISE = 0.02, 0.1, 0.005


def stepped(*, is_held: bool, rest: int, size: float = 1.0) -> Log:
    """A lag of 0.1 s that rests and then follows random levels, in closed form over each sample."""
    rng = np.random.default_rng(5)
    levels = 50.0 + size * rng.uniform(-50.0, 50.0, LOOK // 50)
    u = np.concatenate([np.full(rest, levels[0]), np.repeat(levels, 50)])
    decay = np.exp(-PERIOD_S / TAU_S)
    x = np.full(u.size, u[0])
    for k in range(rest, u.size - 1):
        lag = 0.0 if is_held else (u[k + 1] - u[k]) / PERIOD_S * TAU_S
        aim = u[k] if is_held else u[k + 1]
        x[k + 1] = aim - lag + (x[k] - u[k] + lag) * decay
    y = 0.01 * x + rng.normal(0.0, NOISE, x.size)
    return Log.from_arrays(PERIOD_S * np.arange(u.size), {"pressure": u, "angle": y})


def look_at(log: Log) -> LiveliestPart | None:
    model = Oscillator(order="first", x_unit="rad", u_unit="kPa")
    problem = Problem(model, model.parameters(), [log])
    found = draft_fit(problem, [{"N": 100.0 * TAU_S, "Q": 100.0, "offset": 0.0}])
    return LiveliestPart.of(problem, found.unknowns)


def test_the_wrong_input_is_ruled_out_and_the_true_one_is_not() -> None:
    """By the motion at the end of a long rest; held is wrong by half a sample at every jump."""
    log = stepped(is_held=False, rest=(LEAST_SAVING - 1) * LOOK)
    part = look_at(log)
    assert part is not None
    assert part.spans[0][0] == pytest.approx(PERIOD_S * (LEAST_SAVING - 1) * LOOK)
    assert part.rules_out(LogSet((log.with_intersample("held"),)))
    assert not part.rules_out(LogSet((log,)))


def test_a_fit_that_leaves_structure_rules_nothing_out() -> None:
    """Taken as straight, a held input leaves half a sample of the motion at every jump."""
    assert look_at(stepped(is_held=True, rest=(LEAST_SAVING - 1) * LOOK)) is None


def test_what_is_not_clear_is_left_to_all_of_the_log() -> None:
    """Jumps of a twentieth, in which half a sample weighs four hundred times less."""
    log = stepped(is_held=False, rest=(LEAST_SAVING - 1) * LOOK, size=0.05)
    part = look_at(log)
    assert part is not None
    assert not part.rules_out(LogSet((log.with_intersample("held"),)))


def test_a_short_log_is_not_looked_at() -> None:
    """A part of it would save nothing."""
    assert look_at(stepped(is_held=False, rest=LOOK)) is None
