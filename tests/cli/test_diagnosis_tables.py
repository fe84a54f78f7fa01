"""The table of causes."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from handmade_diagnosis import cause, diagnosis

from softid.diagnosis_results import Cause, Verdict
from softid_cli.diagnosis_tables import print_diagnosis

DEG = math.pi / 180.0


def row_of(before: float, after: float) -> Cause:
    """A cause with held-out errors in radians and no interval of its gain."""
    made = cause("creep", [], before=2.0, after=1.0)
    return replace(made, holdout_rmse_before=before, holdout_rmse_after=after, gain_ci95=None)


def told_of(row: Cause, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """What stands in the lines of the only cause."""
    print_diagnosis(replace(diagnosis(Verdict.NAMED), causes=(row,), issues=()))
    _, table = capsys.readouterr().out.split("─\n")
    return [" ".join(line.split()) for line in table.splitlines()]


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        (2.0 * DEG, DEG, "2 → 1 deg"),
        (2.0 * DEG, math.nan, "2 → no response"),
        (math.nan, DEG, "no response → 1 deg"),
    ],
)
def test_a_response_that_runs_away_is_told_in_words(
    before: float, after: float, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """As is one without the cause; where nothing is held out nothing is told."""
    row = row_of(before, after)
    assert told_of(row, capsys) == [f"creep 412 {told}"]
    alone = replace(row, holdout_rmse_without=math.nan)
    assert told_of(alone, capsys) == [f"creep 412 {told}", "without it no response"]


def test_nothing_held_out_is_nothing_told(capsys: pytest.CaptureFixture[str]) -> None:
    """Without an error before and after there is nothing to compare."""
    assert told_of(row_of(math.nan, math.nan), capsys) == ["creep 412"]
