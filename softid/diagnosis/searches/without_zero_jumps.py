"""The search in readings without a jump of the zero, or a load, that hides what else there is.

Where a sensor slips, or is bumped, its zero is another one from then on; a load shifts the
actuator, a linear one as far at every level of its input. What stands for that, such as a drift,
spoils every cause beside it. Without the jump the causes are found as elsewhere, and with them the
moment and the size of the jump are known better.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from operator import attrgetter

from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.changes.change_point import change_point
from softid.diagnosis.changes.jump_search import seen_again, zero_jumps
from softid.diagnosis.changes.loads import LoadInLog
from softid.diagnosis.changes.shifts import EITHER, LOAD, ZERO
from softid.diagnosis.changes.zero_jumps import ZeroJump, with_jumps_exchanged, without_jumps
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.optimum import squares_under
from softid.diagnosis.refit.parts_of_logs import refitted_to_changed
from softid.diagnosis.residual.assessment import excess_of
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult

IN_TIME = attrgetter("log", "time_s")
"""By what several jumps are put in the order in which they are told."""

ROUNDS, ENOUGH = 8, 5
"""Jumps are seen again with the causes that are found without them, so many times in all; so many
are enough where the causes are sure, or no longer come nearer."""

SETTLING, SETTLING_EVALUATIONS = 6, 15
"""A model and the jumps that it sees settle in so many turns, each with so many simulations."""

JUDGED = 3
"""So often a jump is looked for in the logs that judge, which may have several, or one whose moment
is known better without the most of it."""

NEARER = 0.5
"""Share of the misfit above the noise that causes leave of what the round before did, below which
they come nearer."""

SAME_SIZE, SAME_MOMENT = 0.01, 0.02
"""A jump that is seen again with a size within this share of it, within this share of the time of
the motion, is known."""

MENDED = 0.7
"""The first cause in readings without a jump leaves less than this share of what it does else."""

NEAREST = 0.08
"""Share of the longest log within which there is no second jump: what is left there is of one whose
moment and size are not known well yet."""

OUTDONE = 0.2
"""Causes that are not sure are told where they leave less than this share of the misfit above the
noise that is left else."""

CLOSER = 0.9
"""What is held out goes on as behind the jumps where it is missed by less than this share then."""

LEFT_TO_CAUSES = 0.02
"""Share of the misfit above the noise that must stay without the jump, for causes to explain: a
jump that is more or less all there is needs none."""


def search_without_zero_jumps(
    recordings: Recordings, request: Request, search: CauseSearch, known: SearchResult
) -> tuple[SearchResult, CauseSearch] | None:
    """Causes that are found when jumps of the zero and loads are taken out of the readings.

    They are sure, or leave far less than those in the readings as they are.

    Parameters
    ----------
    recordings, request
        As in `search_causes`.
    search
        The search over the base at hand.
    known
        What it found, which leaves more than noise.

    Returns
    -------
    SearchResult and CauseSearch, or None
        None where there are no such causes, or no such jumps.
    """
    base = search.base
    excess = excess_of(base.candidate, base.scale)
    noise = base.candidate.squares / (1.0 + excess)
    misfit = base.candidate.squares - noise
    jumps = _jumps_and_loads(base, excess)
    in_judges: tuple[ZeroJump, ...] = ()
    request = replace(request, model=base.candidate.problem.model)
    jumps = tried = _as_held_out_goes_on(jumps, recordings, request)
    near_s, left = SAME_MOMENT * base.scale.motion_s, misfit
    for k in range(ROUNDS):
        if not jumps:
            return None
        over = replace(search, base=_fit_without((*jumps, *in_judges), recordings, request))
        bare = squares_under(over.base.candidate, over.base.sigma, base.sigma)
        if base.candidate.squares - bare > (1.0 - LEFT_TO_CAUSES) * misfit:
            return None
        first = over.first_cause()
        mended = squares_under(first.final, over.base.sigma, base.sigma)
        if mended > MENDED * (known.first or base.candidate).squares:
            return None
        nearer = _settled(jumps, first.final, over, near_s) if not k else jumps
        if len(nearer) == len(jumps) and not _are_same(jumps, nearer, near_s):
            jumps = nearer  # with the first cause, before others are found that make up for it
            over = replace(search, base=_fit_without(jumps, recordings, request))
            first = over.first_cause()
        found = over.search(first)
        seen = _settled(jumps, found.chain.final, over, near_s)
        is_known = _are_same(jumps, seen, near_s)
        further = _further_jumps(found, over, tried) if k or is_known else ()
        if not (further or in_judges):
            in_judges = _jumps_in_judges(found, over.base)
            is_known = is_known and not in_judges
        jumps, tried = tuple(sorted((*seen, *further), key=IN_TIME)), (*tried, *further)
        before, left = left, squares_under(found.chain.final, over.base.sigma, base.sigma) - noise
        is_enough = k + 1 >= ENOUGH
        if (is_known and not further) or (is_enough and found.is_sure):
            is_less = left < OUTDONE * (known.chain.final.squares - noise)
            return (found, over) if found.is_sure or (any(found.is_named) and is_less) else None
        if is_enough and left > NEARER * before:
            return None
    return None


def search_without_jumps_of_judges(
    recordings: Recordings, request: Request, search: CauseSearch, known: SearchResult
) -> tuple[SearchResult, CauseSearch] | None:
    """Causes that what is held out speaks against, or would, where a jump there is why.

    Parameters
    ----------
    recordings, request, search, known
        As in `search_without_zero_jumps`.

    Returns
    -------
    SearchResult and CauseSearch, or None
        None where no cause is sure without the likely jumps of the logs that judge.
    """
    request = replace(request, model=search.base.candidate.problem.model)
    jumps: tuple[ZeroJump, ...] = ()
    for _ in range(JUDGED):
        further = _jumps_in_judges(known, search.base)
        if not further:
            return None
        jumps = (*jumps, *further)
        search = replace(search, base=_fit_without(jumps, recordings, request))
        known = search.search()
        if known.is_sure:
            return known, search
    return None


def _as_held_out_goes_on(
    jumps: tuple[ZeroJump, ...], recordings: Recordings, request: Request
) -> tuple[ZeroJump, ...]:
    """The jumps, as what is held out goes on: as before them, or as behind them.

    Only a load can tell that shifts the output by another amount at every level of the input: every
    log has a zero of its own.
    """
    if not any(isinstance(jump.course, LoadInLog) for jump in jumps):
        return jumps
    ways = jumps, tuple(replace(jump, stays=True) for jump in jumps)
    bases = [_fit_without(way, recordings, request) for way in ways]
    errors = [base.held_out.rms(base.candidate) for base in bases]
    return ways[1] if errors[1] < CLOSER * errors[0] else ways[0]


def _fit_without(jumps: tuple[ZeroJump, ...], recordings: Recordings, request: Request) -> BaseFit:
    """The base in readings without jumps."""
    steady = recordings.each(partial(without_jumps, jumps=jumps))
    return request.fit_base(steady.logs, steady.hold_out, thorough=False)


def _settled(
    jumps: tuple[ZeroJump, ...], model: Candidate, search: CauseSearch, near_s: float
) -> tuple[ZeroJump, ...]:
    """The jumps as a model sees them that is refitted without them until they stay.

    Parameters
    ----------
    jumps
        What was taken out of the logs of the model.
    model
        The base with causes.
    search
        The search that found it.
    near_s
        Moments that differ by less are the same.
    """
    base = search.base
    for _ in range(SETTLING):
        seen = seen_again(model, base.scale, jumps)
        if len(seen) < len(jumps) or _are_same(jumps, seen, near_s):
            return seen
        exchange = partial(with_jumps_exchanged, out=jumps, others=seen)
        logs = [exchange(log) for log in model.problem.logs]
        again = refitted_to_changed(model, base.sigma, logs, SETTLING_EVALUATIONS)
        if again is None:
            return seen
        jumps, model = seen, again
    return jumps


def _further_jumps(
    found: SearchResult, search: CauseSearch, tried: tuple[ZeroJump, ...]
) -> tuple[ZeroJump, ...]:
    """The likely jumps in what the causes leave: a load that is put on is taken off again.

    What is left beside a jump that is known is no other one, nor is what was one already and is
    seen no more.
    """
    if not found.remainder.structured:
        return ()
    model = found.chain.final
    likely = zero_jumps(model, search.base.scale, excess_of(model, search.base.scale))
    near_s = NEAREST * search.base.scale.duration_s
    return tuple(
        replace(jump, stays=tried[0].stays)
        for jump in likely
        if not any(jump.log == o.log and abs(jump.time_s - o.time_s) < near_s for o in tried)
    )


def _jumps_in_judges(found: SearchResult, base: BaseFit) -> tuple[ZeroJump, ...]:
    """The likely jumps of the logs that judge, where the causes miss those."""
    judged = base.held_out.standing(found.chain.final) if found.remainder.misses_held_out else None
    return () if judged is None else zero_jumps(judged, base.scale, excess_of(judged, base.scale))


def _jumps_and_loads(base: BaseFit, excess: float) -> tuple[ZeroJump, ...]:
    """The likely jumps, unless a gain or a clock that changes explains the misfit."""
    jumps = zero_jumps(base.candidate, base.scale, excess)
    event = change_point(base.candidate, base.scale, excess) if jumps else None
    return jumps if event is None or event.kind in (ZERO, LOAD, EITHER) else ()


def _are_same(some: Sequence[ZeroJump], others: Sequence[ZeroJump], near_s: float) -> bool:
    """Whether jumps are the same, in turn."""
    return len(some) == len(others) and all(
        (one.log, one.kind) == (other.log, other.kind)
        and abs(other.time_s - one.time_s) <= near_s
        and abs(other.size / one.size - 1.0) < SAME_SIZE
        for one, other in zip(some, others, strict=True)
    )
