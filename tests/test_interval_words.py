"""Values and intervals as people read them."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from handmade_diagnosis import estimate

from softid.interval_words import interval_in_words, value_in_words


def test_digits_follow_the_width_of_the_interval() -> None:
    """By hand: 0.1667 lies inside, and with three digits the interval would be one number."""
    narrow = replace(estimate("period", 0.16652, "s"), ci95=(0.16608, 0.16698))
    assert value_in_words(narrow, fewest_digits=3) == "0.16652 [0.16608, 0.16698] s"
    wide = replace(narrow, value=0.1665, ci95=(0.12, 0.21))
    assert value_in_words(wide, fewest_digits=3) == "0.167 [0.12, 0.21] s"


@pytest.mark.parametrize(
    ("ends", "told"),
    [
        ((0.0, 0.47), "0.2 (at most 0.47) rad/s"),
        ((-math.inf, 0.47), "0.2 (at most 0.47) rad/s"),
        ((0.12, 2.0), "0.2 (at least 0.12) rad/s"),
        ((0.0, 2.0), "0.2 (no limit) rad/s"),
        ((0.1, 0.3), "0.2 [0.1, 0.3] rad/s"),
        ((0.0, 0.2004), "0.2 (at most 0.2004) rad/s"),
    ],
)
def test_an_open_side_is_told_in_words(ends: tuple[float, float], told: str) -> None:
    """The bounds of the search are 0.01 and 1: beyond them an end says nothing."""
    p = replace(estimate("v0", 0.2, "rad/s"), lower=0.01, upper=1.0, ci95=ends)
    assert value_in_words(p, fewest_digits=3) == told


def test_a_value_without_an_interval_stands_alone() -> None:
    """Of one that is held nothing else is known; a number of nothing has no unit."""
    held = replace(estimate("ratio", 0.25, "1"), ci95=None)
    assert value_in_words(held) == "0.25"
    assert interval_in_words(None) == ""


def test_an_interval_of_no_width_is_printed() -> None:
    assert interval_in_words((2.0, 2.0)) == "[2, 2]"
