"""Help of the commands: one option, one word for what it takes."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

import click
import pytest
from desk import Outcome

from softid_cli.main import COMMANDS

Cli = Callable[..., Outcome]

OTHERWISE = {
    ("simulate", "--input"): "LOG",
    ("simulate", "--out"): "FILE.csv",
}
"""A file where the other commands take a channel or a folder, which the help says."""


def options() -> dict[tuple[str, str], str]:
    """(Command, option) → what it takes, as its help shows it."""
    found = {}
    for name, (module, _) in COMMANDS.items():
        command = getattr(import_module(module), name)
        context = click.Context(command, info_name=name)
        for option in command.params:
            if isinstance(option, click.Option) and not option.is_flag:
                found[name, option.opts[0]] = option.make_metavar(context)
    return found


def test_an_option_takes_the_same_in_every_command() -> None:
    """The same word wherever it is; a unit is the word for numbers of that unit alone."""
    found = options()
    for at, metavar in OTHERWISE.items():
        assert found.pop(at) == metavar
    words: dict[str, set[str]] = {}
    for (_, option), metavar in found.items():
        words.setdefault(option, set()).add(metavar)
    assert {option: word for option, word in words.items() if len(word) > 1} == {}
    assert (words["--size"], words["--rest"]) == ({"FACTOR"}, {"S"})
    assert words["--effects"] == words["--hide"] == {"NAME[,NAME...]"}


def test_logs_are_called_so_in_every_command(softid: Cli) -> None:
    for name in ("inspect", "fit", "diagnose"):
        assert softid(name, "--help").out.startswith(f"Usage: softid {name} [OPTIONS] LOG...")
    assert "missing argument 'LOG...'" in softid("inspect").err


def test_what_validate_writes_is_said(softid: Cli) -> None:
    assert "without it nothing is written" in " ".join(softid("validate", "--help").out.split())


@pytest.mark.parametrize(
    ("arguments", "path"),
    [
        (("fit", "a.csv", "--profile"), "softid fit"),
        (("diagnose", "a.csv", "--effects"), "softid diagnose"),
        (("synthesize", "--hide"), "softid synthesize"),
        (("fit", "--nonsense"), "softid fit"),
        (("--nonsense",), "softid"),
        (("nonsense",), "softid"),
    ],
)
def test_an_error_names_the_help_of_its_command(
    softid: Cli, arguments: tuple[str, ...], path: str
) -> None:
    told = softid(*arguments)
    assert told.code == 2
    assert told.err.endswith(f"; see `{path} --help`.\n")
