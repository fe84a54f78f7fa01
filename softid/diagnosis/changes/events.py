"""What happened in a log for a while, or from one moment on: no law that goes on throughout."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.changes.change_point import change_point
from softid.diagnosis.changes.changed_numbers import changes_of, squares_of
from softid.diagnosis.changes.clock_jumps import is_clock_jump
from softid.diagnosis.changes.log_differences import (
    LogDifferences,
    log_differences,
    squares_with,
)
from softid.diagnosis.changes.shifts import ZERO, Shift, shift_at
from softid.diagnosis.changes.spells import (
    Spells,
    is_of_a_jump,
    moves_as_in,
    residual_in,
    spells_elsewhere,
    spells_of,
    usual_samples,
)
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.parts_of_logs import REFIT_EVALUATIONS, refitted
from softid.diagnosis.residual.assessment import noise_variance
from softid.errors import IdentificationError, InputError
from softid.log import Log
from softid.uncertainty.autoregression import fit_ar

PARTS_A_LOG = 0.985
"""Share of the misfit of a part of a log that one number takes away which parts it in two."""

MOST_UNEVEN = 0.25
"""Share by which a number may differ between the halves of a spell with which a log begins: what
settles loses more than half of it, or is over."""

MOST_LEFT = 0.3
"""What one number leaves above the noise, as a share of it, from which on something else may be
missing, too."""

FOLLOWED_RATIO = 2.0
"""A log is followed where no more than so many times the noise of all logs is left."""


@dataclass(frozen=True, eq=False)
class Event:
    """What happened for a while, or from one moment on.

    Attributes
    ----------
    log, spells, change
        The log, when it was, and the number that changes then, if it is one.
    lasts_in
        Logs to judge by that have it throughout.
    recurs
        Whether others have such spells.
    shift
        What shifts the output there, where the model is linear and something does.
    """

    log: Log
    spells: Spells
    change: LogDifferences | None
    lasts_in: Sequence[Log]
    recurs: bool
    shift: Shift | None


def events_in(base: BaseFit) -> list[Event]:
    """What happened in each fitted log; nothing where another one shows that it may be a law.

    Nor where the model that follows the rest of the log is wrong throughout others: what acts at
    the fast motions of some logs acts nowhere in the slow part of one.

    Parameters
    ----------
    base
        The base fit to the logs.
    """
    noise = noise_variance(base.candidate, base.scale)

    @cache  # the whole of a log is fitted as its first part, and to see that it is followed
    def fit(log: Log) -> Candidate:
        return refitted(base.candidate, base.sigma, [log], REFIT_EVALUATIONS)

    judges = base.judges
    found = []
    for log in base.whole_logs:
        spells = spells_of(log, fit, noise)
        change = None if spells is None else _change_in(log, spells, base)
        elsewhere: list[int | None] = []
        if spells is not None:
            elsewhere = [spells_elsewhere(other, spells.reference, noise) for other in judges]
        if spells is None or not _is_event(log, spells, change, elsewhere, base):
            if not _is_followed(log, fit, noise):
                return []  # what one log has throughout is no event in another
            continue
        lasts_in = [other for other, count in zip(judges, elsewhere, strict=True) if count is None]
        if lasts_in and not _has_lasted(spells, change, lasts_in, base):
            return []
        shift = _shift_in(log, spells)
        found.append(Event(log, spells, change, lasts_in, any(elsewhere), shift))
    return found


def is_parted(
    base: BaseFit, excess: float, find: Callable[[BaseFit], Sequence[Event]] = events_in
) -> bool:
    """Whether one number that changed within a log leaves nothing else to look for.

    Parameters
    ----------
    base
        The base fit to the logs.
    excess
        Variance of what it leaves above that of the noise, as a share of the latter.
    find
        What finds the events, where they may be known already.
    """
    found = change_point(base.candidate, base.scale, excess)
    if found is not None and found.kind:
        return (1.0 - found.share) * excess < MOST_LEFT
    events = find(base)
    return bool(events) and all(
        event.spells.is_one_part
        and event.change is not None
        and event.change.beside is None
        and (1.0 - event.change.share) * (event.spells.before / event.spells.noise - 1.0)
        < MOST_LEFT
        for event in events
    )


def _change_in(log: Log, spells: Spells, base: BaseFit) -> LogDifferences | None:
    """What changes in the spells of a log; nothing where none known does."""
    return log_differences(
        spells.reference,
        base.scale,
        [log.between(begin, np.nextafter(end, np.inf)) for begin, end in spells.spans_s],
        before=spells.before,
        noise=spells.noise,
        zero_counts=True,
    )


def _shift_in(log: Log, spells: Spells) -> Shift | None:
    """What shifts the output when spells begin and end."""
    at, left = residual_in(log, spells.reference)
    time_s = log.time_s[at]
    outside = np.ones(time_s.size, bool)
    for begin, end in spells.spans_s:
        outside &= (time_s < begin) | (time_s > end)
    noise = fit_ar([np.where(outside, left, np.nan)])
    within = [t for span in spells.spans_s for t in span if time_s[0] < t < time_s[-1]]
    found = shift_at(within, spells.reference, time_s, left, noise)
    if found is not None and spells.spans_s[0][0] <= time_s[0]:  # the first moment is an end
        return replace(found, size=-found.size)
    return found


def _is_event(
    log: Log,
    spells: Spells,
    change: LogDifferences | None,
    elsewhere: Sequence[int | None],
    base: BaseFit,
) -> bool:
    """Whether spells are no law, and no jump of the input.

    What begins with the log, or moves as nothing else in it, may be a law. It is none where one
    number parts the log in two, and what is held out follows the later part from its start on; if
    that moves as nothing else, also where what is held out moves otherwise.
    """
    if all(is_of_a_jump(log, span, base.scale.motion_s) for span in spells.spans_s):
        return False
    if change is not None and spells.is_one_part and _is_one_number(change):
        later = None if spells.ends_last else 0
        goes_on = bool(elsewhere) and all(count == later for count in elsewhere)
        if goes_on and (spells.is_met or _is_no_law(spells, change, base)):
            return spells.ends_last or _is_even(log, spells, change, base)
    if spells.begins_early:
        return False
    return spells.is_met or is_clock_jump(change, spells.reference, base.scale, base.sigma)


def _is_no_law(spells: Spells, change: LogDifferences, base: BaseFit) -> bool:
    """Whether what is held out tells a change from a law that acts in spells as none of its motion.

    What is held out moves as the spells do, if these begin the log and it is as the rest. Else the
    number differs there by as much also in what moves no otherwise than the rest. Of its zero no
    other log knows.
    """
    if not spells.ends_last:
        return all(moves_as_in(log, spells) for log in base.judges)
    kind = change.kinds[0]
    by_kind = {one.kinds[0]: one for one in changes_of(spells.reference, base.scale)}
    if kind == ZERO or kind not in by_kind:
        return kind == ZERO
    for log in base.judges:
        usual = usual_samples(log, spells, base.scale.motion_s)
        sizes = None
        with suppress(IdentificationError, InputError):  # nothing may move so
            sizes = by_kind[kind].on(log.with_masked(~usual))[1]
        if sizes is None or not _are_alike(change.sizes[0], sizes[0]):
            return False
    return True


def _is_even(log: Log, spells: Spells, change: LogDifferences, base: BaseFit) -> bool:
    """Whether what differs in a spell differs by as much in its second half as in its first."""
    ((begin, end),) = spells.spans_s
    middle = 0.5 * (begin + end)
    if change.kinds[0] == ZERO:
        at, left = residual_in(log, spells.reference)
        parts = ((begin, middle), (middle, end))
        within = [(log.time_s[at] >= low) & (log.time_s[at] <= high) for low, high in parts]
        return _are_alike(*(float(np.mean(left[part])) for part in within))
    found = log_differences(
        spells.reference,
        base.scale,
        [log.between(begin, middle), log.between(middle, np.nextafter(end, np.inf))],
        before=spells.before,
        noise=spells.noise,
        zero_counts=False,
    )
    return found is not None and found.beside is None and _are_alike(*found.sizes)


def _are_alike(first: float, second: float) -> bool:
    return abs(second - first) < MOST_UNEVEN * abs(first)


def _is_one_number(change: LogDifferences) -> bool:
    """Whether one number takes away nearly all of the misfit of a part of a log."""
    return change.beside is None and change.share > PARTS_A_LOG


def _has_lasted(
    spells: Spells, change: LogDifferences | None, judges: Sequence[Log], base: BaseFit
) -> bool:
    """Whether logs are followed with what changes in the last spell of another one."""
    if change is None or not (spells.is_one_part and spells.ends_last):
        return False
    noise = noise_variance(base.candidate, base.scale)
    return all(
        squares_with(spells.reference, base.scale, [log], change)
        < FOLLOWED_RATIO * noise * log.time_s.size
        for log in judges
    )


def _is_followed(log: Log, fit: Callable[[Log], Candidate], noise: float) -> bool:
    """Whether a model that is fitted to a log alone leaves noise, or there is nothing to fit."""
    with suppress(IdentificationError, InputError):
        alone = fit(log)
        left = squares_of(alone.problem, alone.minimum.point)
        return left < FOLLOWED_RATIO * noise * alone.problem.n_samples / len(alone.problem.outputs)
    return True
