"""Making a log's samples usable without inventing any: what is dropped is said.

In a file that was merged from two recorders the input is interpolated between its readings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.errors import InputError, Issue
from softid.readers.merging import with_input_between, with_rows_joined
from softid.readers.samples import Samples
from softid.readers.turns import with_angles_turned_on


def clean(samples: Samples, *, input: str, outputs: Sequence[str]) -> Samples:
    """Drop what cannot be used and refuse what cannot be repaired.

    Samples without time or input are dropped, so that the gap acts as a stall, but for those of
    another recorder (`with_input_between`). Rows that share a time are one if they do not
    contradict each other, as those that repeat the row before; else the first stays. Missing
    outputs stay NaN and leave the residuals.

    Parameters
    ----------
    samples
        As read.
    input, outputs
        The roles.

    Raises
    ------
    InputError
        A role's column is empty, an output was never read while the input was, the time runs
        backward, or fewer than two samples are left.
    """
    for name in (input, *outputs):
        if not np.isfinite(samples.channels[name].values).any():
            raise InputError(
                f"the {name} holds no number at all: {_all_missing(samples)}",
                where=samples.column(name),
                remedy=f"map another column with --channel {name}=COLUMN:UNIT, choose another "
                f"{'input with --input' if name == input else 'output with --output'}, or check "
                "the sensor",
            )
    if not np.isfinite(samples.time_s).any():
        raise InputError(
            f"no sample has a time: {_all_missing(samples)}",
            where=samples.where,
            remedy="map another column with --channel time=COLUMN:s",
        )
    rows = samples.time_s.size
    samples = _drop_missing(samples, np.isfinite(samples.time_s), "time")
    samples = with_rows_joined(samples, (input, *outputs))
    samples = with_input_between(samples, input=input, outputs=outputs)
    _require_common_times(samples, input, outputs)
    samples = _drop_missing(samples, np.isfinite(samples.channels[input].values), input)
    _require_forward(samples)
    samples = with_angles_turned_on(_drop_repeated(samples), outputs)
    if samples.time_s.size < 2:
        raise InputError(
            _too_few(samples, input, rows),
            where=samples.where,
            remedy="record at least two samples with different times",
        )
    missing = [_missing_output(samples, name) for name in outputs]
    return replace(samples, issues=(*samples.issues, *(issue for issue in missing if issue)))


def _require_common_times(samples: Samples, input: str, outputs: Sequence[str]) -> None:
    """Refuse a file in which no output was read while the input was."""
    with_input = np.isfinite(samples.channels[input].values)
    for name in outputs:
        read = np.isfinite(samples.channels[name].values)
        if read.any() and with_input.any() and not (read & with_input).any():
            spans = (samples.time_s[rows] for rows in (read, with_input))
            when, driven = (f"{span.min():.4g} to {span.max():.4g} s" for span in spans)
            raise InputError(
                f"the {name}, read from {when}, has no {input} beside it, which is there from "
                f"{driven}",
                where=samples.column(name),
                remedy="set both recorders to one clock before their files are merged",
            )


def _too_few(samples: Samples, input: str, rows: int) -> str:
    left = samples.time_s.size
    what = "only one sample is left" if left else "no sample is left"
    if rows == left:
        return what
    return f"{what} of {rows}, for the others have no time, no {input} or the time of another"


def _all_missing(samples: Samples) -> str:
    return f"its {samples.rows.size} values are all empty, NaN or infinite"


def _drop_missing(samples: Samples, present: npt.NDArray[np.bool_], name: str) -> Samples:
    missing = np.flatnonzero(~present)
    if not missing.size:
        return samples
    issue = Issue(
        f"missing-{'time' if name == 'time' else 'input'}",
        "warning",
        f"{samples.where}: dropped {missing.size} of {present.size} samples, which have no {name} "
        f"(empty, NaN or infinite), the first in {samples.row(int(missing[0]))}",
        "no action is needed if the gap is short; a long one splits the log",
    )
    return samples.keeping(present, issue)


def _require_forward(samples: Samples) -> None:
    backward = np.flatnonzero(np.diff(samples.time_s) < 0)
    if not backward.size:
        return
    at = int(backward[0]) + 1
    more = f", the first of {backward.size} such places" if backward.size > 1 else ""
    raise InputError(
        f"the time runs backward, from {samples.time_s[at - 1]:.9g} s to "
        f"{samples.time_s[at]:.9g} s{more}",
        where=f"{samples.where}, {samples.row(at)}",
        value=float(samples.time_s[at]),
        remedy="cut the log there into two, or sort its rows if they are only out of order",
    )


def _drop_repeated(samples: Samples) -> Samples:
    later = np.flatnonzero(np.diff(samples.time_s) == 0) + 1
    if not later.size:
        return samples
    same = np.ones(later.size, dtype=bool)
    for channel in samples.channels.values():
        before, now = channel.values[later - 1], channel.values[later]
        same &= (before == now) | (np.isnan(before) & np.isnan(now))
    kept = np.ones(samples.time_s.size, dtype=bool)
    kept[later] = False
    reasons = []
    if same.any():
        reasons.append(
            Issue(
                "duplicate-rows",
                "info",
                f"{samples.where}: dropped {same.sum()} of {kept.size} samples, which repeat the "
                f"one before, the first in {samples.row(int(later[same][0]))}",
            )
        )
    if not same.all():
        reasons.append(
            Issue(
                "duplicate-times",
                "warning",
                f"{samples.where}: dropped {(~same).sum()} of {kept.size} samples, which have the "
                "time of the one before but other values, the first in "
                f"{samples.row(int(later[~same][0]))}",
                "record the time with more digits",
            )
        )
    return samples.keeping(kept, *reasons)


def _missing_output(samples: Samples, name: str) -> Issue | None:
    missing = np.flatnonzero(~np.isfinite(samples.channels[name].values))
    if not missing.size:
        return None
    return Issue(
        "missing-output",
        "info",
        f"{samples.column(name)}: {missing.size} of {samples.time_s.size} samples missing, the "
        f"first in {samples.row(int(missing[0]))}; they are left out of the residuals",
        None,
    )
