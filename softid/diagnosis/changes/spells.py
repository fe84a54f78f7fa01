"""Whether a misfit is confined to spells: a gust, a valve that stuck, a load that slipped off.

A fit to the whole of a log bends towards a spell and leaves something everywhere. So the model is
fitted to a part of the log, what it follows elsewhere is added to that part, and so on: random
sample consensus (Fischler and Bolles, Comm. ACM 24, 381, 1981) with parts in place of random ones.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import minimum_filter1d

from softid.diagnosis.changes.motion_range import MotionRange, motion_of
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOut, HeldOutBlocks, HeldOutLogs
from softid.diagnosis.residual.noise_floor import DEAD_AFTER, fastest_part
from softid.errors import IdentificationError, InputError
from softid.intersample import is_abrupt
from softid.log import Log

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

FIRST_PARTS = 3
"""Parts of a log that a search begins with, each in turn, after the whole of it."""

FITS_PER_PART = 4
"""Fits from a part to what the model follows."""

LOUD_SQUARE = 4.0
"""A spell is where the squared residual is larger than so many variances on the average."""

LOUDEST = 12.0
"""Largest squared residual that counts, in variances: with more the quiet between two spells would
count for nothing."""

LEAST_EVIDENCE = 100.0
"""Least sum over a spell of the squared residuals beyond `LOUD_SQUARE`, in variances: noise sums up
to less."""

MOST_SPELLS = 3
"""Most spells of a log that count as such; what is loud more often is no exception."""

LESSER = 0.05
"""A further spell has so large a share of that of the first one."""

QUIET = 1.25
"""Outside of spells no more is left than so many times the variance of the noise."""

LEAST_CONTRAST = 12.0
"""Times the variance outside of all spells that the mean square in them exceeds."""

LEAST_OUTSIDE = 0.4
"""Least share of a log outside of its spells: what is followed for less is no rule with
exceptions."""

BEGINNING = 0.1
"""What begins in this share of a log may be no spell, for much relaxes after the first motion."""

STILL = 0.1
"""An actuator that moves by less than this share of its range behind a spell is at rest there."""


@dataclass(frozen=True, eq=False)
class Spells:
    """Where the misfit of a log is, and a model that follows the rest.

    Attributes
    ----------
    spans_s
        Begin and end of each spell, in time.
    reference
        The model as it is fitted outside of them.
    before, noise
        Sums of squares of the first output in the spells: what that model leaves, and the noise.
    usual, within
        How the actuator moves outside of the spells, and in them.
    begins_early, ends_last
        Whether the first of them begins with the log, and the last lasts to its end.
    """

    spans_s: tuple[tuple[float, float], ...]
    reference: Candidate
    before: float
    noise: float
    usual: MotionRange
    within: Array
    begins_early: bool
    ends_last: bool

    @property
    def is_met(self) -> bool:
        """Whether positions, speeds and accelerations of the spells are met outside of them."""
        return self.usual.holds_nearly_all(self.within)

    @property
    def is_one_part(self) -> bool:
        """Whether it is one spell, which parts a log in two."""
        return len(self.spans_s) == 1 and self.begins_early != self.ends_last


def spells_of(log: Log, fit: Callable[[Log], Candidate], noise: float) -> Spells | None:
    """The spells to which the misfit of a log is confined, if it is.

    Parameters
    ----------
    log
        The log.
    fit
        Fits the model to a log some of whose samples are left out.
    noise
        Variance of the noise of the first output.
    """
    found: list[Spells] = []
    for part in range(FIRST_PARTS + 1):
        outside = np.ones(len(log), bool)
        if part > 0:
            at = np.arange(len(log)) * FIRST_PARTS // len(log)
            outside = at == part - 1
        with suppress(IdentificationError, InputError):  # a part may be at rest, or not measured
            one = _grown(log, fit, noise, outside)
            found += [one] if one is not None else []
    return min(found, key=_length, default=None)


def spells_elsewhere(log: Log, model: Candidate, noise: float) -> int | None:
    """How many spells a model that leaves noise in most of another log does not follow there.

    Parameters
    ----------
    log
        The log.
    model
        A model, fitted to another log.
    noise
        Variance of the noise of the first output.

    Returns
    -------
    int or None
        None where it leaves more than noise elsewhere, too.
    """
    residual = _of_first_output(HeldOutLogs((log,)), model)
    if not np.isfinite(residual).all():
        return None
    residual = residual - np.median(residual)  # a spell of its own pulls at its zero
    own = max(noise, fastest_part([residual]).variance)
    quiet = np.ones(residual.size, bool)
    stretches = _loud_stretches(_loudness(residual, own))
    for begin, end in stretches:
        quiet[begin:end] = False
    if np.count_nonzero(quiet) < LEAST_OUTSIDE * quiet.size:
        return None
    return len(stretches) if float(np.mean(residual[quiet] ** 2)) <= QUIET * own else None


def moves_as_in(log: Log, spells: Spells) -> bool:
    """Whether another log moves as far, as fast and as unevenly as a log does in its spells.

    Parameters
    ----------
    log
        The other log.
    spells
        The spells.
    """
    judged = HeldOutLogs((log,)).standing(spells.reference)
    motion = None if judged is None else motion_of(judged)
    return motion is not None and MotionRange.of(motion).holds_nearly_all(spells.within)


def usual_samples(log: Log, spells: Spells, motion_s: float) -> BoolArray:
    """Where another log moves no otherwise than a log does outside of its spells, shape (n,).

    Parameters
    ----------
    log, spells
        As in `moves_as_in`.
    motion_s
        Time constant of the motion, which remembers for a while how it moved.
    """
    found = np.zeros(len(log), bool)
    judged = HeldOutLogs((log,)).standing(spells.reference)
    motion = None if judged is None else motion_of(judged)
    if judged is None or motion is None:
        return found
    reach = 1 + 2 * int(np.ceil(DEAD_AFTER * motion_s / log.period_s))
    is_usual: BoolArray = np.all(spells.usual.holds(motion), axis=0)
    begin = 0
    for segment in judged.problem.segments:
        size = segment.stop - segment.start
        near = minimum_filter1d(is_usual[begin : begin + size].astype(np.int8), reach)
        found[segment.start : segment.stop], begin = near > 0, begin + size
    return found


def _length(spells: Spells) -> tuple[bool, float]:
    """How long spells are; those whose motion is met elsewhere are the shorter ones."""
    return not spells.is_met, sum(end - begin for begin, end in spells.spans_s)


def is_of_a_jump(log: Log, span_s: tuple[float, float], motion_s: float) -> bool:
    """Whether a spell is over when the motion has settled behind a jump of the input.

    What is left there may be the moment of the jump, which falls between two samples.

    Parameters
    ----------
    log
        The log.
    span_s
        Begin and end of the spell.
    motion_s
        Time constant of the motion.
    """
    abrupt = np.flatnonzero(is_abrupt(log.channels[log.input].values))
    begin, end = span_s
    jumps_s = log.time_s[abrupt]
    return bool(np.any((jumps_s <= begin) & (end <= jumps_s + DEAD_AFTER * motion_s)))


def residual_in(log: Log, model: Candidate) -> tuple[npt.NDArray[np.intp], Array]:
    """Places of the used samples of a log and what a model leaves of the first output there.

    Parameters
    ----------
    log
        The log.
    model
        A model, fitted to it or to a part of it.
    """
    everywhere = HeldOutBlocks((log,), (np.ones(len(log), bool),))
    first = model.problem.outputs[0]
    at = [s.start + np.flatnonzero(s.samples_of(s.used[first])) for s in log.segments()]
    return np.concatenate(at), _of_first_output(everywhere, model)


def loudest(excess: Array) -> tuple[int, int, float]:
    """The stretch of samples with the largest sum (Kadane): begin, end and that sum.

    Parameters
    ----------
    excess
        A number for every sample, shape (n,).

    Examples
    --------
    >>> import numpy as np
    >>> loudest(np.array([-1.0, 2.0, -1.0, 3.0, -5.0, 1.0]))
    (1, 4, 4.0)
    """
    sums = np.concatenate(([0.0], np.cumsum(excess)))
    low = np.minimum.accumulate(sums)
    end = int(np.argmax(sums - low))
    begin = int(np.argmin(sums[: end + 1]))
    return begin, end, float(sums[end] - sums[begin])


def _grown(
    log: Log, fit: Callable[[Log], Candidate], noise: float, outside: BoolArray
) -> Spells | None:
    """The spells beside a part of a log, after the part has grown by all that the model follows."""
    model, spans = fit(log if outside.all() else log.with_masked(~outside)), []
    for _ in range(FITS_PER_PART):
        at, residual = residual_in(log, model)
        inside = ~outside[at]
        if not np.isfinite(residual).all() or inside.all():
            return None
        variance = max(float(np.mean(residual[~inside] ** 2)), noise)
        spans = _loud_stretches(_loudness(residual, variance))
        grown = np.ones(len(log), bool)
        for begin, end in spans:
            grown[at[begin] : at[end - 1] + 1] = False
        if np.count_nonzero(grown) < LEAST_OUTSIDE * grown.size / FIRST_PARTS:
            return None
        if not spans or (grown == outside).all():
            break
        outside = grown
        model = fit(log.with_masked(~outside))
    return _judged(log, model, outside, noise) if spans else None


def _judged(log: Log, model: Candidate, outside: BoolArray, noise: float) -> Spells | None:
    """The spells, if outside of them no more than noise is left, in most of the log."""
    at, residual = residual_in(log, model)
    motion = motion_of(model)
    if motion is None or outside.all():
        return None
    outside = _without_rest_at_end(model, motion, outside)
    inside = ~outside[at]
    if not inside.any() or np.count_nonzero(~inside) < LEAST_OUTSIDE * inside.size:
        return None
    variance = float(np.mean(residual[~inside] ** 2))
    own = max(noise, fastest_part([residual[~inside]]).variance)  # logs differ in their noise
    if variance > QUIET * own:
        return None
    before = float(np.sum(residual[inside] ** 2))
    if before < LEAST_CONTRAST * variance * np.count_nonzero(inside):
        return None
    edges = np.flatnonzero(np.diff(np.concatenate(([0], (~outside).astype(int), [0]))))
    spans = tuple(
        (float(log.time_s[begin]), float(log.time_s[end - 1]))
        for begin, end in edges.reshape(-1, 2).tolist()
    )
    noise_there = variance * np.count_nonzero(inside)
    begins_early, ends_last = bool(edges[0] < BEGINNING * len(log)), bool(edges[-1] == len(log))
    without = np.concatenate([outside[s.start : s.stop] for s in model.problem.segments])
    if without.all() or not without.any():
        return None
    usual, within = MotionRange.of(motion[:, without]), motion[:, ~without]
    return Spells(spans, model, before, noise_there, usual, within, begins_early, ends_last)


def _without_rest_at_end(model: Candidate, motion: Array, outside: BoolArray) -> BoolArray:
    """What is outside of spells, but for a rest after the last: what lasts may not show there."""
    at = np.concatenate([np.arange(s.start, s.stop) for s in model.problem.segments])
    last = int(np.flatnonzero(~outside)[-1])
    x = motion[0]
    behind = x[at > last]
    if behind.size and np.ptp(behind) < STILL * np.ptp(x):
        outside = outside & (np.arange(outside.size) <= last)
    return outside


def _loudness(residual: Array, variance: float) -> Array:
    return np.minimum(residual**2 / variance, LOUDEST) - LOUD_SQUARE


def _loud_stretches(excess: Array) -> list[tuple[int, int]]:
    """Stretches whose sums are no noise, the loudest first."""
    pieces, least = [(0, excess.size)], LEAST_EVIDENCE
    found: list[tuple[int, int]] = []
    while pieces and len(found) < MOST_SPELLS:
        within = [(loudest(excess[a:b]), a, b) for a, b in pieces]
        (begin, end, total), a, b = max(within, key=lambda row: row[0][2])
        if total < least:
            break
        found.append((a + begin, a + end))
        pieces.remove((a, b))
        pieces += [(a, a + begin), (a + end, b)]
        least = max(least, LESSER * total)
    return found


def _of_first_output(held_out: HeldOut, model: Candidate) -> Array:
    first = model.problem.outputs[0]
    rows = held_out.errors(model)
    return np.concatenate([row.residual for row in rows if row.channel == first])
