"""Relaxation: a reading that has risen returns by a share of the change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from softid.effects.shared_laws.settling import SettlingShare

SHARES = (1e-4, 1.0)
"""Bounds of the share by which a reading returns: less is lost in any noise, and a sensor whose
charge leaks away, as that of a piezoelectric one does, returns by all of it."""


@dataclass(frozen=True)
class Relaxation(SettlingShare):
    r"""Return by the same share of every change, y = x − c z with τ ż + z = x.

    The material of an actuator that is held in its place gives way inside, so that its force, or
    its torque, falls although the pressure stays. The stress of a solid of Maxwell's elements at a
    constant strain does so, by a share c in a time τ.

    Source: Christensen, *Theory of Viscoelasticity*, §1 (stress relaxation).
    """

    name: ClassVar[str] = "relaxation"
    title: ClassVar[str] = "Relaxation of the reading"
    law: ClassVar[str] = "recorded y = x - c z,  tau z' + z = x"
    meaning: ClassVar[str] = (
        "After a change the reading settles quickly and then returns, by a fraction of the "
        "change: the force of an actuator that is held relaxes, or a sensor, such as a "
        "piezoelectric one, loses what stands still."
    )
    signature: ClassVar[str] = (
        "After every change of level the residual approaches, exponentially, a fixed fraction of "
        "the change, against it, with one time constant at every level and in both directions."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("sensor_warmup", "sensor_drift", "softening")
    remedy: ClassVar[str] = (
        "use a less viscoelastic elastomer, or a sensor that holds a constant reading"
    )
    shown_by: ClassVar[str] = "a hold of 20 s followed by a rest of 20 s, at two levels"
    source: ClassVar[str] = "Christensen, Theory of Viscoelasticity, §1 (stress relaxation)"
    shares: ClassVar[tuple[float, float]] = SHARES
    meanings: ClassVar[tuple[str, str]] = (
        "fraction of a change by which the reading returns",
        "time constant of the return",
    )
    direction: ClassVar[float] = -1.0
