"""Which searches for a chain of causes follow one another: the usual one, then other beginnings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Protocol

from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.base.intersample_selection import (
    hold_out_as_explained,
    intersample_after_all_causes,
    intersample_after_first_cause,
    recordings_with_intersample,
)
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.optimum import squares_under
from softid.diagnosis.residual.noise_floor import SMALLEST_EXCESS
from softid.diagnosis.search.bic_ranking import is_likelier
from softid.diagnosis.search.forward_selection import MAX_LINKS, Chain
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis.searches.with_jump_moments import search_with_jump_moments
from softid.diagnosis.searches.without_ends import search_without_ends
from softid.diagnosis.searches.without_zero_jumps import (
    search_without_jumps_of_judges,
    search_without_zero_jumps,
)
from softid.intersample import Intersample
from softid.log import Log

Searched = tuple[SearchResult, CauseSearch]
"""What was found, and by which search."""

BETTER_BASE = 0.98
"""Another optimum of the base counts when it leaves so much less than the first."""


class Explanations(Protocol):
    """Explanations of a misfit other than a cause."""

    def all(self, base: BaseFit) -> Sequence[object]:
        """All explanations of what a base leaves; empty where there is none."""

    def outdo(self, base: BaseFit, cause: Candidate) -> bool:
        """Whether an explanation is so much better than the best cause that no search is needed."""

    def part(self, base: BaseFit) -> bool:
        """Whether one number that changed within a log leaves nothing else to look for."""


def search_causes(
    recordings: Recordings,
    request: Request,
    search: CauseSearch,
    others: Explanations,
    first: Chain | None = None,
    *,
    is_in_doubt: bool = False,
) -> Searched:
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
    is_in_doubt
        Whether nobody said what the input does between its samples.

    Returns
    -------
    result, search
        And the search that found it, whose base may be another optimum.
    """
    first = first or search.first_cause()
    if search.leaves_structure(first) and others.outdo(search.base, first.final):
        return search.judged(first, None).without_names, search
    found = search.search(first)
    if found.remainder.structured and not found.is_sure and others.part(search.base):
        return found.without_names, search
    mended = _over_mended_logs(recordings, request, search, found, is_in_doubt=is_in_doubt)
    if mended is not None:
        return mended
    if not found.came_to_nothing:
        return _from_another_cause(found, search), search
    alone = search.without_causes()
    if alone is not None and alone.remainder.open_jumps > 0:
        return alone, search
    if others.all(search.base):
        return found, search
    again = request.fit_base(recordings.logs, recordings.hold_out, thorough=True)
    left = squares_under(again.candidate, again.sigma, search.base.sigma)
    if left < BETTER_BASE * search.base.candidate.squares:
        search = replace(search, base=again)  # the base was a false optimum
        found = search.search()
        if not found.came_to_nothing:
            return found, search
    return search.search_from_multistart(found) or search.search_from_other_causes(found), search


def _over_mended_logs(
    recordings: Recordings,
    request: Request,
    search: CauseSearch,
    found: SearchResult,
    *,
    is_in_doubt: bool,
) -> Searched | None:
    """What is found without what a filter made of ends, between jumps, or after a jump of zero.

    That of what is held out may be all that speaks against causes.
    """
    inner = search_without_ends(recordings, request, search, found)
    if inner is not None:
        return inner
    if not found.remainder.structured:
        return search_without_jumps_of_judges(recordings, request, search, found)
    if is_in_doubt and found.chain.links:
        timed = search_with_jump_moments(recordings, request, search, found.chain)
        if timed is not None:
            return timed
    steady = search_without_zero_jumps(recordings, request, search, found)
    if steady is not None or not found.came_to_nothing:
        return steady
    return search_without_jumps_of_judges(recordings, request, search, found)


