"""The search with the moments at which the input jumped, where those hide what else there is.

Where a command is held, or a valve switches, between two samples nobody knows when; what the motion
leaves of that outweighs the noise by far if it is quick beside the sampling. The moments can be
estimated from what a chain of causes leaves, the better the more of it is right, and with them the
causes that they hid come out. But moments take up a part of what a cause does, so they only serve
to find names: whether those hold is asked of the logs as they were recorded.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import Recordings, Request
from softid.diagnosis.base.intersample_selection import (
    recordings_with_intersample,
    refitted_as,
)
from softid.diagnosis.logs.timed_jumps import with_jumps_at
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOutLogs
from softid.diagnosis.residual.assessment import noise_variance
from softid.diagnosis.residual.jump_timing import JumpResponses, untimed_jumps
from softid.diagnosis.residual.motion import mean_square, residual_context
from softid.diagnosis.residual.projection import slopes_of
from softid.diagnosis.search.bic_ranking import is_likelier
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis.verdict.held_out_error import held_out_responses
from softid.identification.intersample_choice import choice_unless_held
from softid.intersample import Intersample
from softid.log import Log, LogSet
from softid.segment import Segment

Array = npt.NDArray[np.float64]

LEAST_HIDDEN = 0.1
"""Share of what causes leave that moments of jumps take away at least where they hide something."""

TIMING_ROUNDS = 2
"""Moments are estimated anew from what a search that knows them has found, so many times in all."""


def search_with_jump_moments(
    recordings: Recordings, request: Request, search: CauseSearch, known: Chain
) -> tuple[SearchResult, CauseSearch] | None:
    """Sure causes that are found when the moments of jumps of the input are estimated first.

    Parameters
    ----------
    recordings, request
        As in `search_causes`.
    search
        The search over the base at hand.
    known
        The chain that it found, which leaves more than noise.

    Returns
    -------
    SearchResult and CauseSearch, or None
        Causes in the logs as they were recorded, and the search over these; None where there are
        none that are sure, or no jumps whose moments hide anything.
    """
    plain = recordings_with_intersample(recordings, choice_unless_held(recordings.logs))
    whole: CauseSearch | None = None
    if _intersample(plain.logs) != _intersample(search.base.candidate.problem.logs):
        whole = _over(plain, request, search)  # what is held comes late, as behind a cause
        found = whole.search()
        is_whole = any(found.is_named) and not found.remainder.leaves_something
        if is_whole and is_likelier(found.chain.final, known.final, search.base.sigma):
            return found, whole
    for chain in _chains(plain, request, search, known):
        meant = {name for link in chain.links for name in (link.added.name, *link.rivals)}
        whole = whole or _over(plain, request, search)
        if whole is search and known.final.names <= meant:  # it would be found once more
            found = search.judged(known.among(meant), None)
        else:
            effects = tuple(effect for effect in search.effects if effect.name in meant)
            found = replace(whole, effects=effects).search()
        if found.is_sure:
            return found, whole
    return None


def _chains(
    plain: Recordings, request: Request, search: CauseSearch, known: Chain
) -> Iterator[Chain]:
    """The chains that timed jumps lead to, from those that the known one and they tell."""
    chain = known
    for _ in range(TIMING_ROUNDS):
        timed = timed_recordings(plain, search, chain.final)
        if timed is None:
            return
        base = request.fit_base(timed.logs, timed.hold_out, thorough=False)
        chain = replace(search, base=base).search().chain
        if not chain.links:
            return
        yield chain


def _intersample(logs: Iterable[Log]) -> Intersample:
    return next(iter(logs)).effective_intersample


def _over(recordings: Recordings, request: Request, search: CauseSearch) -> CauseSearch:
    """The search over the logs with the intersample behaviour that they have here."""
    if _intersample(recordings.logs) == _intersample(search.base.candidate.problem.logs):
        return search
    base = request.fit_base(recordings.logs, recordings.hold_out, thorough=False)
    return replace(search, base=base)


def timed_recordings(
    recordings: Recordings, search: CauseSearch, model: Candidate
) -> Recordings | None:
    """The logs with jumps of the input at the moments that a model asks for.

    Parameters
    ----------
    recordings
        The logs, without a jump that is held.
    search
        The search over the base that the model extends.
    model
        The base with causes, whatever the intersample behaviour of its logs.

    Returns
    -------
    Recordings or None
        None where no input jumps, the moments lie otherwise than by chance, or they hide little.
    """
    base = search.base
    refitted = refitted_as(model, base.sigma, _intersample(recordings.logs))
    if refitted is None:
        return None
    parts, noise = residual_context(refitted), noise_variance(base.candidate, base.scale)
    responses = JumpResponses.of(refitted, parts, noise, slopes_of(refitted))
    found = None if responses is None else responses.with_misfit()
    if found is None or not found.scatter:
        return None
    if mean_square(found.parts) > (1.0 - LEAST_HIDDEN) * mean_square(parts):
        return None
    logs = _timed(recordings.logs, refitted.problem.segments, found.shares)
    return Recordings(LogSet(logs), _timed_to_judge(recordings.hold_out, refitted, noise))


def _timed_to_judge(logs: tuple[Log, ...], model: Candidate, noise: float) -> tuple[Log, ...]:
    """The logs that judge with the moments that the same model asks for there."""
    if not logs:
        return logs
    judged = HeldOutLogs(logs).standing(model)
    responses = held_out_responses(model, judged, noise)
    if responses is None:
        return logs
    return _timed(logs, judged.problem.segments, responses.with_misfit().shares)


def _timed(
    logs: Iterable[Log], segments: Sequence[Segment], shares: Sequence[Array]
) -> tuple[Log, ...]:
    """The logs with jumps at their shares of the intervals; averages and slow gauges as they are.

    A jump between two readings of a slow gauge goes on over samples of the log.
    """
    spans_s = [untimed_jumps(segment) for segment in segments]
    timed = []
    for log in logs:
        own = [k for k, segment in enumerate(segments) if segment.log_name == log.name]
        if type(log) is Log and log.input_read_s is None:
            log = with_jumps_at(log, [spans_s[k] for k in own], [shares[k] for k in own])
        timed.append(log)
    return tuple(timed)
