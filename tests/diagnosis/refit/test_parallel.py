"""Identification shared by cores."""

from __future__ import annotations

import threading
import time

import pytest

from softid.diagnosis.refit import parallel
from softid.diagnosis.refit.parallel import MAX_WORKERS, in_parallel


def test_results_keep_the_order_of_the_items(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first item is the last to be done, and still comes first."""
    monkeypatch.setattr(parallel, "_cores", lambda: 4)

    def work(item: int) -> int:
        time.sleep(0.02 * (4 - item))
        return item**2

    assert in_parallel(work, range(4)) == [0, 1, 4, 9]


def test_one_core_works_in_the_caller_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """No thread is started for nothing; two cores start some."""
    threads = {}
    for cores in (1, 2):
        monkeypatch.setattr(parallel, "_cores", lambda cores=cores: cores)
        threads[cores] = set(in_parallel(lambda item: threading.get_ident(), range(5)))
    assert threads[1] == {threading.get_ident()}
    assert threading.get_ident() not in threads[2]


def test_no_more_workers_than_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a machine of many cores at most eight threads are in the work at a time."""
    monkeypatch.setattr(parallel, "_cores", lambda: 64)
    lock, now, most = threading.Lock(), 0, 0

    def work(item: int) -> int:
        nonlocal now, most
        with lock:
            now += 1
            most = max(most, now)
        time.sleep(0.01)
        with lock:
            now -= 1
        return item

    assert in_parallel(work, range(40)) == list(range(40))
    assert most == MAX_WORKERS


@pytest.mark.parametrize("cores", [1, 3])
def test_an_error_reaches_the_caller(cores: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """An error in a thread is not swallowed."""
    monkeypatch.setattr(parallel, "_cores", lambda: cores)
    with pytest.raises(ZeroDivisionError):
        in_parallel(lambda item: 1 // item, [1, 0, 2])
