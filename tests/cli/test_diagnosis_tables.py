"""The table of causes."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from handmade_diagnosis import cause

from softid.diagnosis_results import Cause
from softid_cli.diagnosis_tables import _row

MM = 1000.0


def row_of(before: float, after: float) -> Cause:
    """A cause with held-out errors in metres and no interval of its gain."""
    made = cause("creep", [], before=2.0, after=1.0)
    return replace(made, holdout_rmse_before=before, holdout_rmse_after=after, gain_ci95=None)


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        (0.002, 0.001, "2 → 1 mm"),
        (0.002, math.nan, "2 → no response"),
        (math.nan, 0.001, "no response → 1 mm"),
    ],
)
def test_a_response_that_runs_away_is_told_in_words(before: float, after: float, told: str) -> None:
    """As is one without the cause; where nothing is held out nothing is told."""
    row = row_of(before, after)
    assert _row(row, "mm", MM, None)[-1] == told
    alone = replace(row, holdout_rmse_without=math.nan)
    assert _row(alone, "mm", MM, None)[-1] == f"{told}\nwithout it no response"


def test_nothing_held_out_is_nothing_told() -> None:
    """Without an error before and after there is nothing to compare."""
    assert _row(row_of(math.nan, math.nan), "mm", MM, None)[-1] == ""
