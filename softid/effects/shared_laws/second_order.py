"""Bounds and plausible values of a law of second order: its period and its damping ratio."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from softid.effects.scale import Scale
from softid.effects.shared_laws.time_constants import first_time, last_time, time_bounds
from softid.parameters import Parameter, ParameterSet

SHORTEST_PERIODS = 4.0
"""Shortest ringing period in sampling intervals: what rings faster is not told from what the input
does between two samples."""

LONGEST_SHARE = 0.25
"""Longest ringing period as a share of the log, which then holds four of them, unless it has hardly
more samples than a period."""

ZETA = (0.02, 3.0)
"""Bounds of the damping ratio. At the lower one a ring takes nine periods to fall to a third; air
in a tube and soft mounts are damped more. At the upper one the two time constants are as 34 to 1,
and the law is the lag of the larger."""

WELL_DAMPED = 0.7
"""From this damping ratio on a step overshoots by less than a twentieth: nobody sees it ring."""

START_ZETA = 0.2
"""Damping ratio at which a search begins: a step overshoots by half."""

START_PERIODS = 6.0
"""Shortest start in sampling intervals, clear of the bound."""

SLOWEST = 4.0
"""Longest start in times of the motion."""


def ringing_parameters(scale: Scale, *, what: str, source: str) -> ParameterSet:
    """The ringing period 2π/ω and the damping ratio ζ.

    Parameters
    ----------
    scale
        Sizes of the logs.
    what
        What rings, for the meaning of the damping ratio.
    source
        Where the law comes from.
    """
    return ParameterSet(
        (
            Parameter(
                "period",
                _periods(scale)[1],
                "s",
                *_bounds(scale),
                "log",
                meaning="period of the undamped ringing",
                source=source,
            ),
            Parameter(
                "zeta",
                START_ZETA,
                "1",
                *ZETA,
                "log",
                meaning=f"damping ratio of the {what}",
                source=source,
            ),
        )
    )


def ringing_starts(scale: Scale) -> tuple[Mapping[str, float], ...]:
    """Lightly damped, from six samples to four times the motion's own time.

    A base that was fitted to a ringing response may well have less than half of its period.

    Parameters
    ----------
    scale
        Sizes of the logs.
    """
    return tuple({"period": t, "zeta": START_ZETA} for t in _periods(scale))


def rings(values: Mapping[str, float]) -> bool:
    """Whether a step overshoots so much that it is seen; so it is taken where no ζ is given.

    Parameters
    ----------
    values
        The period and the damping ratio.
    """
    return values.get("zeta", 0.0) < WELL_DAMPED


def time_constants(values: Mapping[str, float]) -> tuple[float, float] | None:
    """Both time constants of an overdamped law, (ζ ± √(ζ² − 1))/ω in s; None for any other.

    Parameters
    ----------
    values
        The period and the damping ratio.

    Examples
    --------
    >>> time_constants({"period": 6.283185307179586, "zeta": 1.25})
    (2.0, 0.5)
    """
    zeta = values["zeta"]
    if zeta <= 1.0:
        return None
    per_radian, root = values["period"] / (2.0 * math.pi), math.sqrt(zeta**2 - 1.0)
    return per_radian * (zeta + root), per_radian * (zeta - root)


def as_lag(values: Mapping[str, float]) -> Mapping[str, float] | None:
    """The lag with the longer time constant, which an overdamped law is like; None for any other.

    Parameters
    ----------
    values
        As in `time_constants`.
    """
    both = time_constants(values)
    return {"tau": both[0]} if both is not None else None


def shorter_time(values: Mapping[str, float]) -> float:
    """The shorter time constant of an overdamped law, in s; infinite for any other.

    Parameters
    ----------
    values
        As in `time_constants`.
    """
    both = time_constants(values)
    return both[1] if both is not None else math.inf


def _bounds(scale: Scale) -> tuple[float, float]:
    """Shortest and longest period, in seconds."""
    return time_bounds(scale, periods=SHORTEST_PERIODS, share=LONGEST_SHARE)


def _periods(scale: Scale) -> tuple[float, ...]:
    least, most = _bounds(scale)
    longest = 0.5 * most
    shortest = max(first_time(scale, longest, periods=START_PERIODS), least)
    slowest = last_time(SLOWEST * scale.motion_s, shortest, longest)
    return tuple(np.geomspace(shortest, slowest, 4).tolist())
