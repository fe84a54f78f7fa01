"""Which searches for a chain of causes follow one another: the usual one, then other beginnings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.cause_search import CauseSearch, SearchResult
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.forward_selection import Chain

BETTER_BASE = 0.98
"""Another optimum of the base counts when it leaves so much less than the first."""


class Explanations(Protocol):
    """What else explains a misfit than a cause."""

    def all(self, base: BaseFit) -> Sequence[object]:
        """Other explanations of what a base leaves; nothing where there is none."""

    def outdo(self, base: BaseFit, cause: Candidate) -> bool:
        """Whether they leave nothing to look for beside the best cause."""


def search_causes(
    recordings: Recordings,
    request: Request,
    search: CauseSearch,
    others: Explanations,
    first: Chain | None = None,
) -> tuple[SearchResult, CauseSearch]:
    """What a search finds, and where it came to nothing what one from another beginning does.

    None does where the misfit is explained otherwise.

    Parameters
    ----------
    recordings
        The logs.
    request
        What the user asked for.
    search
        The search over the base at hand.
    others
        Explanations that are no causes.
    first
        The chain with its first cause, if it was looked for already.

    Returns
    -------
    result, search
        And the search that found it, whose base may be another optimum.
    """
    first = first or search.first_cause()
    if search.leaves_structure(first) and others.outdo(search.base, first.final):
        return search.without_names(first), search
    found = search.search(first)
    if not found.came_to_nothing:
        return found, search
    alone = search.without_causes()
    if alone is not None and alone.remainder.open_jumps > 0:
        return alone, search
    if others.all(search.base):
        return found, search
    again = request.fit_base(recordings.logs, recordings.hold_out, thorough=True)
    if again.candidate.squares < BETTER_BASE * search.base.candidate.squares:
        search = replace(search, base=again)  # the base was a false optimum
        found = search.search()
        if not found.came_to_nothing:
            return found, search
    other = search.search_from_multistart(found) or search.search_from_other_causes(found.chain)
    return other or found, search
