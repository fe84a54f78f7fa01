"""Who leads a race, and who may still catch up, by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade_rounds import candidate
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.catching_up import (
    best_of_each,
    by_squares,
    can_catch_up,
    gain,
    is_at_same_place,
    is_outdone,
    one_of_each_place,
)
from softid.diagnosis.search.forward_selection import converged
from softid.diagnosis.search.rounds import those_in_reach


def test_the_gain_by_hand() -> None:
    """Closed form n ln(before/after) with n = 10,000; who ran away has lost everything."""
    assert gain(2.0, candidate(("delay",), 1.0)) == pytest.approx(1e4 * np.log(2.0))
    assert gain(1.0, candidate(("delay",), np.inf)) == -np.inf


def test_the_best_of_each_cause_stays() -> None:
    """By the sum of squares; what ran away is out even where nothing else is left of its cause."""
    rows = [
        candidate(("delay",), 9.0),
        candidate(("creep",), 5.0),
        candidate(("delay",), 4.0),
        candidate(("ageing",), np.inf),
        candidate(("creep", "delay"), 1.0),
        candidate(("creep",), np.nan),
    ]
    assert [(c.keys, c.squares) for c in best_of_each(rows)] == [
        (("creep", "delay"), 1.0),
        (("delay",), 4.0),
        (("creep",), 5.0),
    ]
    assert [c.squares for c in by_squares(rows)] == [1.0, 4.0, 5.0, 9.0]


@pytest.mark.parametrize(
    ("squares", "offset", "gained", "may_catch_up"),
    [
        (1.34, 0.0, 0.0, True),
        (1.36, 0.0, 0.0, False),
        (1.352, 1.0, 0.0, True),
        (2.0, 1.0, 0.0, False),
        (2.0, 13.0, 0.0, True),
        (2.7, 13.9, 0.0, False),
        (2.7, 15.0, 0.0, True),
        (1e9, 20.5, 0.0, True),
        (2.0, 0.0, 2300.0, False),
        (2.0, 0.0, 2320.0, True),
        (0.9, 0.0, 0.0, True),
    ],
)
def test_who_can_catch_up(squares: float, offset: float, gained: float, may_catch_up: bool) -> None:
    """Closed form with n = 10,000 beside a leader of 1, where ln 1.35 = 0.3.

    An offset of r promises 6 r² of 10,000, and four times that; from 20.4 on that is all of it. Or
    three times what was gained, of n ln 2 = 6931.
    """
    row = candidate(("delay",), squares, offset=offset)
    assert can_catch_up(row, 1.0, gained=gained) is may_catch_up


@pytest.mark.parametrize(
    ("key", "squares", "offset", "gained", "outdone"),
    [
        ("creep", 1.01, 0.0, 0.0, True),
        ("creep", 1.0, 0.0, 0.0, False),
        ("creep", 0.99, 0.0, 0.0, False),
        ("delay", 1.01, 0.0, 0.0, False),
        ("creep", 1.01, 2.0, -1.0, True),
        ("creep", 1.01, 2.1, -1.0, False),
        ("creep", 1.01, 2.1, 2.6, True),
        ("creep", 1.01, 2.1, 2.7, False),
        ("creep", 1.01, 0.0, 34.0, True),
        ("creep", 1.01, 0.0, 35.0, False),
    ],
)
def test_of_one_law_only_the_best_place_counts(
    key: str, squares: float, offset: float, gained: float, outdone: bool
) -> None:
    """By hand: 1 % of 10,000 samples is 99.5 behind, and 4 more would have to be won. Of six
    unknowns 24 offset² is to be hoped for, 96 and 106, or three times what the round gained; a
    tenth of 6 offset² is 2.65, and who gained less stands still."""
    row = candidate((key,), squares, offset=offset)
    best = candidate(("creep",), 1.0)
    assert is_outdone(row, [row, best], gained=gained) is outdone


def moved(place: Candidate, k: int, standard_errors: float) -> Candidate:
    """A candidate so many of its standard errors, the others held, away along one unknown."""
    problem, normal = place.problem, place.minimum.normal
    variance = place.squares / (problem.n_samples - problem.size)
    z = place.minimum.point.copy()
    z[k] += standard_errors * np.sqrt(variance / normal.matrix[k, k])
    cost = normal.cost + 0.5 * standard_errors**2 * variance
    return replace(
        place, minimum=replace(place.minimum, point=z, normal=replace(normal, cost=cost))
    )


def test_two_within_their_errors_stand_at_one_place() -> None:
    """Closed form: along one unknown of P, two root mean square errors are 2 √P of its own."""
    problem = linear_problem([linear_log(noise=0.01)])
    place = converged(standing(problem, problem.unknowns(TRUTH)), SIGMA)
    limit = 2.0 * np.sqrt(problem.size)
    near, far = moved(place, 0, 0.99 * limit), moved(place, 0, 1.01 * limit)
    assert is_at_same_place(near, place)
    assert not is_at_same_place(far, place)
    assert one_of_each_place([far, near, place]) == [place, far]


@pytest.mark.parametrize("away", [0.9, 3.0])
def test_who_stands_still_is_left_behind_by_a_better_one_that_did_not_run(away: float) -> None:
    """With the same effects, be it at the same optimum or at a worse one; alone it goes on."""
    problem = linear_problem([linear_log(noise=0.01)])
    place = converged(standing(problem, problem.unknowns(TRUTH)), SIGMA)
    other = moved(place, 0, away * 2.0 * np.sqrt(problem.size))
    assert those_in_reach([other], [other], []) == ([other], [])
    assert those_in_reach([other], [other], [place]) == ([], [other])
