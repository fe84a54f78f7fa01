"""Which held-out samples follow each other in time."""

from __future__ import annotations

import numpy as np

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOut, HeldOutBlocks


def held_out_lengths(held: HeldOut, candidate: Candidate) -> tuple[int, ...]:
    """Samples of the first output in each log, segment and block that is held out, in order.

    Parameters
    ----------
    held
        What is held out.
    candidate
        A fit to the rest; all of them have these samples.

    Returns
    -------
    tuple of int
        They add up to the size of `HeldOut.first_errors`.
    """
    first = candidate.problem.outputs[0]
    if not isinstance(held, HeldOutBlocks):
        return tuple(row.residual.size for row in held.errors(candidate) if row.channel == first)
    found: list[int] = []
    for log, blocks in zip(held.whole, held.blocks, strict=True):
        for segment in log.segments():
            places = np.flatnonzero(blocks[segment.start : segment.stop])
            runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
            used = segment.samples_of(segment.used[first])
            found += [int(np.count_nonzero(used[run])) for run in runs]
    return tuple(length for length in found if length)
