"""Causes that take the place of the actuator's own motion, of which nothing is left.

In a chain of linear parts nothing tells which of them is the actuator. A resonance of the line that
swings as the actuator did, before an actuator that follows at once, is the actuator's own: it says
that the other causes act behind the motion, not within or before it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.usual_law import usual_law
from softid.effects import own_values
from softid.effects.base import Effect

GONE = 0.1
"""Nothing is left of a motion whose times are less than this share of what they were, and than a
sampling interval."""

ALIKE = 0.1
"""A cause has the times of the motion where neither differs by more than this share of the
longer."""


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
    period_s = final.problem.logs[0].period_s
    if max(after) > min(GONE * max(before), period_s):
        return frozenset()
    return frozenset(e.key for e in final.effects if _is_like(_times_of(final, e), before))


def _times(candidate: Candidate) -> Times | None:
    """Those of the motion at the usual input; None where nothing pulls it back."""
    law = usual_law(candidate)
    if law is None or law.stiffness <= 0.0:
        return None
    return Times(law.damping_s, law.swing_s)


def _times_of(final: Candidate, effect: Effect) -> Times | None:
    """Those of a resonance."""
    values = own_values(effect, final.parameters)
    if "zeta" not in values:
        return None
    swing_s = values["period"] / (2.0 * np.pi)
    return Times(2.0 * values["zeta"] * swing_s, swing_s)


def _is_like(one: Times | None, other: Times) -> bool:
    if one is None:
        return False
    most = ALIKE * max(other)
    return all(abs(a - b) <= most for a, b in zip(one, other, strict=True))
