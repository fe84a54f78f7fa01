"""Samples that depend on what the input did while samples were lost.

Between two samples the input is drawn straight. Where it jumped in a gap nobody knows when, and
what the actuator did until it had settled follows from that: a dozen samples many times larger than
the noise, which no law of motion explains.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.excitation.noise import noise_std
from softid.identification.slow_outputs import SlowOutputLog
from softid.intersample import lost_intervals
from softid.log import Log
from softid.models.base import Model
from softid.results import Simulation
from softid.simulation import simulate

Array = npt.NDArray[np.float64]
Places = npt.NDArray[np.intp]

MATTERS = 0.5
"""Share of the output's noise that the course of the input in the gaps may change."""

MOST_LEFT_OUT = 0.2
"""Largest share of the samples left out because they depend on the lost input: where more do, those
that depend on it the most."""


def without_lost_input(log: Log, model: Model, values: Mapping[str, float]) -> Log:
    """Leave out, and say so, what the input in the gaps may change by more than the noise.

    In the middle of a gap of length g the input may lie to either side of the straight line by
    half of what the slopes before and after it, s, leave of its change: max |Δu − s g| / 2. That is
    half the height of a jump, and nothing where it only goes on.

    Parameters
    ----------
    log
        A log.
    model, values
        A fitted model, which knows how long the actuator remembers.
    """
    gaps = _gaps(log)
    if gaps.size == 0:
        return log
    above, below = (
        simulate(model, values, with_course(log, partial(_through, gaps=gaps, side=side)))
        for side in (1.0, -1.0)
    )
    differs = apart(above, below, log)
    depends = differs > max(MATTERS, float(np.quantile(differs, 1.0 - MOST_LEFT_OUT)))
    if not depends.any():
        return log
    first_s = float(log.time_s[np.flatnonzero(depends)[0]])
    issue = Issue(
        "lost-input",
        "info",
        f"{log.name}: {depends.sum()} samples, from {first_s:.4g} s, depend on what the input did "
        "while samples were lost; they are left out of the residuals",
        "record the input without gaps",
    )
    return replace(log.with_masked(depends), issues=(*log.issues, issue))


def apart(one: Simulation, other: Simulation, log: Log) -> Array:
    """How far two courses are apart at the samples of a log, in units of its noise, shape (n,).

    Parameters
    ----------
    one, other
        Simulations at the same times, which hold those of the log.
    log
        The log.
    """
    recorded = np.searchsorted(one.time_s, log.time_s)
    found = np.zeros(len(log))
    for name in log.outputs:
        measured = log.channels[name].values
        seen = np.isfinite(measured)
        if not seen.any():
            continue
        sigma = noise_std(log.time_s[seen], measured[seen]) or np.finfo(float).tiny
        differs = np.abs(one.outputs[name] - other.outputs[name])[recorded] / sigma
        found = np.fmax(found, differs)
    return found


def with_course(log: Log, change: Callable[[Log], Log]) -> Log:
    """The log with another course of its input; a log of a slow output keeps it with all its rows.

    Parameters
    ----------
    log
        A log.
    change
        Gives a recording another course.
    """
    if isinstance(log, SlowOutputLog):
        return replace(log, recorded=change(log.recorded))
    return change(log)


def with_rows_of(log: Log, time_s: Array, after: Places, input_values: Array) -> Log:
    """The log with rows put in that have an input and no output, for a simulation.

    Parameters
    ----------
    log
        A log.
    time_s, after, input_values
        Times of the rows, the samples behind which they come, and their input, each of shape (m,).
    """
    rows = dict.fromkeys(log.outputs, np.full(after.size, np.nan)) | {log.input: input_values}
    channels = {
        name: replace(channel, values=np.insert(channel.values, after + 1, rows[name]))
        for name, channel in log.channels.items()
        if name in rows
    }
    all_s = np.insert(log.time_s, after + 1, time_s)
    none = np.zeros(all_s.size, bool)
    return replace(log, time_s=all_s, channels=channels, masked=none, issues=())


def _gaps(log: Log) -> Places:
    """Last rows before an interval that has lost others, and is none between two segments."""
    rows_s = log.recorded.time_s if isinstance(log, SlowOutputLog) else log.time_s
    lost = lost_intervals(rows_s)
    found: Places = lost[np.diff(rows_s)[lost] <= log.stall_s]
    return found


def _through(log: Log, gaps: Places, side: float) -> Log:
    """The log with the input to one side of the straight line in the middle of every gap."""
    u = log.channels[log.input].values
    interval_s, change = np.diff(log.time_s), np.diff(u)
    slope = np.pad(change / interval_s, 1, mode="edge")
    led_to = np.stack((slope[:-2], slope[2:])) * interval_s
    aside = 0.5 * np.abs(change - led_to).max(axis=0)
    middle = 0.5 * (u[:-1] + u[1:]) + side * aside
    middle_s = log.time_s[gaps] + 0.5 * interval_s[gaps]
    return with_rows_of(log, middle_s, gaps, middle[gaps])
