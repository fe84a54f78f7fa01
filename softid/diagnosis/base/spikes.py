"""Single readings far off those beside them, which only a fit tells from a quick motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import BaseFit, Recordings
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.single_spikes import pairs_in, spikes_in
from softid.errors import Issue
from softid.log import Log

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

SPIKES = "spikes"
"""Code of the remark that spikes of an output are left out."""

SPIKE_ROUNDS = 3
"""Where a spike is taken out, the one beside it shows."""

JUMP, NEAR_JUMP = 0.02, 5
"""An input that moves by so large a share of its range between samples may leave two samples far
off by itself, up to so many samples later."""

MOST_SPIKES = 0.01
"""Where a larger share of a log would be spikes they are its noise."""


def without_spikes(recordings: Recordings, base: BaseFit) -> Recordings:
    """The logs whose spikes are left out of the residuals; the same object where there are none.

    A sensor that loses a reading now and then is no misfit, and a few such readings outweigh the
    noise of a whole log.

    Parameters
    ----------
    recordings
        The logs.
    base
        A fit to them.
    """
    marks: dict[str, BoolArray] = {}
    for candidate in (base.candidate, base.held_out.standing(base.candidate)):
        if candidate is not None:
            marks |= _marked(candidate)
    return recordings.each(lambda log: _without(log, marks.get(log.name)))


def _marked(candidate: Candidate) -> dict[str, BoolArray]:
    """Log → samples whose residual is far off those of both neighbours, shape (n,)."""
    problem, z = candidate.problem, candidate.minimum.point
    first = problem.outputs[0]
    marks = {log.name: np.zeros(len(log), np.bool_) for log in problem.logs}
    for k, segment in enumerate(problem.segments):
        residual = segment.outputs[first] - problem.response(z, k).outputs[first]
        residual = segment.samples_of(residual)
        known = np.flatnonzero(np.isfinite(residual))
        pairs = pairs_in(residual[known], _is_still(segment.samples_of(segment.input))[known])
        marks[segment.log_name][segment.start + known[pairs]] = True
        known = known[~pairs]
        for _ in range(SPIKE_ROUNDS):
            far_off = spikes_in(residual[known])
            far_off[:1] = far_off[-1:] = False  # one neighbour says too little
            marks[segment.log_name][segment.start + known[far_off]] = True
            known = known[~far_off]
    return marks


def _is_still(u: Array) -> BoolArray:
    """Samples about which the input does not jump, shape (n,)."""
    jumps = np.abs(np.diff(u)) > JUMP * float(np.ptp(u))
    near = np.convolve(jumps, np.ones(2 * NEAR_JUMP + 1), "full")[NEAR_JUMP:][: u.size] > 0.0
    return ~near


def _without(log: Log, spikes: BoolArray | None) -> Log:
    if spikes is None or spikes.size != len(log):
        return log
    new = spikes & ~log.masked
    count = int(new.sum())
    if count == 0 or count > MOST_SPIKES * len(log):
        return log
    first_s = float(log.time_s[np.flatnonzero(new)[0]])
    readings, are = ("reading", "is") if count == 1 else ("readings", "are")
    issue = Issue(
        SPIKES,
        "info",
        f"{log.name}: {count} {readings} of {log.outputs[0]} {are} far off those before and "
        f"after, at {first_s:.4g} s{'' if count == 1 else ' for the first time'}, and left out of "
        "the residuals",
        "look for a loose plug, or for markers that a camera takes for another",
    )
    return replace(log.with_masked(new), issues=(*log.issues, issue))
