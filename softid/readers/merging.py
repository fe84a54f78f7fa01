"""Files that were merged from two recorders: rows of an output that have no input of their own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from softid.errors import Issue
from softid.intersample import course_at
from softid.log import stall_of
from softid.readers.base import Array, IntArray, Table, first_names
from softid.readers.samples import Samples
from softid.sentences import listed

MERGED_ROWS = "merged-rows"
"""Code of the remark that a file has the rows of two recorders."""

MERGED = 0.25
"""Share of the outputs' readings without an input from which two recorders made the file; fewer are
rows in which the input was lost."""

LEAST_ROWS = 10
"""Fewest rows of the other recorder that are a record."""


def with_rows_of(samples: Samples, table: Table, roles: Sequence[str]) -> Samples:
    """The samples without rows in which the file has no cell for any role.

    Such a row was not lost: it is a message of a topic that no role needs.

    Parameters
    ----------
    samples
        All rows of the table.
    table
        The file's table.
    roles
        Input and outputs. Other channels without a number in the rows that are left go with them.
    """
    kept = table.rows_with([samples.channels[name].column or name for name in roles])
    if kept is None or kept.all():
        return samples
    inside = samples.keeping(kept)
    empty = [
        name
        for name, channel in inside.channels.items()
        if name not in roles and not np.isfinite(channel.values).any()
    ]
    if not empty:
        return inside
    columns = [samples.channels[name].column or name for name in empty]
    issue = Issue(
        "column-left-out",
        "info",
        f"{samples.where}: left out {first_names(columns)}, without a number at the times of "
        f"{listed(roles)}",
        "make one of them the input or an output if it is meant",
    )
    channels = {name: c for name, c in inside.channels.items() if name not in empty}
    return replace(inside, channels=channels, issues=(*inside.issues, issue))


def with_rows_joined(samples: Samples, roles: Sequence[str]) -> Samples:
    """The samples with rows of one time as one, where they hold different channels of some.

    Parameters
    ----------
    samples
        Rows with a time.
    roles
        Names of the channels that count: where one has two values at one time, all its rows stay.
        Of the others, such as a number that each recorder counts up, the least value is kept.
    """
    starts = np.flatnonzero(np.diff(samples.time_s, prepend=-np.inf) != 0.0)
    if starts.size == samples.time_s.size:
        return samples
    sizes = np.diff(starts, append=samples.time_s.size)
    joins, contradicts = (np.zeros(starts.size, bool) for _ in range(2))
    values = {}
    for name, channel in samples.channels.items():
        values[name] = np.fmin.reduceat(channel.values, starts)
        if name in roles:
            counts = np.add.reduceat(np.isfinite(channel.values).astype(int), starts)
            joins |= (counts > 0) & (counts < sizes)
            highest = np.fmax.reduceat(channel.values, starts)
            contradicts |= (counts > 0) & (values[name] != highest)
    joined = joins & ~contradicts
    channels = {}
    for name, channel in samples.channels.items():
        at_starts = np.where(joined, values[name], channel.values[starts])
        channels[name] = replace(channel, values=_with(channel.values, starts, at_starts))
    kept = np.repeat(~joined, sizes)
    kept[starts] = True
    return replace(samples, channels=channels).keeping(kept)


def with_input_between(samples: Samples, *, input: str, outputs: Sequence[str]) -> Samples:
    """The samples with an input at the rows of another recorder, where it is read before and after.

    Parameters
    ----------
    samples
        Rows with a time, of which some have no input.
    input, outputs
        The roles.

    Returns
    -------
    Samples
        As they were, unless a quarter of the outputs' readings have no input. Rows in a stall of
        the input, and those before and after its record, stay without.
    """
    values = samples.channels[input].values
    is_read = np.isfinite(values)
    if is_read.all() or int(is_read.sum()) < 2 or np.any(np.diff(samples.time_s) < 0.0):
        return samples
    with_output = np.any([np.isfinite(samples.channels[name].values) for name in outputs], axis=0)
    read_s, first = np.unique(samples.time_s[is_read], return_index=True)
    read, interval_s = values[is_read][first], np.diff(read_s)
    stalls = np.flatnonzero(interval_s > stall_of(float(np.median(interval_s)))) + 1
    filled = values.copy()
    for start, stop in pairwise((0, *stalls.tolist(), read_s.size)):
        span_s = read_s[start:stop]
        within = (samples.time_s >= span_s[0]) & (samples.time_s <= span_s[-1])
        at = np.flatnonzero(with_output & ~is_read & within)
        filled[at] = course_at(samples.time_s[at], span_s, read[start:stop])
    alone = np.flatnonzero(np.isfinite(filled) & ~is_read)
    if alone.size < max(LEAST_ROWS, MERGED * int(with_output.sum())):
        return samples
    issue = Issue(
        MERGED_ROWS,
        "info",
        f"{samples.where}: {alone.size} rows have {listed(outputs)} without {input}, the "
        f"first in {samples.row(int(alone[0]))}; there the {input} is taken as smooth between its "
        "readings, and as straight where it jumps",
    )
    channels = {**samples.channels, input: replace(samples.channels[input], values=filled)}
    return replace(
        samples,
        channels=channels,
        issues=(*samples.issues, issue),
        input_read_s=read_s,
        input_read_range=(float(read.min()), float(read.max())),
    )


def _with(values: Array, at: IntArray, new: Array) -> Array:
    changed = values.copy()
    changed[at] = new
    return changed
