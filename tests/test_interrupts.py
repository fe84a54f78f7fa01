"""Ctrl-C waits for the end of a block, and then does what it does in this program."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest

from softid.interrupts import uninterrupted


@pytest.fixture(autouse=True)
def handler_as_before() -> Iterator[None]:
    before = signal.getsignal(signal.SIGINT)
    yield
    signal.signal(signal.SIGINT, before)


def test_it_counts_at_the_end() -> None:
    """Once, however often it was pressed, and by the program's own handler, which is back."""
    heard: list[int] = []

    def hear(number: int, frame: object) -> None:
        heard.append(number)

    signal.signal(signal.SIGINT, hear)
    with uninterrupted():
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
        assert not heard
    assert heard == [signal.SIGINT]
    assert signal.getsignal(signal.SIGINT) is hear
    with uninterrupted():
        pass
    assert heard == [signal.SIGINT]


def interrupted_and_failing() -> None:
    with uninterrupted():
        signal.raise_signal(signal.SIGINT)
        raise OSError("the disk is full")


def test_it_counts_where_the_block_fails() -> None:
    """The usual handler raises; what failed is told as what was under way."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with pytest.raises(KeyboardInterrupt) as caught:
        interrupted_and_failing()
    assert isinstance(caught.value.__context__, OSError)


def test_who_is_deaf_to_it_stays_so() -> None:
    """A program that runs in the background ignores it, and hears of the failure alone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with pytest.raises(OSError, match="disk is full"):
        interrupted_and_failing()


def test_another_thread_is_never_interrupted() -> None:
    before = signal.getsignal(signal.SIGINT)

    def inside() -> object:
        with uninterrupted():
            return signal.getsignal(signal.SIGINT)

    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(inside).result() is before
