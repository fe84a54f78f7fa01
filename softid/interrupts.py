"""Ctrl-C in the middle of what must not be left half done."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Keep an interrupt until the block ends, also one that fails; then it counts as it would have.

    Only the main thread can be interrupted. A copy of the process that is made within the block
    does not know at once that it is one, so it keeps to itself what it notes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    process, noted = os.getpid(), list[int]()
    before = signal.signal(signal.SIGINT, lambda number, _: noted.append(number))
    try:
        yield
    finally:
        if os.getpid() == process:
            signal.signal(signal.SIGINT, signal.SIG_DFL if before is None else before)
            if noted:
                signal.raise_signal(signal.SIGINT)
