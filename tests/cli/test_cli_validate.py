"""`softid validate`: scores, the bar, the record, the self-check."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from desk import Desk, Outcome
from handmade import validation

from softid.log import Log
from softid.records import SavedModel
from softid.results import Validation
from softid_cli.tables import print_validation

Cli = Callable[..., Outcome]


@dataclass(frozen=True)
class Row:
    group: str
    parameter: str
    truth: float
    estimate: float
    ci95: tuple[float, float]
    inside: bool
    distance: float | None


@dataclass(frozen=True)
class Group:
    name: str
    parameters: int
    distance: float | None
    chance: float | None


@dataclass(frozen=True)
class SelfCheck:
    rows: tuple[Row, ...]
    groups: tuple[Group, ...]
    chance: float | None
    passed: bool


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, desk: Desk) -> dict[str, Any]:
    """The scoring is replaced: 66 % on step_2, so a bar of 50 passes and one of 90 does not."""
    calls: dict[str, Any] = {"check": SelfCheck((), (), None, True)}

    def validate(
        fitted: SavedModel, logs: Sequence[Log], *, threshold_percent: float | None
    ) -> Validation:
        calls.update(fitted=fitted, logs=[log.name for log in logs], load=desk.asked["load"])
        passed = threshold_percent is None or threshold_percent <= 66
        return validation(passed=passed, threshold_percent=threshold_percent)

    fake = ModuleType("softid.validation")
    fake.validate = validate  # type: ignore[attr-defined]
    fake.self_check = lambda *, progress: calls["check"]  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "softid.validation", fake)
    return calls


def test_scores(softid: Cli, asked: dict[str, Any], params: Path) -> None:
    """The logs are read with the roles of the fit; without a bar the verdict is not negative."""
    told = softid("validate", params, "step_2.csv")
    assert (told.code, told.err) == (0, "")
    assert "66.0  held out" in told.out
    assert "warning: step_2 goes to 120 kPa\n  → fit it too" in told.out
    assert asked["logs"] == ["step_2"]
    assert (asked["load"]["input"], asked["load"]["outputs"]) == ("pressure", ("angle",))


def test_a_bar_with_no_fit_to_judge(capsys: pytest.CaptureFixture[str]) -> None:
    """The bar is not reached, but no fit is below it either."""
    scored = validation(passed=False, threshold_percent=50.0)
    rows = tuple(replace(row, fit_percent=float("nan")) for row in scored.statistics)
    print_validation(replace(scored, statistics=rows))
    told = capsys.readouterr().out
    assert "No log has a fit for the bar of 50 % to judge." in told
    assert "Not every fit" not in told


@pytest.mark.parametrize(("bar", "code", "said"), [("50", 0, "Every fit"), ("90", 1, "Not every")])
def test_the_bar(
    softid: Cli, asked: dict[str, Any], params: Path, bar: str, code: int, said: str
) -> None:
    """66 % is above 50 and below 90; a negative verdict is exit code 1 and no error."""
    told = softid("validate", params, "step_2.csv", "--threshold", bar)
    assert (told.code, told.err) == (code, "")
    assert f"{said}" in told.out
    assert f"the bar of {bar} %" in told.out


def test_json_and_record(softid: Cli, asked: dict[str, Any], params: Path) -> None:
    """stdout and file are the same document; the verdict is in it and in the exit code."""
    told = softid("validate", params, "a.csv", "--threshold", "90", "--json", "--out", "scores")
    assert told.code == 1
    assert told.out == Path("scores/validation.json").read_text()
    document = json.loads(told.out)
    assert document["passed"] is False
    assert document["params"] == str(params)
    again = softid("validate", params, "a.csv", "--out", "scores")
    assert again.code == 3
    assert "--force" in again.err


def test_an_edit_by_hand_is_told(softid: Cli, asked: dict[str, Any], params: Path) -> None:
    """The scores are computed anew, but the user should know whose values they are."""
    params.write_text(params.read_text().replace("0.30000000000000004", "0.31"))
    told = softid("validate", params, "a.csv")
    assert told.code == 0
    assert "edited by hand" in " ".join(told.out.split())


def test_self_check(softid: Cli, asked: dict[str, Any]) -> None:
    """Without arguments: a row for each truth, the count, and what to expect of it."""
    rows = (
        Row("steps", "a1", 0.52, 0.53, (0.5, 0.55), True, 0.4),
        Row("steps", "M", 0.12, 0.2, (0.15, 0.25), False, 1.6),
    )
    asked["check"] = SelfCheck(rows, (Group("steps", 2, 9.0, 0.0111),), 0.0111, False)
    told = softid("validate")
    assert told.code == 1
    assert "[0.15, 0.25]  1.60  OUTSIDE" in told.out
    words = " ".join(told.out.split())
    assert "1 of 2 truths lie inside" in words
    assert "2 are to be expected, for 1 in 20 lies outside by definition" in words
    assert "together: χ² = 9 for 2 parameters; chance puts 1.1 % of fits farther off" in words
    assert "chance puts 1.1 % of runs farther off." in words
    assert json.loads(softid("validate", "--json").out)["passed"] is False


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["params.json"], 2, "no log was given to score the model on"),
        (["nothing.json", "a.csv"], 3, "nothing.json: there is no such file"),
        ([".", "a.csv"], 3, "this is a folder"),
        (["--threshold", "high", "params.json", "a.csv"], 2, "not a valid float"),
        (["--threshold", "50"], 2, "error: --threshold: this belongs to a model and logs"),
        (["--out", "x", "--force"], 2, "error: --out, --force: this belongs"),
        (["--threshold", "nan", "params.json", "a.csv"], 2, "no fit can be judged by this bar"),
        (["--threshold=-inf", "params.json", "a.csv"], 2, "no fit can be judged by this bar"),
        (["--threshold", "101", "params.json", "a.csv"], 2, "of which 100 is perfect"),
        (["--force"], 2, "error: --force: this belongs"),
        (["log.csv", "log.csv"], 3, "for it is no JSON; name the params.json first, then the logs"),
    ],
)
def test_wrong_usage(
    softid: Cli, asked: dict[str, Any], params: Path, arguments: list[str], code: int, said: str
) -> None:
    """One line, the documented code, no scores."""
    Path("log.csv").write_text("time_s,angle_deg\n0.0,1.0\n", encoding="utf-8")
    told = softid("validate", *arguments)
    assert told.code == code
    assert said in told.err
    assert told.err.count("\n") == 1
    assert told.out == ""
