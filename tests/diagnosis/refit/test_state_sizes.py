"""How far initial states may move, and those that are forgotten."""

from __future__ import annotations

import numpy as np
import pytest

from softid.diagnosis.base.base_fit import Request
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.state_sizes import FARTHEST, bounds_of, reach_of, state_sizes
from softid.diagnosis.search.screening import residual_of
from softid.log import LogSet
from softid.synthesis import hidden_pair

SIGMA = {"contraction": 1.0}


def in_motion(masked_s: float) -> Candidate:
    """A fit to a log that begins in the middle of another, and counts from some time on."""
    whole = hidden_pair(seed=5, model="muscle", protocol="multisine").logs[0]
    begin_s = float(whole.time_s[700])
    log = whole.between(begin_s, begin_s + 12.0)
    log = log.with_masked(log.time_s < begin_s + masked_s)
    request = Request("muscle", None, 0, lambda message, fraction: None)
    return request.fit_base(LogSet((log,)), (), thorough=False).candidate


@pytest.mark.parametrize("masked_s", [0.0, 1.0])
def test_what_is_no_parameter_moves_as_far_as_the_motion(masked_s: float) -> None:
    """Zero and initial position by a span, the speed by the largest; parameters as in a fit."""
    problem = in_motion(masked_s).problem
    (segment,), reach = problem.segments, reach_of(problem)
    span, speed = state_sizes(segment, "contraction", 2)
    assert reach[problem.state_positions(0)].tolist() == [span, speed]
    assert reach[problem.zero_position(0, "contraction")] == span
    known = len(problem.free)
    assert reach[:known].tolist() == problem.reach()[:known].tolist()


def test_no_log_begins_far_beyond_its_motion() -> None:
    """Initial states have bounds beside those of the parameters; zeros have none."""
    problem = in_motion(0.0).problem
    (segment,), (lower, upper) = problem.segments, bounds_of(problem)
    far = FARTHEST * state_sizes(segment, "contraction", 2)
    places, zero = problem.state_positions(0), problem.zero_position(0, "contraction")
    assert upper[places].tolist() == (-lower[places]).tolist() == far.tolist()
    assert upper[zero] == -lower[zero] == np.inf
    known = len(problem.free)
    assert [lower[:known].tolist(), upper[:known].tolist()] == [
        ends[:known].tolist() for ends in problem.bounds()
    ]


@pytest.mark.parametrize(("masked_s", "forgotten"), [(0.0, False), (3.0, True)])
def test_a_forgotten_state_does_not_make_room(masked_s: float, forgotten: bool) -> None:
    """Its column is so small that the least a residual asks for is hundreds of spans."""
    base = in_motion(masked_s)
    residual = residual_of(base.problem, base.minimum.point, SIGMA)
    places = base.problem.state_positions(0)
    assert bool(residual.span.combinations[places].any()) is not forgotten
