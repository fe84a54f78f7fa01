"""Two compiled calls at the same time, or one after the other."""

from __future__ import annotations

import os
import threading

import pytest

from softid.parallel import in_parallel, on_two_threads, sharing


def where() -> int:
    return threading.get_ident()


@pytest.fixture(autouse=True)
def _two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a machine with a second core, whatever this one has."""
    monkeypatch.setattr(sharing, "usable_cores", lambda: 2)
    monkeypatch.setattr(sharing.multiprocessing, "parent_process", lambda: None)


def test_another_thread_takes_the_second_call() -> None:
    """While the first call waits for it, which would never end if it came after."""
    met = threading.Barrier(2, timeout=10.0)
    first, second = on_two_threads(lambda: (met.wait(), where()), lambda: (met.wait(), where()))
    assert first[1] == where() != second[1]


@pytest.mark.parametrize("limit", ["one core", "a worker process", "a part of shared work"])
def test_nothing_is_shared_out_twice(limit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no core is free, or others work beside it, one thread makes both calls in order."""
    if limit == "one core":
        monkeypatch.setattr(sharing, "usable_cores", lambda: 1)
    if limit == "a worker process":
        monkeypatch.setattr(sharing.multiprocessing, "parent_process", lambda: "a parent")
    if limit == "a part of shared work":
        monkeypatch.setattr(sharing._here, "has_part", True)
    assert on_two_threads(where, where) == (where(), where())


def test_a_busy_thread_is_not_waited_for() -> None:
    """The second call is made here after the first one."""
    released = threading.Event()
    busy = sharing._other_thread().submit(released.wait, 10.0)
    try:
        assert on_two_threads(where, where) == (where(), where())
    finally:
        released.set()
    assert busy.result()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="copies of a process need fork")
def test_a_copy_of_the_process_has_no_other_thread() -> None:
    """It makes both calls itself instead of waiting for a thread that did not come along."""
    on_two_threads(where, where)
    assert in_parallel(lambda _: _in_a_copy(), range(2)) == [True, True]


def _in_a_copy() -> bool:
    sharing._here.has_part = False  # as in a copy that nobody of softid made
    try:
        return on_two_threads(where, where)[0] == where()
    finally:
        sharing._here.has_part = True
