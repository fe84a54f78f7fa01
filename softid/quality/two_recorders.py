"""Logs that have the rows of two recorders: what is judged of them, and what is no fault."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from softid.errors import Issue
from softid.log import Log
from softid.readers.merging import MERGED_ROWS

NO_FAULTS = ("missing-samples", "close-samples")
"""Each row has the reading of one of the two only, and theirs come as close as they happen to."""


def at_output_rows(log: Log) -> Log:
    """The log at the rows that have an output, where the rows between are those of the input alone.

    The input is known there from its readings before and after. How evenly the sensor of the
    output samples, and when it answers, is told by its own rows.

    Parameters
    ----------
    log
        Any log; one of a single recorder is returned as it is.
    """
    if all(issue.code != MERGED_ROWS for issue in log.issues):
        return log
    kept = np.any([np.isfinite(log.channels[name].values) for name in log.outputs], axis=0)
    channels = {
        name: replace(channel, values=channel.values[kept])
        for name, channel in log.channels.items()
    }
    return replace(log, time_s=log.time_s[kept], channels=channels, masked=log.masked[kept])


def beside_two_recorders(issues: Sequence[Issue]) -> tuple[Issue, ...]:
    """The issues that count: all of them, unless one says that the log has two recorders."""
    if all(issue.code != MERGED_ROWS for issue in issues):
        return tuple(issues)
    return tuple(issue for issue in issues if issue.code not in NO_FAULTS)
