"""Numbers in tables as people read them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from desk import Desk, Outcome
from handmade import fit_result

from softid.errors import Issue
from softid.models import Oscillator
from softid.results import ModelSpec
from softid_cli.main import COMMANDS
from softid_cli.tables import issue_lines, model_text

Cli = Callable[..., Outcome]


def test_a_fit_of_nothing_is_zero_without_a_sign(softid: Cli, desk: Desk) -> None:
    """-0.04 % rounds to zero, and zero has no sign."""
    result = fit_result()
    rows = tuple(replace(row, fit_percent=-0.04) for row in result.statistics)
    desk.answer = replace(result, statistics=rows)
    told = softid("fit", "step_1.csv")
    assert "-0.0" not in told.out
    assert "0.0  in sample" in told.out


def test_a_score_that_does_not_exist_is_a_dash(softid: Cli, desk: Desk) -> None:
    """Of an output that never moves nothing can be said in per cent."""
    result = fit_result()
    rows = tuple(replace(row, fit_percent=float("nan")) for row in result.statistics)
    desk.answer = replace(result, statistics=rows)
    told = softid("fit", "step_1.csv")
    assert "nan" not in told.out
    assert "–  in sample" in told.out


def test_an_open_interval_is_told_in_words(softid: Cli, desk: Desk) -> None:
    """The bound of M is 1e-15; an interval that passes it has no end there."""
    result = fit_result()
    assert "at most" not in softid("fit", "step_1.csv", "--out", "a").out
    wide = replace(result.parameter("M"), ci95=(1e-20, 0.5))
    rest = tuple(wide if p.name == "M" else p for p in result.parameters)
    desk.answer = replace(result, parameters=rest)
    told = softid("fit", "step_1.csv", "--out", "b")
    assert "at most 0.5" in told.out
    assert "…" not in told.out


@pytest.mark.parametrize(
    ("errors", "said"),
    [
        ({}, "x max: 3.333 rad"),
        ({"x_max": 0.02}, "x max: 3.333 ± 0.020 rad"),
        ({"x_max": 4.0}, "x max: not determined by these logs"),
        ({"x_max": None}, "x max: not determined by these logs"),
    ],
)
def test_what_is_computed_has_an_error(
    softid: Cli, desk: Desk, errors: dict[str, float | None], said: str
) -> None:
    """A number that may as well be zero is not shown as if it were one."""
    desk.answer = replace(fit_result(), derived={"x_max": (3.3333, "rad")}, derived_stderr=errors)
    assert said in softid("fit", "step_1.csv").out.splitlines()


def test_nothing_computed_leaves_one_blank_line(softid: Cli, desk: Desk) -> None:
    """The quartics have no derived quantity."""
    desk.answer = replace(fit_result(), derived={})
    assert "\n\n\n" not in softid("fit", "step_1.csv").out


def test_an_option_has_its_unit_behind_its_value() -> None:
    """The names' endings are units: a spring in N/mm is not "n per 1.1 mm"."""
    options = {
        "wall_mm": 2.0,
        "spring_n_per_mm": 1.1,
        "wall_m": 0.002,
        "c10_pa": 17e3,
        "chambers": 13,
    }
    told = model_text(ModelSpec("yeoh", options))
    assert told == "yeoh (wall 2 mm, spring 1.1 N/mm, wall 0.002 m, c10 17000 Pa, chambers 13)"


def test_assumed_values_are_told_in_words() -> None:
    """A list of names keeps no underscore and no unit; an empty one says nothing."""
    assert model_text(ModelSpec("equilibrium", {"assumed": "wall_m, c10_pa, chambers"})) == (
        "equilibrium (wall, c10 and chambers assumed)"
    )
    assert model_text(ModelSpec("equilibrium", {"assumed": "c10_pa"})) == (
        "equilibrium (c10 assumed)"
    )
    told = model_text(ModelSpec("equilibrium", {"assumed": "", "inertia": "root-moment"}))
    assert told == "equilibrium (root-moment inertia)"


def test_a_switch_is_told_by_its_name() -> None:
    """An actuator that falls is "inverted", not "inverted 1"; one that rises is worth no word."""
    falls = Oscillator(order="first", inverted=True).spec()
    assert model_text(falls) == "oscillator (first order, linear spring, inverted)"
    assert "inverted" not in model_text(Oscillator().spec())