def _from_another_cause(found: SearchResult, search: CauseSearch) -> SearchResult:
    """What was found, or what is sure from another first cause, where a name may be wrong.

    Where a curve leaves something, its free values have taken what a second cause does, which pays
    no more beside it then. A first cause that stands for two others leaves more than noise, or two
    more make up for it, or what it leaves is larger than the fastest part of the noise: what is
    likelier takes its place. What is not sure does if what was found is not, and is outdone in all.
    """
    links, left = found.chain.links, found.remainder
    is_bent = found.chain.bends and left.leaves_something
    is_louder = left.excess > SMALLEST_EXCESS and not left.noise_is_known
    is_doubted = left.structured or len(links) == MAX_LINKS or (len(links) > 1 and is_louder)
    if not (is_bent or is_doubted):
        return found
    other = search.search_from_other_causes(found)
    if other.chain is found.chain:
        return _outdoing(other, search)
    is_better = is_bent or is_likelier(other.chain.final, found.chain.final, search.base.sigma)
    return other if is_better else found.with_unsure(other.unsure)


def _outdoing(found: SearchResult, search: CauseSearch) -> SearchResult:
    """What was found, or if that is unsure what was met on the way and outdoes it in everything.

    That names as many causes at least, has no more unknowns, explains more, also in the sight of
    the noise, and errs less on what is held out.
    """
    if found.is_sure:
        return found
    held_out, sigma = search.base.held_out, search.base.sigma
    for other in sorted(found.unsure, key=lambda result: result.chain.final.squares):
        now, then = found.chain.final, other.chain.final
        names_as_many = sum(other.is_named) >= sum(found.is_named)
        is_plainer = then.problem.size <= now.problem.size
        if not (names_as_many and is_plainer and then.squares < now.squares):
            continue
        if held_out.rms(then) < held_out.rms(now) and is_likelier(then, now, sigma):
            return replace(other, unsure=found.unsure)
    return found


def search_with_intersample(
    recordings: Recordings,
    request: Request,
    search: CauseSearch,
    others: Explanations,
    first: Chain | None = None,
) -> Searched:
    """The search where nobody said what the input does between its samples.

    With the wrong answer a delay hides in the first cause, or in all of them: where another one
    explains more, the base is fitted and searched again with it.

    Parameters
    ----------
    recordings, request, search, others, first
        As in `search_causes`.
    """
    base, first = search.base, first or search.first_cause()
    now = base.candidate.problem.logs[0].effective_intersample

    def judges_of(intersample: Intersample, known: Candidate) -> tuple[Log, ...]:
        """What is held out, with the intersample behaviour that what is known asks for."""
        changed = recordings_with_intersample(recordings, intersample)
        return hold_out_as_explained(known, intersample, base.sigma, changed.hold_out)

    def searched_as(intersample: Intersample | None, known: Candidate) -> Searched:
        intersample = intersample or now
        judges = judges_of(intersample, known)
        if intersample == now and _intersamples(judges) == _intersamples(base.identified.hold_out):
            return search_causes(recordings, request, search, others, first, is_in_doubt=True)
        changed = replace(recordings_with_intersample(recordings, intersample), hold_out=judges)
        again = request.fit_base(changed.logs, judges, thorough=False)
        over = replace(search, base=again)
        return search_causes(changed, request, over, others, is_in_doubt=True)

    found, last = searched_as(
        intersample_after_first_cause(base.candidate, first.final, base.scale, base.sigma),
        first.final,
    )
    if len(found.chain.links) > 1:
        final = found.chain.final
        intersample = intersample_after_all_causes(final, last.base.sigma, found.remainder.excess)
        if intersample is not None:
            return searched_as(intersample, final)
        judges = judges_of(last.base.candidate.problem.logs[0].effective_intersample, final)
        if _intersamples(judges) != _intersamples(last.base.identified.hold_out):
            other = replace(last, base=last.base.judged_by(judges))
            again = other.judged(found.chain, found.first)
            return replace(again, met_multistart=found.met_multistart), other
    elif found.promising is not None:
        model = found.promising
        intersample = model.problem.logs[0].effective_intersample
        if _intersamples(judges_of(intersample, model)) != _intersamples(
            last.base.identified.hold_out
        ):
            return searched_as(intersample, model)
    return found, last


def _intersamples(logs: Iterable[Log]) -> list[Intersample]:
    return [log.effective_intersample for log in logs]
