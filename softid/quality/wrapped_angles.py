"""Angles that begin again at the end of a turn, in logs that no reader mended."""

from __future__ import annotations

from softid.errors import Issue
from softid.log import Log
from softid.readers.turns import WRAPPED, find_turns, jumps_in_words, turn_of, unwrapping


def wrapped_angles(log: Log) -> tuple[Issue, ...]:
    """What is to be said of outputs that begin again at the end of a turn.

    A log that is made of arrays is taken as it is. Of one from a file the reader has said it, and
    mended what it could.

    Parameters
    ----------
    log
        The recording.
    """
    if any(issue.code == WRAPPED for issue in log.issues):
        return ()
    found = []
    for name in log.outputs:
        channel = log.channels[name]
        turn = turn_of(channel)
        turns = None if turn is None else find_turns(log.time_s, channel.values, turn)
        if turn is None or turns is None or turns.at.size == 0:
            continue
        at_s = log.time_s[turns.at[0]]
        told = jumps_in_words(channel, turns, turn, f"at {at_s:.2f} s")
        found.append(
            Issue(
                WRAPPED,
                "warning",
                f"{name} {told}, as where a sensor begins again at the end of its range",
                unwrapping(channel, turn),
            )
        )
    return tuple(found)
