"""Words for the unknowns of a fit, which reasons of verdicts show."""

from __future__ import annotations

import numpy as np

from softid.fitters.problem import Problem
from softid.identification.unknown_names import unknown_names
from softid.log import Log
from softid.models import Oscillator

MODEL = Oscillator(x_unit="rad", u_unit="kPa")


def test_what_makes_up_for_a_parameter_is_named_in_words() -> None:
    """Two logs that begin in motion, the second of which stalls once and so begins twice."""
    time_s = np.array([0.0, 0.1, 0.2, 5.0, 5.1, 5.2])
    moving = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0]
    channels = {"pressure": moving, "angle": moving}
    first = Log.from_arrays(time_s[:3], {k: v[:3] for k, v in channels.items()}, name="a")
    second = Log.from_arrays(time_s, channels, name="b")
    problem = Problem(MODEL, MODEL.parameters(), [first, second])
    names = unknown_names(problem)
    assert names[: len(problem.free)] == list(problem.free)
    assert set(names[len(problem.free) :]) == {
        "the zero of angle in a",
        "the zero of angle in b",
        *(
            f"the initial {state} in {place}"
            for state in ("position", "velocity")
            for place in ("a", "segment 1 of b", "segment 2 of b")
        ),
    }
