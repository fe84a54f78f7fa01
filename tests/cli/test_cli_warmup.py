"""`softid warmup` where it can do nothing."""

from __future__ import annotations

import os
from collections.abc import Callable

import pytest
from desk import Outcome

from softid_cli import warmup


def test_without_a_folder_to_write_to_it_says_so(
    softid: Callable[..., Outcome], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line with the remedy, exit code 3, and nothing is compiled in vain."""
    monkeypatch.setattr("softid.kernels.cache_folder", lambda: None)
    told = softid("warmup")
    assert (told.code, told.out) == (3, "")
    assert told.err.count("\n") == 1
    assert "NUMBA_CACHE_DIR" in told.err


def test_a_processor_that_it_may_not_use_does_not_count(
    softid: Callable[..., Outcome], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where a container gives the process one processor of eight, no second process is made."""
    done: list[str] = []

    def refused(*_: object, **__: object) -> None:
        raise AssertionError("a second process")

    monkeypatch.setattr(os, "cpu_count", lambda: 8)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0}, raising=False)
    monkeypatch.setattr(warmup, "ProcessPoolExecutor", refused)
    monkeypatch.setattr(warmup, "_jobs", lambda: [("all", lambda: done.append("here"))])
    monkeypatch.setattr(warmup, "_compile_beside", lambda: done.append("beside"))
    assert softid("warmup").code == 0
    assert done == ["here", "beside"]
