"""Segments that begin settled, where the initial state of a poorer model leads astray."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_angle, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.initial_states import with_settled_starts
from softid.log import Log

RATE_HZ = 50.0
OFF = (0.3, -2.0)
"""What a poorer model made of the beginning, in rad and rad/s."""


def log_from(start_rad: float) -> Log:
    """A log whose input moves from its first sample on, and the exact answer from some position."""
    time_s = np.arange(500) / RATE_HZ
    pressure = 60.0 - 40.0 * np.cos(3.0 * time_s)
    settled = linear_angle(time_s, pressure - pressure[0]) + pressure[0] / TRUTH["Q"]
    roots = np.roots([TRUTH["M"], TRUTH["N"], TRUTH["Q"]])
    falling = roots[1] * np.exp(roots[0] * time_s) - roots[0] * np.exp(roots[1] * time_s)
    angle = settled + start_rad * falling / (roots[1] - roots[0])
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})


def begun_at(log: Log, state: tuple[float, float]) -> tuple[Candidate, range]:
    """The truth with that initial state, and where the state stands among the unknowns."""
    problem = linear_problem([log])
    z = problem.unknowns(TRUTH)
    at = problem.state_positions(0)
    z[at] = state
    return standing(problem, z), at


def test_a_state_that_leads_astray_is_let_go() -> None:
    """The log begins settled: nothing is left of what it is measured by."""
    candidate, at = begun_at(log_from(0.0), OFF)
    assert candidate.squares > 1e3
    found = with_settled_starts(candidate, SIGMA)
    assert np.all(found.minimum.point[at] == 0.0)
    assert found.squares == pytest.approx(0.0, abs=1e-6 * candidate.squares)
    left = [b.residual for b in found.problem.blocks(found.minimum.point, derivatives=False)]
    assert np.max(np.abs(np.concatenate(left))) < 1e-6


def test_a_state_that_the_log_has_is_kept() -> None:
    """The log begins 0.3 rad off its equilibrium, and a settled start explains less."""
    candidate, _ = begun_at(log_from(OFF[0]), (OFF[0], 0.0))
    assert with_settled_starts(candidate, SIGMA) is candidate
