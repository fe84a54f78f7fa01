"""What is no fault in a log that has the rows of two recorders."""

from __future__ import annotations

from collections.abc import Sequence

from softid.errors import Issue
from softid.readers.merging import MERGED_ROWS

NO_FAULTS = ("missing-samples", "close-samples")
"""Each row has the reading of one of the two only, and theirs come as close as they happen to."""


def beside_two_recorders(issues: Sequence[Issue]) -> tuple[Issue, ...]:
    """The issues that count: all of them, unless one says that the log has two recorders."""
    if all(issue.code != MERGED_ROWS for issue in issues):
        return tuple(issues)
    return tuple(issue for issue in issues if issue.code not in NO_FAULTS)
