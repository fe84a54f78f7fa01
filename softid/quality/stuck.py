"""Stretches on which a channel is stuck: frozen at some value, or saturated at an extreme one."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.quality.findings import Frozen, Reason, Saturation
from softid.quality.trace import MIN_DISTINCT, Runs, Trace, weighted_median

Array = npt.NDArray[np.float64]

FROZEN_SAMPLES = 30
"""Samples, or holds, of one value from which a channel may be frozen."""

FROZEN_S = 1.0
"""Time in s of one value from which a channel may be frozen, where it stands while the input moves:
a late answer stands, too."""

NOISELESS_S = 0.2
"""Time in s of one value from which a channel may be frozen, where its noise vanishes: of a fast
log thirty samples are no time at all."""

STUCK_SAMPLES = 5
"""Samples, or holds, of one value from which a channel that its noise moves all the time may be
stuck for a moment."""

BY_CHANCE = 1e-4
"""Expected number of runs as long as one in a log, by the share of samples that repeat the one
before elsewhere, below which noise does not make it."""

STALE_JUMP = 6.0
"""Noise, in standard deviations, by which the reading is elsewhere after a stretch without any: it
did not see where the actuator went, and nothing that stands still jumps. Nor did it where the input
went elsewhere and came back."""

FROZEN_OVER_USUAL = 20.0
"""Length of a run of one value, in usual runs of a noisy channel, from which it may be frozen: on a
coarse grid these are long."""

FROZEN_INPUT_MOVE = 0.15
"""Share of its range by which the input is elsewhere for most of a stretch on which an output
cannot well stand still: creep, friction and a dead zone explain less."""

FLAT_SAMPLES = 5
"""Samples, or holds, of the extreme value from which it may be a limit; a smooth extreme on a grid
has as many where the grid is coarse, hence `FLAT_OVER_USUAL`."""

FLAT_OVER_USUAL = 10.0
"""Length of a run of the extreme value, in usual runs of other values, from which it may be a
limit."""

ARRIVING = 6
"""Moves by which a channel without noise runs into a limit: enough for a usual one."""

CUT_SHORT = 2
"""Last moves of a run into a limit of which one must be quick: the very last is cut short by the
limit."""

ARRIVAL_SPEED = 0.7
"""Share of the usual move that one of the last moves into a limit must have: a motion that comes to
rest by itself slows down over all of them."""

ARRIVAL_STEPS = 2.0
"""Usual move, in steps of the grid, from which the speed of a channel that runs into a limit is
known at all."""


def may_be_stuck(values: Array) -> bool:
    """Whether `find_saturation` or `find_frozen` can find anything, without what takes long.

    Parameters
    ----------
    values
        All samples of the log, shape (n,); may hold NaN.
    """
    repeats = int(np.count_nonzero(values[1:] == values[:-1]))
    if repeats < FLAT_SAMPLES - 1:
        return False
    runs = Runs.of(values)
    return runs.start.size >= MIN_DISTINCT and int(runs.length.max()) >= FLAT_SAMPLES


def find_frozen(trace: Trace, input_values: Array | None) -> tuple[Frozen, ...]:
    """Find stretches on which a channel that is alive elsewhere repeats one value exactly.

    Parameters
    ----------
    trace
        The channel.
    input_values
        What drives it, shape (n,); None for the input itself and for commands.
    """
    runs = Runs.of(trace.values)
    if runs.start.size < MIN_DISTINCT:
        return ()
    held_s = trace.time_s[runs.stop - 1] - trace.time_s[runs.start]
    found: list[Frozen] = []
    usual = weighted_median(runs.length[runs.length < FROZEN_SAMPLES * trace.repeats])
    least = max(FROZEN_SAMPLES * trace.repeats, FROZEN_OVER_USUAL * usual)
    extremes = (float(runs.value.min()), float(runs.value.max()))
    is_long = (runs.length >= FROZEN_SAMPLES) & (held_s >= NOISELESS_S)
    found += [_frozen(trace, runs, k, "stale") for k in _momentary(trace, runs) if not is_long[k]]
    for k in np.flatnonzero(is_long):
        span = slice(int(runs.start[k]), int(runs.stop[k]))
        value = float(runs.value[k])
        reason: Reason
        if value in extremes:
            continue
        moves = input_values is not None and _moves(input_values, span)
        if trace.noisy and runs.length[k] >= least:
            stale = moves or _jumps_behind(trace, runs, int(k))
            reason = "stale" if stale else "noise vanishes"
        elif held_s[k] >= FROZEN_S and moves:
            reason = "input moves"
        else:
            continue
        found.append(_frozen(trace, runs, int(k), reason))
    return tuple(sorted(found, key=lambda frozen: frozen.start))


def _momentary(trace: Trace, runs: Runs) -> list[int]:
    """Runs that noise does not make, and behind which the reading is elsewhere."""
    if not trace.noisy:
        return []
    short = runs.length < STUCK_SAMPLES * trace.repeats
    samples = int(runs.length[short].sum())
    repeated = samples - int(np.count_nonzero(short))
    share = max(repeated, 1) / max(samples, 1)
    expected = runs.length.sum() * share ** (runs.length / trace.repeats - 1.0)
    inside = (runs.value > runs.value.min()) & (runs.value < runs.value.max())
    odd = np.flatnonzero(~short & (expected < BY_CHANCE) & inside)
    return [int(k) for k in odd if _jumps_behind(trace, runs, int(k))]


def _frozen(trace: Trace, runs: Runs, k: int, reason: Reason) -> Frozen:
    start, stop = int(runs.start[k]), int(runs.stop[k])
    begins_s, ends_s = float(trace.time_s[start]), float(trace.time_s[stop - 1])
    return Frozen(start, stop, begins_s, ends_s - begins_s, float(runs.value[k]), reason)


def _jumps_behind(trace: Trace, runs: Runs, k: int) -> bool:
    """Whether the value behind a run lies further off than noise carries it."""
    if k + 1 == runs.start.size or trace.noise_std is None:
        return False
    return abs(float(runs.value[k + 1] - runs.value[k])) > STALE_JUMP * trace.noise_std


def _moves(input_values: Array, span: slice) -> bool:
    """Whether the input spends most of a range far from where it was at its start."""
    travel = np.abs(input_values[span] - input_values[span.start])
    return float(np.median(travel)) >= FROZEN_INPUT_MOVE * float(np.ptp(input_values))


def find_saturation(trace: Trace) -> tuple[Saturation, ...]:
    """Find flat tops and bottoms at an exact extreme value.

    Noise cannot repeat an extreme value many times in a row. An output without visible noise is
    saturated when it runs into the extreme at full speed and stops there at once; an input may do
    that on purpose.

    Parameters
    ----------
    trace
        The channel.
    """
    runs = Runs.of(trace.values)
    if runs.start.size < MIN_DISTINCT:
        return ()
    found = []
    for side, value in (("low", runs.value.min()), ("high", runs.value.max())):
        flat = np.flatnonzero(runs.value == value)
        long = flat[runs.length[flat] >= FLAT_SAMPLES * trace.repeats]
        usual = weighted_median(runs.length[runs.value != value])
        caught = long[runs.length[long] >= FLAT_OVER_USUAL * usual]
        if not trace.noisy:
            stops = [
                k for k in caught if trace.kind == "output" and _stops_dead(trace, runs, int(k))
            ]
            caught = np.array(stops, dtype=np.intp)
        if not caught.size:
            continue
        held_s = trace.time_s[runs.stop[caught] - 1] - trace.time_s[runs.start[caught]]
        found.append(
            Saturation(
                side,  # type: ignore[arg-type]
                float(value),
                int(caught.size),
                float(runs.length[flat].sum() / runs.length.sum()),
                float(trace.time_s[runs.start[caught[0]]]),
                float(held_s.max()),
            )
        )
    return tuple(found)


def _stops_dead(trace: Trace, runs: Runs, k: int) -> bool:
    """Whether the channel runs into a flat as quickly as it moved a little before.

    The very last move is cut short by the limit, so the one before it may speak.
    """
    moves = np.diff(runs.value[max(k - ARRIVING, 0) : k + 1])
    if moves.size < ARRIVING or not (np.all(moves > 0) or np.all(moves < 0)):
        return False
    sizes = np.abs(moves)
    usual = float(np.median(sizes[:-CUT_SHORT]))
    quick = sizes[-CUT_SHORT:].max() >= ARRIVAL_SPEED * usual
    return bool(quick and usual > ARRIVAL_STEPS * trace.step)
