"""Which clock the messages of a bag are timed by, and the rows that their times make."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.readers.bag_messages import TopicRecord
from softid.readers.base import Array, IntArray, first_names

Nanoseconds = npt.NDArray[np.int64]

SAME_CLOCK_NS = 10**9
"""Median difference of stamp and receipt from which they are of two clocks: a message is on its
way for milliseconds, and clocks that nobody set differ by minutes or years."""

AHEAD_NS = 10**7
"""Median time by which stamps may be ahead of their receipt: clocks that are kept alike differ by
milliseconds, and no message comes before it was sent."""

_PER_SECOND = 1e9


@dataclass(frozen=True, eq=False)
class Rows:
    """The sorted union of the messages' times.

    Attributes
    ----------
    seconds
        Time of every row since the first one, shape (n,).
    of_topic
        Per topic the row of each of its messages.
    """

    seconds: Array
    of_topic: tuple[IntArray, ...]


def chosen_times(
    records: Sequence[TopicRecord], path: str
) -> tuple[list[Nanoseconds], tuple[Issue, ...]]:
    """The time of every message of every topic, and what is to be said of them.

    That is the stamp in a message's header where all headers have one and these are of the
    recorder's clock, else the time at which the recorder received it: of two clocks, one topic
    would come earlier or later than another by their difference. A topic without headers has no
    other time than its receipt.

    Parameters
    ----------
    records
        Topics that hold numbers, each with at least one message.
    path
        File, for messages.
    """
    received = [np.asarray(record.received_ns, dtype=np.int64) for record in records]
    stamped = [record for record in records if record.layout.is_stamped]
    if not stamped:
        return received, ()
    doubts = [doubt for doubt in map(_doubt, stamped) if doubt is not None]
    if doubts:
        return received, (_by_receipt(path, doubts),)
    times = [
        np.asarray(record.stamps_ns, dtype=np.int64) if record.layout.is_stamped else at
        for record, at in zip(records, received, strict=True)
    ]
    others = [record.topic for record in records if not record.layout.is_stamped]
    return times, (_by_both(path, others),) if others else ()


def rows_of(times: Sequence[Nanoseconds]) -> Rows:
    """One row for each time at which a message of any topic stands.

    Messages of different topics at one time share a row; those of one topic do not.

    Parameters
    ----------
    times
        Per topic the times of its messages in ns.
    """
    repeats = np.concatenate([_earlier_of_same_time(t) for t in times])
    every = np.concatenate(times)
    order = np.lexsort((repeats, every))
    is_new = np.ones(every.size, dtype=bool)
    is_new[1:] = (np.diff(every[order]) != 0) | (np.diff(repeats[order]) != 0)
    row = np.empty(every.size, dtype=np.intp)
    row[order] = np.cumsum(is_new) - 1
    row_ns = every[order][is_new]
    ends = np.cumsum([t.size for t in times])[:-1]
    return Rows((row_ns - row_ns[0]) / _PER_SECOND, tuple(np.split(row, ends)))


def _earlier_of_same_time(times: Nanoseconds) -> IntArray:
    """How many messages of the same topic and time come before each."""
    order = np.argsort(times, kind="stable")
    ordered = times[order]
    first = np.searchsorted(ordered, ordered)
    count = np.empty(times.size, dtype=np.intp)
    count[order] = np.arange(times.size) - first
    return count


def _doubt(record: TopicRecord) -> str | None:
    """Why the stamps of a topic are not its times; None where they are."""
    stamps = np.asarray(record.stamps_ns, dtype=np.int64)
    zeros = int(np.count_nonzero(stamps == 0))
    if zeros:
        return f"{zeros} of {stamps.size} stamps of {record.topic} are zero"
    received = np.asarray(record.received_ns, dtype=np.int64)
    apart_ns = float(np.median(received.astype(float) - stamps.astype(float)))
    if -AHEAD_NS < apart_ns < SAME_CLOCK_NS:
        return None
    side = "before" if apart_ns > 0.0 else "after"
    return (
        f"the stamps of {record.topic} are {abs(apart_ns) / _PER_SECOND:.3g} s {side} their receipt"
    )


def _by_receipt(path: str, doubts: Sequence[str]) -> Issue:
    more = f", and {len(doubts) - 1} more topics" if len(doubts) > 1 else ""
    return Issue(
        "times-of-receipt",
        "info",
        f"{path}: all messages are timed by when the recorder received them, since {doubts[0]}"
        f"{more}",
        "have the headers stamped by the recorder's clock if the time on the way matters",
    )


def _by_both(path: str, others: Sequence[str]) -> Issue:
    return Issue(
        "times-of-receipt",
        "info",
        f"{path}: {first_names(others)} {'have' if len(others) > 1 else 'has'} no header, so the "
        "time is when the recorder received the message; elsewhere it is the stamp in the header",
        "a message's time on the way looks like a delay of the actuator: use messages with headers",
    )
