"""Which experiments logs hold already, so that nobody is told to record what is on record."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from softid.diagnosis.verdict.separations import CHIRP, HOLD, SINE, STAIRCASE, STEPS
from softid.errors import Issue
from softid.excitation import SettledWindow, Stretch, distinct_levels, excitation_and_holds
from softid.log import Log
from softid.quality.abilities import CREEP_HOLD_S, LEVEL_SPACING

QUICK_S = 0.15
"""Time in which an input makes most of its way in a quick change. A judgement: a usual valve takes
a few hundredths of a second, and advice to be quicker could hardly be followed."""

QUICK_HZ = 1.0
"""Frequency that a chirp must reach to be quick: it moves in `QUICK_S` as far as a lag of that time
lets through."""

MOST_OF_WAY = 0.63
"""Share of the way by which a change is timed: a lag makes it in its time constant."""

LEAST_CHANGE = 0.15
"""Share of the input's range that a change passes at least to be timed."""

FEW = 3
"""Quick changes that make an experiment: one up and one down are the least, and one may be lost."""

BOTH_WAYS = 2
"""Levels reached from below and from above that make a staircase up and down."""

SLOW_HOLD_S = 2.0
"""Time for which a usual level of a slow staircase is held at least. A judgement: soft actuators
settle within it."""

RECORD = "record "
"""How advice begins that asks for an experiment."""

SEE_MORE = "record these moves again, sampled faster or with less noise"
"""Advice where the experiment that would help is on record."""

ANY_OF: dict[str, tuple[str, ...]] = {
    SINE: (SINE,),
    STAIRCASE: (STAIRCASE,),
    STEPS: (STEPS,),
    HOLD: (HOLD,),
    CHIRP: (CHIRP,),
    "fast steps, or a chirp": (STEPS, CHIRP),
    "fast steps, or a chirp beyond the ringing frequency": (STEPS,),
    "fast steps up and down between the same levels": (STEPS,),
    "a chirp up to the bandwidth of the actuator": (CHIRP,),
    "fast steps or a chirp past the natural frequency, sampled well above it": (STEPS, CHIRP),
}
"""Experiments as the advice names them, and which of the plain ones are enough for each."""


def held_experiments(logs: Iterable[Log]) -> frozenset[str]:
    """Which of the experiments `SINE`, `STAIRCASE`, `STEPS`, `HOLD` and `CHIRP` some logs hold.

    Parameters
    ----------
    logs
        Logs; what is looked at is the input as it was recorded.
    """
    held: set[str] = set()
    for log in logs:
        held |= _held(log.as_recorded)
    return frozenset(held)


def is_held(advised: str, held: frozenset[str]) -> bool:
    """Whether an experiment need not be recorded any more.

    Parameters
    ----------
    advised
        What to record, in the words of the catalogue; of words that are unknown here, and of what
        needs more than an input, nothing is held.
    held
        From `held_experiments`.
    """
    return not held.isdisjoint(ANY_OF.get(advised, ()))


def with_advice_lacking(issues: Iterable[Issue], held: frozenset[str]) -> tuple[Issue, ...]:
    """Remarks of which none advises to record what is on record.

    Parameters
    ----------
    issues
        Remarks, with advice as ``"record "`` and an experiment of the catalogue.
    held
        From `held_experiments`.
    """
    return tuple(
        replace(issue, remedy=SEE_MORE)
        if is_held((issue.remedy or "").removeprefix(RECORD), held)
        else issue
        for issue in issues
    )


def moves_quickly(held: frozenset[str]) -> bool:
    """Whether some input changes as quickly as it well can.

    Parameters
    ----------
    held
        From `held_experiments`.
    """
    return not held.isdisjoint((STEPS, CHIRP))


def _held(log: Log) -> set[str]:
    u = log.channels[log.input].values
    if not np.isfinite(u).all():
        return set()
    stretches, windows = excitation_and_holds(log.time_s, u)
    if all(stretch.kind == "rest" for stretch in stretches):
        return set()  # its noise is all that changes
    held = set()
    if any(stretch.kind == "sine" for stretch in stretches):
        held.add(SINE)
    if any(_highest_hz(stretch) >= QUICK_HZ for stretch in stretches):
        held.add(CHIRP)
    if _quick_changes(log, windows) >= FEW:
        held.add(STEPS)
    holds_s = [log.time_s[w.stop - 1] - log.time_s[w.start] for w in windows]
    is_slow = bool(holds_s) and float(np.median(holds_s)) >= SLOW_HOLD_S
    if is_slow and _levels_both_ways(windows, LEVEL_SPACING * float(np.ptp(u))) >= BOTH_WAYS:
        held.add(STAIRCASE)
    if _holds_and_rests(log, windows):
        held.add(HOLD)
    return held


def _highest_hz(stretch: Stretch) -> float:
    if stretch.shape != "chirp":
        return 0.0
    return max(stretch.frequency_hz or 0.0, stretch.frequency_end_hz or 0.0)


def _quick_changes(log: Log, windows: Sequence[SettledWindow]) -> int:
    """Changes between two holds of which most is over in `QUICK_S`."""
    u, found = log.channels[log.input].values, 0
    least = LEAST_CHANGE * float(np.ptp(u))
    for before, after in pairwise(windows):
        if abs(after.level - before.level) < least:
            continue
        part = slice(before.stop - 1, after.stop)
        way = (u[part] - before.level) / (after.level - before.level)
        made = np.flatnonzero(way >= MOST_OF_WAY)
        begins_s = log.time_s[before.stop - 1]
        found += bool(made.size) and log.time_s[part][made[0]] - begins_s <= QUICK_S
    return found


def _levels_both_ways(windows: Sequence[SettledWindow], spacing: float) -> int:
    """Levels that are reached from below and from above."""
    up = [b.level for a, b in pairwise(windows) if b.level > a.level + spacing]
    down = [b.level for a, b in pairwise(windows) if b.level < a.level - spacing]
    both = [level for level in up if any(abs(level - other) <= spacing for other in down)]
    return len(distinct_levels(both, spacing))


def _holds_and_rests(log: Log, windows: Sequence[SettledWindow]) -> bool:
    """Whether a long hold at a high level is followed by a long one at a low level."""
    long = [
        window
        for window in windows
        if log.time_s[window.stop - 1] - log.time_s[window.start] >= CREEP_HOLD_S
    ]
    least = LEAST_CHANGE * float(np.ptp(log.channels[log.input].values))
    return any(a.level - b.level >= least for a, b in pairwise(long))
