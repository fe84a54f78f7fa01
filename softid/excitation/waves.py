"""Long sines, triangles and chirps, whose extremes stand still for a moment but are no holds."""

from __future__ import annotations

import numpy as np

from softid.excitation.holds import find_holds
from softid.excitation.motion import Motion
from softid.excitation.shapes import recognise_shapes

LONG_WAVE_CYCLES = 3
"""Cycles from which a motion is a wave: as few steps up and down may well be alike."""

MOST_HELD_OF_WAVE = 0.5
"""Share of a wave that may be held, strictly, at its extremes: of more it is steps between levels,
with slow edges."""

LONGEST_EXTREME = 0.8
"""Longest extreme of a wave, in its half cycles: one that lasts as long as a half cycle is a hold
before or after the wave."""

WAVE_MARGIN = 0.7
"""Cycles by which a wave reaches beyond its first and last turning point: the extremes next to them
are half a cycle away and have a width."""

INSIDE_SHARE = 0.5
"""Share of a hold inside a wave from which it belongs to it."""


def holds_between_waves(motion: Motion) -> list[tuple[int, int]]:
    """The holds of a motion, without the extremes of its waves."""
    spans = find_holds(motion)
    for wave in long_waves(motion):
        spans = [s for s in spans if not _is_extreme(motion, s, wave)]
    return spans


def long_waves(motion: Motion) -> list[tuple[int, int]]:
    """Ranges that are a sine, triangle or chirp over several cycles, whose extremes are no holds.

    Most of a cycle is added on either side, for the extremes there.
    """
    if motion.turns.size < 2 * LONG_WAVE_CYCLES:
        return []
    times = motion.time_s
    spans = find_holds(motion, strict=True)
    found = []
    for piece in recognise_shapes(times, motion.values, motion.turns):
        inside = motion.turns[(motion.turns >= piece.start) & (motion.turns < piece.stop)]
        if piece.shape in ("free", "ramp") or inside.size < 2 * LONG_WAVE_CYCLES:
            continue
        first, last = int(inside[0]), int(inside[-1])
        held = [min(b, last) - max(a, first) for a, b in spans if a < last and b > first]
        if sum(held) > MOST_HELD_OF_WAVE * (last - first):
            continue
        before_s = WAVE_MARGIN * float(times[inside[2]] - times[inside[0]])
        after_s = WAVE_MARGIN * float(times[inside[-1]] - times[inside[-3]])
        found.append(
            (
                int(np.searchsorted(times, times[first] - before_s)),
                int(np.searchsorted(times, times[last] + after_s)),
            )
        )
    return found


def _is_extreme(motion: Motion, span: tuple[int, int], wave: tuple[int, int]) -> bool:
    """Whether a hold lies for the most part inside a wave and is shorter than its half cycles."""
    overlap = min(span[1], wave[1]) - max(span[0], wave[0])
    if overlap <= INSIDE_SHARE * (span[1] - span[0]):
        return False
    times, turns = motion.time_s, motion.turns
    nearest = np.sort(np.abs(turns - span[0]).argsort()[:5])
    half_s = float(np.median(np.diff(times[turns[nearest]])))
    return float(times[span[1] - 1] - times[span[0]]) <= LONGEST_EXTREME * half_s
