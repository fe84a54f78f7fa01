"""Angles that begin again at the end of a turn, put one behind the other.

An encoder tells its angle within one turn: it goes from the upper end of its range to the lower one
while the actuator bends on. Behind it a converter may add noise, so that readings pass the ends a
little.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.channels import Channel
from softid.errors import Issue
from softid.readers.base import Array, IntArray
from softid.readers.overflow import shifted
from softid.readers.samples import Samples
from softid.units import lookup_unit

TURN_RAD = 2.0 * np.pi

WRAPPED = "wrapped-angle"
"""Code of what is told of an angle that begins again at the end of a turn."""

NEARLY_A_TURN = 0.9
"""Share of a turn that an angle jumps at least where it begins again."""

HARDLY_MORE = 1.1
"""Share of a turn that the range of such an angle spans at most, with the noise beyond its ends."""

SMOOTH = 0.1
"""Share of a turn that a wrapped angle moves at most from sample to sample elsewhere: what jumps so
far by itself is no motion."""

BESIDE = 4
"""Moves on either side of a jump that say how fast the angle moves there."""

LIKE_BESIDE = 2.0
"""Where it begins again, an angle that is put behind itself moves at most so many times as far as
beside the jump. A step of nearly a turn that somebody wanted begins and ends in rests."""

OF_NOISE = 8.0
"""Median moves that noise makes in turns at most: moves over an end on which the angle rests are
the largest, and those that are left beside them the smallest."""


@dataclass(frozen=True, eq=False)
class Turns:
    """Where an angle begins again at the end of a turn.

    Attributes
    ----------
    at
        The first samples behind the ends, shape (m,).
    before
        The samples before these, shape (m,).
    going_on
        The angle as it goes on, shape (n,); None where something else than turns is in it, too.
    others
        Jumps of nearly a turn behind which it does not go on.
    largest_move
        How far it moves at most from sample to sample as it goes on, in its unit.
    """

    at: IntArray
    before: IntArray
    going_on: Array | None
    others: int
    largest_move: float

    @property
    def how_often(self) -> str:
        """In words, before the place of the first."""
        return "once" if self.at.size == 1 else f"{self.at.size} times, the first"


def find_turns(time_s: Array, angle: Array, turn: float = TURN_RAD) -> Turns:
    """Find where an angle begins again at the end of a turn.

    It does where it jumps by nearly a turn, and would move on as beside the jump if all behind were
    moved by a turn. So neither a step of nearly a turn nor a reading that was lost is one.

    Parameters
    ----------
    time_s
        Times, rising, shape (n,).
    angle
        Angles, shape (n,); NaN where nothing was recorded.
    turn
        A turn in the unit of the angle.
    """
    known = np.flatnonzero(np.isfinite(angle))
    steps = np.diff(angle[known])
    jumps = np.flatnonzero(
        (np.abs(steps) > NEARLY_A_TURN * turn) & (np.abs(steps) < (2.0 - NEARLY_A_TURN) * turn)
    )
    nowhere = np.empty(0, np.int64)
    if jumps.size == 0:
        return Turns(nowhere, nowhere, None, 0, 0.0)
    found = shifted(angle, known, jumps, -np.sign(steps[jumps]) * turn)
    moves = np.abs(np.diff(found.values[known]))
    ends = jumps[_moves_on(time_s[known], moves, jumps)]
    others, largest = jumps.size - ends.size, float(moves.max())
    is_one_turn = float(np.ptp(angle[known])) <= HARDLY_MORE * turn
    whole = others == 0 and largest <= SMOOTH * turn and is_one_turn
    return Turns(known[ends + 1], known[ends], found.values if whole else None, others, largest)


def _moves_on(time_s: Array, moves: Array, jumps: IntArray) -> npt.NDArray[np.bool_]:
    """Whether the moves over some jumps are like those beside them, shape (m,).

    Over an interval that lost samples it may move longer.
    """
    others = np.delete(moves, jumps)
    moving = others[others > 0.0]
    if moving.size == 0:
        return np.zeros(jumps.size, np.bool_)
    least = max(OF_NOISE * float(np.median(others)), LIKE_BESIDE * float(moving.min()))
    alone = moves.copy()
    alone[jumps] = 0.0  # a reading that was lost makes two jumps, neither of which proves the other
    padded = np.pad(alone, BESIDE)
    around = np.delete(np.arange(2 * BESIDE + 1), BESIDE)
    beside = padded[jumps[:, None] + around].max(axis=1)
    interval_s = np.diff(time_s)
    longer = np.maximum(interval_s[jumps] / float(np.median(interval_s)), 1.0)
    like: npt.NDArray[np.bool_] = moves[jumps] <= np.maximum(LIKE_BESIDE * beside, least) * longer
    return like


def turn_of(channel: Channel) -> float | None:
    """A turn in the unit of a channel; None where that is no unit of angle.

    Parameters
    ----------
    channel
        Any channel.
    """
    unit = lookup_unit(channel.unit)
    return TURN_RAD / unit.factor if unit is not None and unit.quantity == "angle" else None


def jumps_in_words(channel: Channel, found: Turns, turn: float, place: str) -> str:
    """That an angle jumps by a turn, how often, and where it does first, for a message.

    Parameters
    ----------
    channel
        The angle.
    found
        Where it jumps.
    turn
        A turn in its unit.
    place
        Where the first of these is, such as ``"in row 12"``.
    """
    first, last = found.before[0], found.at[0]
    before, behind = (channel.values[k] * channel.display_factor for k in (first, last))
    return (
        f"jumps by a turn, {turn * channel.display_factor:.4g} {channel.display_unit}, "
        f"{found.how_often} {place} (from {before:.4g} to {behind:.4g} {channel.display_unit})"
    )


def with_angles_turned_on(samples: Samples, outputs: Collection[str] = ()) -> Samples:
    """The samples with angles that go on where they passed the end of a turn, and say so.

    Where an angle jumps otherwise, too, or spans more than a turn, it stays as it is, and that is
    told.

    Parameters
    ----------
    samples
        Samples in order of time.
    outputs
        What is to be explained, which may be angles under any name; others have to be known ones.
    """
    channels: dict[str, Channel] = {}
    issues = []
    for name, channel in samples.channels.items():
        turn = turn_of(channel) if name in outputs or channel.unit == "rad" else None
        found = None if turn is None else find_turns(samples.time_s, channel.values, turn)
        if found is None or turn is None or found.at.size == 0:
            continue
        told = f"{samples.column(name)}: the {name} " + jumps_in_words(
            channel, found, turn, f"in {samples.row(int(found.at[0]))}"
        )
        if found.going_on is None:
            issues.append(_left(told, channel, found, turn))
            continue
        channels[name] = replace(channel, values=found.going_on)
        issues.append(
            Issue(
                WRAPPED,
                "info",
                f"{told}; it is taken to go on",
                "choose the zero of the sensor so that no motion passes the end of its range",
            )
        )
    joined: Mapping[str, Channel] = {**samples.channels, **channels}
    return replace(samples, channels=joined, issues=(*samples.issues, *issues))


def _left(told: str, channel: Channel, found: Turns, turn: float) -> Issue:
    """What is told of an angle that stays as it is."""
    factor, unit = channel.display_factor, channel.display_unit
    if found.others:
        why = f"at {found.others} more places it jumps as far and does not go on"
    elif found.largest_move > SMOOTH * turn:
        why = f"it also jumps by {found.largest_move * factor:.4g} {unit}"
    else:
        span = float(np.nanmax(channel.values) - np.nanmin(channel.values))
        why = f"it spans {span * factor:.4g} {unit}"
    return Issue(
        WRAPPED, "warning", f"{told}, but stays as it is, for {why}", unwrapping(channel, turn)
    )


def unwrapping(channel: Channel, turn: float) -> str:
    """What to do with an angle that softid leaves as it is.

    Parameters
    ----------
    channel
        The angle.
    turn
        A turn in its unit.
    """
    return (
        "if the sensor begins again there, put the angle behind itself, as "
        f"numpy.unwrap(angle, period={turn * channel.display_factor:.4g}) does"
    )
