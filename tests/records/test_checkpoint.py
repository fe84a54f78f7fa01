"""What an interrupted run has shared out and done, a later one with the same data need not do."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from softid.errors import UsageError
from softid.parallel import in_parallel, in_step, kept_in, sharing
from softid.records import checkpoint
from softid.records.checkpoint import Checkpoint, is_in_use

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no file is kept there")

CORES = [1, pytest.param(2, marks=pytest.mark.skipif(sys.platform != "linux", reason="no fork"))]

STAGES = 4
"""How often something is shared out in a run."""

TASKS = 3
"""Tasks of each stage."""


@dataclass(frozen=True, eq=False)
class Level:
    """What a stage works with, and what its results refer to."""

    values: np.ndarray
    gain: float = 1.0


class Rig:
    """A run of some stages in a file of its own, and how many tasks it did itself."""

    def __init__(self, folder: Path) -> None:
        self.file = folder / "deep" / "run.checkpoint"
        self._done = folder / "done"
        self._done.touch()

    def run(
        self, *, key: str = "k", gain: float = 1.0, stop: Callable[[int], None] | None = None
    ) -> tuple[float, int]:
        """Each stage works with what the one before gave, and adds its number to all values."""
        level = Level(np.zeros(500), gain)
        before = self.tasks
        with Checkpoint(self.file, key) as kept, kept_in(kept), in_step():
            for stage in range(STAGES):
                if stop is not None:
                    stop(stage)
                level = self._stage(level, stage)
        return float(level.values[7]), self.tasks - before

    @property
    def tasks(self) -> int:
        return self._done.stat().st_size

    def _stage(self, level: Level, stage: int) -> Level:
        def work(number: int) -> tuple[Level, Level]:
            with self._done.open("ab") as done:
                done.write(b".")
            return level, Level(level.values + level.gain * stage, level.gain)

        results = in_parallel(work, range(number_of(stage)))
        assert all(old is level for old, _ in results)
        return results[-1][1]


def number_of(stage: int) -> int:
    return TASKS + stage


def interrupts_at(last: int) -> Callable[[int], None]:
    def stop(stage: int) -> None:
        if stage == last:
            raise KeyboardInterrupt

    return stop


@pytest.fixture(params=CORES)
def rig(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Rig:
    monkeypatch.setattr(sharing, "usable_cores", lambda: request.param)
    monkeypatch.setattr(checkpoint, "BEGINS_AFTER_S", 0.0)
    return Rig(tmp_path)


TOTAL = sum(map(number_of, range(STAGES)))
ANSWER = float(sum(range(STAGES)))


def interrupted(rig: Rig, at: int, *, gain: float = 1.0) -> None:
    with pytest.raises(KeyboardInterrupt):
        rig.run(stop=interrupts_at(at), gain=gain)


def test_a_run_goes_on_where_it_was(rig: Rig) -> None:
    """Two stages of 3 and 4 tasks were done; the same answer comes from the other 5 and 6."""
    interrupted(rig, 2)
    assert rig.tasks == 7
    assert rig.run() == (ANSWER, 11)
    assert not rig.file.exists()
    assert rig.run() == (ANSWER, TOTAL)


def test_it_may_be_interrupted_again(rig: Rig) -> None:
    """What was taken from the file stays in it, and what is new is added."""
    interrupted(rig, 1)
    interrupted(rig, 1)
    interrupted(rig, 3)
    assert rig.tasks == 3 + 9
    assert rig.run() == (ANSWER, 6)


def test_other_data_or_another_program_begin_anew(rig: Rig) -> None:
    """The key says what they are; nothing of the others is mixed in, and the file is theirs."""
    interrupted(rig, 3)
    assert rig.run(key="other") == (ANSWER, TOTAL)
    assert not rig.file.exists()


def test_another_way_through_the_program_goes_on_by_itself(rig: Rig) -> None:
    """Though the key is the same: what could be reached at the first place was another gain."""
    interrupted(rig, 3, gain=2.0)
    interrupted(rig, 2)
    assert rig.run() == (ANSWER, 11)


@pytest.mark.parametrize("damage", ["cut", "changed", "header"])
def test_what_cannot_be_read_is_done_again(rig: Rig, damage: str) -> None:
    """A run killed while it wrote, or a disk that forgets: the stage before still counts."""
    interrupted(rig, 2)
    data = bytearray(rig.file.read_bytes())
    if damage == "cut":
        del data[-10:]
    else:
        data[-10 if damage == "changed" else len(checkpoint.MARK) + 1] ^= 1
    rig.file.write_bytes(data)
    assert rig.run() == (ANSWER, TOTAL if damage == "header" else TOTAL - 3)


def test_a_failure_leaves_nothing(rig: Rig) -> None:
    """It would only fail again."""

    def stop(stage: int) -> None:
        if stage == 3:
            raise ValueError

    with pytest.raises(ValueError):
        rig.run(stop=stop)
    assert not rig.file.exists()


def test_a_task_that_fails_is_done_again(rig: Rig) -> None:
    """Its stage is not kept; the failure reaches who catches it in both runs."""

    def work(number: int) -> int:
        if number == 1:
            raise ZeroDivisionError
        return number

    def run(*, is_first: bool) -> list[int]:
        with Checkpoint(rig.file, "k") as kept, kept_in(kept), in_step():
            with pytest.raises(ZeroDivisionError):
                in_parallel(work, range(3))
            squares = in_parallel(lambda number: number**2, range(4))
            if is_first:
                raise KeyboardInterrupt
        return squares

    with pytest.raises(KeyboardInterrupt):
        run(is_first=True)
    assert run(is_first=False) == [0, 1, 4, 9]


def test_short_runs_write_no_file(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checkpoint, "BEGINS_AFTER_S", 1e6)
    interrupted(rig, 3)
    assert not rig.file.parent.exists()


def test_a_run_beside_it_keeps_nothing(rig: Rig) -> None:
    """Both find their answer, and the file belongs to who took it first."""
    interrupted(rig, 2)
    with Checkpoint(rig.file, "k") as first:
        assert first.goes_on
        assert rig.run() == (ANSWER, TOTAL)
        assert rig.file.exists()
    assert not rig.file.exists()


def test_a_full_disk_stops_no_run(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checkpoint, "MOST_BYTES", 10)
    interrupted(rig, 2)
    assert not rig.file.exists()
    assert rig.run() == (ANSWER, TOTAL)


def test_a_folder_that_cannot_be_made_stops_no_run(rig: Rig) -> None:
    rig.file.parent.write_text("a file where the folder would be")
    interrupted(rig, 2)
    assert rig.run() == (ANSWER, TOTAL)


@pytest.mark.parametrize("content", ["time,pressure\n", ""])
def test_the_users_own_file_is_not_touched(rig: Rig, content: str) -> None:
    """It would be overwritten, and removed at the end; so would an empty one."""
    rig.file.parent.mkdir()
    rig.file.write_text(content)
    with pytest.raises(UsageError, match="no checkpoint of softid"):
        rig.run()
    assert rig.file.read_text() == content


def test_nothing_but_a_file_is_taken(rig: Rig) -> None:
    """Neither a folder nor a pipe, which reads as empty as a device does."""
    rig.file.mkdir(parents=True)
    with pytest.raises(UsageError, match="no checkpoint of softid"):
        rig.run()
    rig.file.rmdir()
    os.mkfifo(rig.file)
    with pytest.raises(UsageError, match="no checkpoint of softid"):
        rig.run()
    assert rig.file.is_fifo()


def test_whether_a_run_uses_it(rig: Rig) -> None:
    assert not is_in_use(rig.file)
    interrupted(rig, 2)
    assert not is_in_use(rig.file)
    with Checkpoint(rig.file, "k"):
        assert is_in_use(rig.file)
