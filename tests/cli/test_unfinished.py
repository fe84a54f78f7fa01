"""An interrupted diagnosis is kept where the same command finds it."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from desk import Desk, Outcome

from softid.log import Log
from softid.records.checkpoint import GOES_ON
from softid_cli.unfinished import DAYS, MOST, SUFFIX

Cli = Callable[..., Outcome]


@pytest.fixture
def kept(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Files that diagnoses were to keep themselves in; each begins its file and is interrupted."""
    files: list[Path] = []

    def diagnose(
        logs: Sequence[Log], *, checkpoint: Path, progress: Any = None, **options: Any
    ) -> None:
        files.append(checkpoint)
        if progress is not None and checkpoint.exists():
            progress(GOES_ON, 0.0)
        checkpoint.parent.mkdir(exist_ok=True)
        checkpoint.touch()
        raise KeyboardInterrupt

    fake = ModuleType("softid.diagnosis")
    fake.diagnose = diagnose  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "softid.diagnosis", fake)
    return files


def test_the_same_command_finds_its_file(softid: Cli, kept: list[Path]) -> None:
    """Where results go and what is printed is no matter; what is asked and of which log is."""
    given = ("diagnose", "a.csv", "--quiet")
    for more in ((), ("--out", "there"), ("--no-plots",), ("--seed", "1"), ("--model", "muscle")):
        told = softid(*given, *more)
        assert told.code == 130
        assert f"the same command again to go on from here ({kept[-1]} has" in told.err
    softid("diagnose", "b.csv", "--quiet")
    assert len(set(kept[:3])) == 1
    assert len(set(kept)) == 4


def test_a_run_that_goes_on_says_so(softid: Cli, kept: list[Path]) -> None:
    """At once, however short it is; with --quiet nothing is said."""
    assert "going on" not in softid("diagnose", "a.csv").err
    assert "info: going on from an interrupted run\n" in softid("diagnose", "a.csv").err
    assert "going on" not in softid("diagnose", "a.csv", "--quiet").err


def test_old_and_many_ones_are_removed(softid: Cli, kept: list[Path], unfinished: Path) -> None:
    """The newest stay beside that of this run, and none for longer than a week."""
    unfinished.mkdir()
    now = time.time()
    for days in (0, 1, 2, 3, DAYS + 1):
        file = unfinished / f"{days}{SUFFIX}"
        file.touch()
        os.utime(file, (now - days * 86400.0,) * 2)
    (unfinished / "notes.txt").touch()
    softid("diagnose", "a.csv", "--quiet")
    left = {file.name for file in unfinished.iterdir()} - {kept[-1].name, "notes.txt"}
    assert left == {f"{days}{SUFFIX}" for days in range(MOST - 1)}
    assert (unfinished / "notes.txt").exists()
    os.utime(unfinished / f"0{SUFFIX}", (now - (DAYS + 1) * 86400.0,) * 2)
    softid("diagnose", "a.csv", "--quiet")
    assert not (unfinished / f"0{SUFFIX}").exists()
