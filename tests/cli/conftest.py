"""The command line called in this process, with the library's work replaced where a test says."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from desk import Desk, Outcome
from handmade import fit_result, step_log

from softid.log import Log
from softid.records import save_fit
from softid_cli.main import run


@pytest.fixture
def softid(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[..., Outcome]:
    """Run `softid …` in an empty folder.

    It never says that it compiles: whether it has to depends on what ran on this machine before.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("softid.kernels.when_compiling", lambda _: nullcontext())

    def call(*arguments: str | Path) -> Outcome:
        capsys.readouterr()
        code = run([str(a) for a in arguments])
        captured = capsys.readouterr()
        return Outcome(code, captured.out, captured.err)

    return call


@pytest.fixture
def params(tmp_path: Path) -> Path:
    """The file of a hand-made fit."""
    save_fit(fit_result(), tmp_path / "params.json")
    return tmp_path / "params.json"


@pytest.fixture
def unfinished(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where interrupted runs are kept, in the place of the user's cache folder."""
    folder = tmp_path_factory.mktemp("cache") / "unfinished"
    monkeypatch.setattr("softid_cli.unfinished.unfinished_folder", lambda: folder)
    return folder


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch, unfinished: Path) -> Desk:
    """Loading gives a hand-made log of the file's name; fitting gives a hand-made result."""
    del unfinished
    desk = Desk({}, fit_result())
    fake = ModuleType("softid.identification")
    fake.fit = desk.fit  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "softid.identification", fake)

    def load(path: Path, **options: Any) -> Log:
        desk.asked["load"] = options
        return step_log(Path(path).stem)

    monkeypatch.setattr("softid.readers.load", load, raising=False)
    monkeypatch.setattr("softid.plots.png_files", lambda _: {"fit.png": b"\x89PNG"})
    return desk
