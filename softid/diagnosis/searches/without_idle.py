"""Named causes without descriptions beside them that change nothing.

A second law may bend with the first where the motion goes, so that the likelihood rises, and do
nothing for what is held out. Where the named causes leave noise without it, it describes nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

from softid.diagnosis.search.forward_selection import Chain, converged
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis_results import Cause, Doubt

IDLE = (Doubt.GAINS_NOTHING, Doubt.MAY_GAIN_NOTHING, Doubt.MAY_BE_ZERO, Doubt.UNKNOWN_SIZE)
"""Doubts behind which there may be nothing in any of the logs."""


def without_idle(
    found: SearchResult, search: CauseSearch, described: Sequence[Cause]
) -> SearchResult | None:
    """The chain up to the last cause that has a name, if that leaves noise on all logs.

    None where it leaves more, where the descriptions are no last links, or where one of them acts.

    Parameters
    ----------
    found
        Causes and descriptions.
    search
        What found them.
    described
        The descriptions, with what speaks against their names.
    """
    idle = {cause.key for cause in described}
    links = found.chain.links
    kept = links[: len(links) - len(described)]
    is_last = {link.added.key for link in links[len(kept) :]} == idle
    if not (kept and idle and is_last) or any(cause.doubt not in IDLE for cause in described):
        return None
    model = kept[-1].found
    if model is None:
        return None
    model = converged(model, search.base.sigma)
    if search.remainder_of(model).structured:
        return None
    judged = search.judged(Chain(kept, links[len(kept)], model), found.first)
    return judged if judged.is_sure and all(judged.is_named) else None
