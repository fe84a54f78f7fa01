"""Causes that take the place of the actuator's own motion, of which nothing is left.

In a chain of linear parts nothing tells which of them is the actuator. A resonance of the line that
swings as the actuator did, or a lag that is as slow as an actuator that did not swing, before an
actuator that follows at once, is the actuator's own: it says that the other causes act behind the
motion, not within or before it. So a curve that is bent behind it may as well be the sensor's.
"""

from __future__ import annotations

from collections.abc import Container
from itertools import dropwhile
from typing import NamedTuple

import numpy as np

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.usual_law import usual_law
from softid.effects import own_values
from softid.effects.base import Effect, InputEffect, StateEffect

GONE = 0.1
"""Nothing is left of a motion whose times are less than this share of what they were, and than the
shortest sampling interval: any log would show a slower one."""

TIME_TOLERANCE = 0.1
"""A cause has the times of the motion where neither differs by more than this share of the
longer."""

LAG_CAUSES = ("pneumatic_lag", "sensor_lag")
"""Causes that are a motion of first order."""

CURVES = ("dead_zone", "static_curve", "stiffening", "contact")
"""Causes that bend the curve of rests, which a sensor does as well."""


class Times(NamedTuple):
    """How late a motion of second order is, and the time of its swing over 2π: N/K and √(M/K)."""

    late_s: float
    swing_s: float


def displacing(final: Candidate, base: Candidate) -> frozenset[str]:
    """Keys of the effects of a chain that have the times of the base, of which none are left.

    Parameters
    ----------
    final
        The model with all causes.
    base
        That without any.
    """
    before, after = _times(base), _times(final)
    if before is None or after is None:
        return frozenset()
    period_s = min(log.period_s for log in final.problem.logs)
    if max(after) > min(GONE * max(before), period_s):
        return frozenset()
    return frozenset(e.key for e in final.effects if _is_like(_times_of(final, e), before))


def behind(final: Candidate, displaced_by: Container[str]) -> frozenset[str]:
    """Keys of the effects of a chain that bend a curve behind what took the motion's place.

    Parameters
    ----------
    final
        The model with all causes.
    displaced_by
        As `displacing` found.
    """
    on_input = [effect for effect in final.acting if isinstance(effect, InputEffect)]
    in_motion = [effect for effect in final.acting if isinstance(effect, StateEffect)]
    later = dropwhile(lambda effect: effect.key not in displaced_by, [*on_input, *in_motion])
    return frozenset(effect.key for effect in later if effect.name in CURVES)


def _times(candidate: Candidate) -> Times | None:
    """Those of the motion at the usual input; None where nothing pulls it back."""
    law = usual_law(candidate)
    if law is None or law.stiffness <= 0.0:
        return None
    return Times(law.damping_s, law.swing_s)


def _times_of(final: Candidate, effect: Effect) -> Times | None:
    """Those of a resonance or a lag."""
    values = own_values(effect, final.parameters)
    if effect.name in LAG_CAUSES:
        return Times(values["tau"], 0.0)
    if "zeta" not in values:
        return None
    swing_s = values["period"] / (2.0 * np.pi)
    return Times(2.0 * values["zeta"] * swing_s, swing_s)


def _is_like(one: Times | None, other: Times) -> bool:
    """Whether times are alike; a lag is like a motion whose second pole is a tenth as slow."""
    if one is None:
        return False
    if one.swing_s == 0.0 and other.swing_s**2 <= GONE * other.late_s**2:
        other = other._replace(swing_s=0.0)
    most = TIME_TOLERANCE * max(other)
    return all(abs(a - b) <= most for a, b in zip(one, other, strict=True))
