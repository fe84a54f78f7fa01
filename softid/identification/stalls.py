"""Stalls of the clock, through which what remembers goes on.

A fit begins anew behind a stall, at any position and speed, for nobody knows what the input did. A
law that remembers longer than the motion would begin anew, too: a rubber that has softened would be
stiff again, and one that creeps would have settled. So the input is drawn straight through a stall,
and what may depend on its course is left out until the motion has forgotten it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.identification.lost_input import MATTERS, apart, with_course, with_rows_of
from softid.intersample import BEFORE
from softid.log import Log
from softid.models.base import Model
from softid.simulation import parameter_vector, simulate

Array = npt.NDArray[np.float64]

MOST_LEFT_OUT = 0.3
"""Where more than this share of the samples depends on what the input did, every stretch begins
anew: too little would be left of the log."""


def across_stalls(log: Log, model: Model, values: Mapping[str, float]) -> Log:
    """The log as one segment, and say so; itself where too much would depend on the stalls.

    In a stall the input may have been anywhere in its range. What differs between its highest and
    its lowest value by more than the noise is left out.

    Parameters
    ----------
    log
        A log.
    model, values
        A fitted model, which knows how long the motion remembers: a drive without a spring does for
        ever.
    """
    count = len(log.stretches) - 1
    u = log.channels[log.input].values
    if count < 1 or not _has_rest(model, values, u[:1], log.outputs[0]):
        return log
    joined = replace(log, is_bridged=True)
    high, low = (
        simulate(model, values, with_course(joined, partial(_held, level=float(level))))
        for level in (u.max(), u.min())
    )
    depends = apart(high, low, log) > MATTERS
    if np.mean(depends) > MOST_LEFT_OUT:
        return log
    longest_s = float(np.diff(log.time_s).max())
    stalls = "a stall" if count == 1 else f"{count} stalls"
    issue = Issue(
        "bridged-stalls",
        "info",
        f"{log.name}: {log.input} is taken to go straight on through {stalls} of up to "
        f"{longest_s:.3g} s, so that what remembers, such as creep or softening, does not begin "
        f"anew; {depends.sum()} samples that depend on what it did are left out of the residuals",
        "record without stalls",
    )
    return replace(joined.with_masked(depends), issues=(*log.issues, issue))


def as_remembered(log: Log, model: Model, values: Mapping[str, float]) -> Log:
    """The log as a model takes it: across its stalls where effects in it remember longer.

    Parameters
    ----------
    log
        A log.
    model, values
        A fitted model, which may have effects.
    """
    motion = model.without_effects
    if motion is model:
        return log
    return across_stalls(log, motion, {name: values[name] for name in motion.parameters().names})


def _has_rest(model: Model, values: Mapping[str, float], u: Array, output: str) -> bool:
    """Whether a motion comes to rest at an input, shape (1,), and so can be simulated from one."""
    rest = model.static_output(parameter_vector(model, values), u, output)
    return bool(np.isfinite(rest[0]))


def _held(log: Log, level: float) -> Log:
    """The log with the input at one level throughout every stall, for a simulation."""
    length_s = np.diff(log.time_s)
    stalls = np.flatnonzero(length_s > log.stall_s)
    aside_s = BEFORE * length_s[stalls]
    ends_s = np.column_stack((log.time_s[stalls] + aside_s, log.time_s[stalls + 1] - aside_s))
    held = np.full(ends_s.size, level)
    return with_rows_of(log, ends_s.ravel(), np.repeat(stalls, 2), held)
