"""Copies that are lost on the way: what they leave undone is done all the same."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable

import pytest

from softid.parallel import team
from softid.parallel.team import Team

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="no fork here")

SIZE = 3


def in_team(script: Callable[[Team], list[int]]) -> list[int]:
    """What the first member finds."""
    members = Team(SIZE)
    try:
        return script(members)
    finally:
        members.end()


def slow(k: int) -> int:
    time.sleep(0.02)
    return k


def test_a_copy_that_is_killed_ends_the_team() -> None:
    """The first process keeps what it has done and is told of nothing else."""

    def script(members: Team) -> list[int]:
        if members.is_copy:
            os.kill(os.getpid(), signal.SIGKILL)
        done, _ = members.share(slow, range(6))
        return [*done, members.is_alone]

    assert in_team(script)[-1]


def test_a_copy_that_means_something_else_is_given_up() -> None:
    """As many tasks, but with another number in them: its results belong to none of ours."""

    def script(members: Team) -> list[int]:
        own = 100 if members.is_copy else 0
        done, _ = members.share(slow, [own + k for k in range(6)])
        assert all(number == k for k, number in done.items())
        return [members.is_alone]

    assert in_team(script) == [True]


def test_a_copy_that_shares_nothing_more_is_given_up() -> None:
    """It has come to the end of its work; nobody waits for it."""

    def script(members: Team) -> list[int]:
        if members.is_copy:
            return []
        done, _ = members.share(slow, range(6))
        return [*sorted(done), members.is_alone]

    *done, is_alone = in_team(script)
    assert is_alone
    assert done == list(range(6))


def test_a_copy_that_hangs_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """As one does that waits for a lock which a thread held that is not there."""
    monkeypatch.setattr(team, "LEAST_PATIENCE_S", 0.5)

    def script(members: Team) -> list[int]:
        if members.is_copy:
            time.sleep(60.0)
        done, _ = members.share(slow, range(6))
        return [*sorted(done), members.is_alone]

    began = time.monotonic()
    *done, is_alone = in_team(script)
    assert is_alone
    assert done == list(range(6))
    assert time.monotonic() - began < 30.0


def test_copies_do_not_work_for_a_process_that_has_ended() -> None:
    """Killed while many tasks are left, which the copies could go on with."""
    told, telling = os.pipe()
    first = os.fork()
    if first == 0:
        Team(SIZE).share(lambda _: (os.write(telling, b"."), time.sleep(0.1)), range(100))
        os._exit(1)
    os.close(telling)
    for _ in range(SIZE):
        assert os.read(told, 1) == b"."
    os.kill(first, signal.SIGKILL)
    os.waitpid(first, 0)
    done = 0
    while os.read(told, 1):  # until all who could write have ended
        done += 1
    os.close(told)
    assert done < 20


def test_a_copy_ends_when_the_first_process_does() -> None:
    """Killed without a chance to end them, it leaves nobody behind."""
    told, telling = os.pipe()
    first = os.fork()
    if first == 0:
        members = Team(SIZE)
        members.share(lambda k: os.write(telling, b"."), range(1))
        if not members.is_copy:
            os.kill(os.getpid(), signal.SIGKILL)
        members.share(slow, range(6))
        os._exit(1)
    os.close(telling)
    os.waitpid(first, 0)
    assert os.read(told, 1) == b"."
    assert not os.read(told, 1)  # all who could write have ended
    os.close(told)
