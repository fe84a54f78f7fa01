"""What a log's samples are on their way from the table of a file to a log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.channels import Channel
from softid.errors import Issue
from softid.readers.base import Array, IntArray


@dataclass(frozen=True, eq=False)
class Samples:
    """A log's samples while they are made usable.

    Attributes
    ----------
    where
        File, for messages.
    row_word
        What a row number counts.
    rows
        Row of the file of every sample, shape (n,).
    time_s
        Times, shape (n,).
    channels
        Channel name → channel.
    issues
        What was done so far.
    input_read_s, input_read_range
        When the input was read, shape (R,), and the least and the most that was read, where it is
        also known at other samples; else None.
    """

    where: str
    row_word: str
    rows: IntArray
    time_s: Array
    channels: Mapping[str, Channel]
    issues: tuple[Issue, ...] = ()
    input_read_s: Array | None = None
    input_read_range: tuple[float, float] | None = None

    def keeping(self, kept: npt.NDArray[np.bool_], *reasons: Issue) -> Samples:
        """Only some of the samples, and why."""
        channels = {k: replace(c, values=c.values[kept]) for k, c in self.channels.items()}
        return replace(
            self,
            rows=self.rows[kept],
            time_s=self.time_s[kept],
            channels=channels,
            issues=(*self.issues, *reasons),
        )

    def row(self, sample: int) -> str:
        """The file's row of a sample, for messages."""
        return f"{self.row_word} {self.rows[sample]}"

    def column(self, name: str) -> str:
        """File and column of a channel, for messages."""
        return f"{self.where}, column {self.channels[name].column or name}"
