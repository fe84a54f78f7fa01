"""What the README says the program prints, the program prints."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from softid.errors import (
    IdentificationError,
    InputError,
    MissingExtraError,
    OutputError,
    UsageError,
)
from softid.models import MODELS
from softid_cli import console
from softid_cli.main import COMMANDS, run

TESTS = Path(__file__).resolve().parent
README = (TESTS.parent / "README.md").read_text(encoding="utf-8")
HELP = re.compile(r"<!-- help: softid (.*?) -->\n```\n(.*?)```\n<!-- /help -->", re.DOTALL)


@pytest.mark.parametrize(("arguments", "printed"), HELP.findall(README))
def test_help_is_the_programs(
    arguments: str,
    printed: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Character by character at 80 columns."""
    monkeypatch.setenv("COLUMNS", "80")
    assert run(arguments.split()) == 0
    assert capsys.readouterr().out == printed


def test_the_main_help_is_there() -> None:
    """The comparison above would pass on a README without any help."""
    assert [arguments for arguments, _ in HELP.findall(README)] == ["--help"]


def test_every_exit_code_is_explained() -> None:
    """The table has exactly the codes that the program can return."""
    explained = {int(code) for code in re.findall(r"^\| (\d+) \| ", README, re.MULTILINE)}
    classes = (UsageError, MissingExtraError, InputError, OutputError, IdentificationError)
    ends = {console.INTERRUPTED, console.BROKEN_PIPE, console.UNEXPECTED, console.BAD_OUTPUT}
    assert explained == {0, 1} | ends | {c.exit_code for c in classes}


def test_commands_and_models_are_named() -> None:
    """A command or model that the README does not know is not there for its reader."""
    for name in COMMANDS:
        assert f"softid {name}" in README
    for name in MODELS:
        assert f"| `{name}` |" in README


def test_it_can_be_read_in_one_go() -> None:
    """The length that was promised to the reader."""
    assert len(README.splitlines()) <= 300


def test_no_placeholder_is_left() -> None:
    """Capitals alone on a line were notes to the writer."""
    assert not re.findall(r"^[A-Z]{4,}$|```\n```", README, re.MULTILINE)


def test_every_folder_and_helper_of_the_tests_is_placed() -> None:
    """tests/README.md names what mirrors no module of softid, and what several tests share."""
    placed = (TESTS / "README.md").read_text(encoding="utf-8")
    for helper in (TESTS / "support").glob("*.py"):
        assert f"`{helper.stem}`" in placed, helper.name
    for folder in TESTS.glob("*/"):
        if any(folder.glob("*.py")) and not (TESTS.parent / "softid" / folder.name).is_dir():
            assert f"{folder.name}/`" in placed, folder.name
