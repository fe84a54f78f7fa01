"""A candidate as the end of a fit."""

from __future__ import annotations

import pytest
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.refit.optimum import squares_under


def test_what_is_left_is_compared_in_the_scales_of_one_fit() -> None:
    """By hand: residuals that are divided by twice as much leave a quarter of the squares."""
    problem = linear_problem([linear_log(noise=0.01)])
    found = standing(problem, problem.unknowns(TRUTH), SIGMA)
    assert found.squares > 0.0
    twice = {name: 2.0 * scale for name, scale in SIGMA.items()}
    assert squares_under(found, SIGMA, twice) == pytest.approx(0.25 * found.squares)
    assert squares_under(found, SIGMA, dict(SIGMA)) == found.squares
