"""The search without the ends of a smoothed record, of which nobody knows what they were made of.

A filter that runs over a finished record needs samples from before its first and after its last
one. Tools differ in what they take for these, and in how long they let the filter settle: where the
actuator moves, a few readings at an end are then far off, and outweigh the noise of a whole log.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import Recordings, Request
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.motion import residual_context
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis.verdict.doubts import OVER_RECORD
from softid.effects import own_values
from softid.errors import Issue
from softid.log import Log

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

SMOOTHED_ENDS = "smoothed-ends"
"""Code of the remark that the ends of a smoothed record are left out."""

PERIODS = 2.0
"""Periods of the filter, or widths of the mean, that an end reaches: of what is beyond, a filter of
the second order passes on less than a thousandth by then."""

LOUD = 4.0
"""Mean square of what is left at the ends over that of the rest from which on they are told apart:
slow noise is now and then twice as large at an end as elsewhere."""

LONGEST = 0.2
"""Share of a log up to which its ends are left out: with more, hardly a log is left to judge by."""


def search_without_ends(
    recordings: Recordings, request: Request, search: CauseSearch, known: SearchResult
) -> tuple[SearchResult, CauseSearch] | None:
    """Causes that are found when the ends of smoothed records are left out of the residuals.

    Parameters
    ----------
    recordings, request
        As in `search_causes`.
    search
        The search over the base at hand.
    known
        What it found.

    Returns
    -------
    SearchResult and CauseSearch, or None
        None where no filter ran over the records, or what is left is no larger at their ends.
    """
    reach_s = _reach_of(known.chain.final)
    if reach_s == 0.0 or not are_ends_loud(known.chain.final, reach_s):
        return None
    without = recordings.each(partial(without_ends, reach_s=reach_s))
    if without is recordings:
        return None
    request = replace(request, model=search.base.candidate.problem.model)
    again = request.fit_base(without.logs, without.hold_out, thorough=False)
    over = replace(search, base=again)
    found = over.search()
    is_still_there = _reach_of(found.chain.final) > 0.0
    return (found, over) if is_still_there and not found.came_to_nothing else None


def are_ends_loud(model: Candidate, reach_s: float) -> bool:
    """Whether a model leaves far more at the ends of the logs than elsewhere.

    Parameters
    ----------
    model
        The model with a filter over the record.
    reach_s
        Time within which a reading is at an end.
    """
    logs, owner = model.problem.logs, model.problem.owner
    ends, others = [], []
    for part, log in zip(residual_context(model), owner, strict=True):
        is_end = _is_end(logs[log], part.time_s, reach_s)
        ends.append(part.residual[is_end])
        others.append(part.residual[~is_end])
    at_ends, elsewhere = (np.concatenate(parts) for parts in (ends, others))
    if not (np.isfinite(at_ends).any() and np.isfinite(elsewhere).any()):
        return False
    return bool(np.nanmean(at_ends**2) > LOUD * np.nanmean(elsewhere**2))


def without_ends(log: Log, reach_s: float) -> Log:
    """The log with its ends left out of the residuals; the same object where they are most of it.

    Parameters
    ----------
    log
        A log of a record that was smoothed.
    reach_s
        Time within which a reading is at an end.
    """
    is_end = _is_end(log, log.time_s, reach_s)
    if is_end.mean() > LONGEST:
        return log
    issue = Issue(
        SMOOTHED_ENDS,
        "info",
        f"{log.name}: readings within {reach_s:.2g} s of its first and its last one depend on what "
        "the filter that smoothed them took for those beyond, and are left out of the residuals",
        "cut a record after it was smoothed, or leave it as it was read",
    )
    return replace(log.with_masked(is_end), issues=(*log.issues, issue))


def _is_end(log: Log, time_s: Array, reach_s: float) -> BoolArray:
    near: BoolArray = np.minimum(time_s - log.time_s[0], log.time_s[-1] - time_s) < reach_s
    return near


def _reach_of(model: Candidate) -> float:
    """Time in s within which a smoothed reading depends on others; 0 without such a filter."""
    filters = ((e, e.amplitude) for e in model.effects if e.key in OVER_RECORD and e.amplitude)
    reach = (PERIODS * own_values(e, model.parameters)[size] for e, size in filters)
    return max(reach, default=0.0)