def test_no_word_of_a_table_is_cut(softid: Cli, desk: Desk) -> None:
    """The widest row of an actuator's fit needs 77 of 80 columns, with single spaces between."""
    result = fit_result()
    wide = replace(
        result.parameter("M"), value=4.5036e-4, stderr=6.6e-7, ci95=(4.491e-4, 4.516e-4),
        unit="N·m·s/rad",
    )  # fmt: skip
    long = replace(wide, name="rest_torque", verdict="identified", reason="")
    desk.answer = replace(result, parameters=(wide, long))
    told = softid("fit", "step_1.csv").out
    row = next(line for line in told.splitlines() if line.startswith("rest_torque "))
    assert row.split()[-3:] == ["0.0004516]", "N·m·s/rad", "identified"]


def test_a_reason_is_told_once(softid: Cli, desk: Desk) -> None:
    """In an issue about the parameter if there is one, else in a line; words do not decide."""
    result = fit_result()
    doubted = replace(result.parameter("M"), verdict="weakly identified", reason="few samples")
    about = Issue("weakly-identified", "info", "M is weakly identified: few samples", None, "M")
    begins_alike = Issue("ratios-only", "info", "M is a ratio to the torque")
    for issues in ((about,), (begins_alike,)):
        desk.answer = replace(result, parameters=(doubted,), issues=issues)
        told = softid("fit", "step_1.csv", "--out", f"{issues[0].code}").out
        assert told.count("M is weakly identified: few samples") == 1


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_can_be_quiet(softid: Cli, command: str) -> None:
    """A script may say --quiet to all of them."""
    assert "--quiet" in softid(command, "--help").out
    assert softid("models", "muscle", "--quiet").code == 0


def test_what_is_true_of_several_logs_is_said_once() -> None:
    """Another number is no other remark; another remedy, sentence or parameter is."""
    repeats = [
        Issue("r", "info", f"log_{k}, column 2: repeats for about 1.{k} samples", "one rate")
        for k in range(3)
    ]
    late = Issue("r", "info", "log_3, column 2: repeats for 2 samples, and is late", "one rate")
    elsewhere = replace(repeats[0], remedy="another")
    unknown = [
        Issue("n", "warning", f"{name}: not known", "steps", parameter=name)
        for name in ("a1", "a2")
    ]
    issues = [repeats[0], *unknown, repeats[1], late, repeats[2], elsewhere]
    assert issue_lines(issues, 80) == [
        "info: log_0, column 2: repeats for about 1.0 samples",
        "  likewise log_1 column 2 (1.1) and log_2 column 2 (1.2)",
        "  → one rate",
        "warning: a1: not known",
        "  → steps",
        "warning: a2: not known",
        "  → steps",
        "info: log_3, column 2: repeats for 2 samples, and is late",
        "  → one rate",
        "info: log_0, column 2: repeats for about 1.0 samples",
        "  → another",
    ]


def test_what_differs_in_more_than_a_number_is_said_in_full() -> None:
    """One lost sample must not stand for nine hundred; the third log is as the second."""
    lost = [
        Issue("lost", "warning", f"log_{k}: dropped {n} of {all_of} samples")
        for k, (n, all_of) in enumerate([(1, 2000), (900, 1900), (800, 1900)])
    ]
    assert issue_lines(lost, 80) == [
        "warning: log_0: dropped 1 of 2000 samples",
        "warning: log_1: dropped 900 of 1900 samples",
        "  likewise log_2 (800)",
    ]


def test_many_logs_are_counted() -> None:
    """Ten logs take two lines: the first four of the others by name, five by their number."""
    issues = [Issue("r", "info", f"log_{k}: is short") for k in range(10)]
    assert issue_lines(issues, 80) == [
        "info: log_0: is short",
        "  likewise log_1, log_2, log_3, log_4 and 5 more",
    ]
    assert issue_lines(issues[:6], 80)[1].endswith("log_3, log_4 and log_5")
    assert issue_lines([Issue("s", "info", "all is still")] * 2, 80) == ["info: all is still"]
