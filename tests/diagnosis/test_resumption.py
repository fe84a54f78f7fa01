"""An interrupted diagnosis goes on: the same answer, without doing again what was done."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from softid.diagnosis import diagnose
from softid.diagnosis.resumption import resumable
from softid.diagnosis_results import Diagnosis
from softid.errors import UsageError
from softid.log import Log
from softid.models import MODELS
from softid.parallel import in_parallel, sharing
from softid.records import checkpoint
from softid.synthesis import hidden_pair

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no file is kept there")

AT = 0.5
"""Fraction of the work after which the run is interrupted."""


@pytest.fixture(autouse=True)
def _from_the_first_second(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checkpoint, "BEGINS_AFTER_S", 0.0)


@pytest.fixture(scope="module")
def logs() -> tuple[Log, Log]:
    train, hold_out = hidden_pair(["creep"], seed=5).logs
    return train, hold_out


def numbers(found: Diagnosis) -> list[Any]:
    """All that is told in the end."""
    final = found.extended or found.base
    return [found.summary, *((p.name, p.value, p.stderr) for p in final.parameters)]


@pytest.fixture
def shared_out(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many tasks each stage had that this process took part in."""
    counts: list[int] = []
    share = sharing._shared_out

    def counted(work: Any, tasks: Any, *given: Any, **options: Any) -> Any:
        counts.append(len(tasks))
        return share(work, tasks, *given, **options)

    monkeypatch.setattr(sharing, "_shared_out", counted)
    return counts


def test_the_answer_is_that_of_a_run_that_was_not_interrupted(
    logs: Sequence[Log], tmp_path: Path, shared_out: list[int]
) -> None:
    """To the last digit, and what was shared out before the interruption is not done again."""
    file = tmp_path / "run.checkpoint"
    asked: dict[str, Any] = {
        "hold_out": logs[1],
        "model": "muscle",
        "effects": ["creep", "delay", "sensor_lag"],
    }
    whole = diagnose(logs[0], **asked)
    whole_run = list(shared_out)

    def interrupt(message: str, fraction: float) -> None:
        if fraction > AT:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        diagnose(logs[0], **asked, progress=interrupt, checkpoint=file)
    before, told = len(shared_out) - len(whole_run), list[str]()
    assert 0 < before < len(whole_run)
    again = diagnose(
        logs[0], **asked, progress=lambda message, _: told.append(message), checkpoint=str(file)
    )
    assert told[0] == "going on from an interrupted run"
    assert numbers(again) == numbers(whole)
    assert shared_out[len(whole_run) + before :] == whole_run[before:]
    assert not file.exists()


def test_what_a_checkpoint_belongs_to(logs: Sequence[Log], tmp_path: Path) -> None:
    """Another reading, hold-out, model, option, effect or seed: each is another diagnosis."""
    file = tmp_path / "run.checkpoint"
    asked: dict[str, Any] = {
        "logs": logs[0],
        "hold_out": (logs[1],),
        "model": MODELS["muscle"](),
        "effects": ("creep",),
        "seed": 0,
    }

    def interrupted() -> None:
        with resumable(file, asked):
            in_parallel(abs, [1])
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    channels = dict(logs[0].channels)
    readings = channels["contraction"].values.copy()
    readings[1234] += 1e-12
    channels["contraction"] = replace(channels["contraction"], values=readings)
    others: list[dict[str, Any]] = [
        {"logs": replace(logs[0], channels=channels)},
        {"hold_out": ()},
        {"model": MODELS["oscillator"]()},
        {"model": MODELS["muscle"](damping="constant")},
        {"effects": ("creep", "delay")},
        {"seed": 1},
    ]
    for other in others:
        beside = tmp_path / "other.checkpoint"
        beside.write_bytes(file.read_bytes())
        assert not goes_on(beside, asked | other)
    assert goes_on(file, asked | {"model": MODELS["muscle"]()})


def goes_on(file: Path, asked: dict[str, Any]) -> bool:
    with resumable(file, asked) as found:
        return found


@pytest.mark.parametrize("path", [5, "~nobody-of-this-name/run"])
def test_what_is_no_path_is_refused(logs: Sequence[Log], path: Any) -> None:
    with pytest.raises(UsageError, match="no path"):
        diagnose(logs[0], checkpoint=path)
