"""Numbers in tables as people read them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from desk import Desk, Outcome
from handmade import fit_result

from softid_cli.main import COMMANDS

Cli = Callable[..., Outcome]


def test_a_fit_of_nothing_is_zero_without_a_sign(softid: Cli, desk: Desk) -> None:
    """-0.04 % rounds to zero, and zero has no sign."""
    result = fit_result()
    rows = tuple(replace(row, fit_percent=-0.04) for row in result.statistics)
    desk.answer = replace(result, statistics=rows)
    told = softid("fit", "step_1.csv")
    assert "-0.0" not in told.out
    assert "0.0  in sample" in told.out


def test_an_open_interval_is_explained(softid: Cli, desk: Desk) -> None:
    """The bound of M is 1e-15; an interval that passes it has no end there."""
    result = fit_result()
    assert "…:" not in softid("fit", "step_1.csv", "--out", "a").out
    wide = replace(result.parameter("M"), ci95=(1e-20, 0.5))
    rest = tuple(wide if p.name == "M" else p for p in result.parameters)
    desk.answer = replace(result, parameters=rest)
    told = softid("fit", "step_1.csv", "--out", "b")
    assert "[…, 0.5]" in told.out
    assert "…: no limit on this side within the bounds of the parameter" in told.out


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_can_be_quiet(softid: Cli, command: str) -> None:
    """A script may say --quiet to all of them."""
    assert "--quiet" in softid(command, "--help").out
    assert softid("models", "muscle", "--quiet").code == 0
