"""Relaxation: a reading that has risen returns by a share of the change."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import OutputEffect
from softid.effects.creep import settling, settling_starts, settling_time
from softid.effects.scale import Scale
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

SHARE = 0.1
"""Start of the share by which a reading returns."""

SHARES = (1e-4, 1.0)
"""Bounds of that share: less is lost in any noise, and a sensor whose charge leaks away, as that of
a piezoelectric one does, returns by all of it."""


@dataclass(frozen=True)
class Relaxation(OutputEffect):
    r"""Return by the same share of every change, y = x − c z with τ ż + z = x.

    The material of an actuator that is held in its place gives way inside, so that its force, or
    its torque, falls although the pressure stays. The stress of a solid of Maxwell's elements at a
    constant strain does so, by a share c in a time τ.

    Source: stress relaxation of a standard linear solid; Christensen, *Theory of Viscoelasticity*,
    §1.
    """

    name: ClassVar[str] = "relaxation"
    title: ClassVar[str] = "Relaxation of the reading"
    law: ClassVar[str] = "y = x - c z,  tau z' + z = x"
    meaning: ClassVar[str] = (
        "After a change the reading settles quickly and then returns for seconds or minutes, by a "
        "fraction of the change: the force of an actuator that is held relaxes, or a sensor, such "
        "as a piezoelectric one, loses what stands still."
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
    source: ClassVar[str] = "Christensen, Theory of Viscoelasticity, 1 (stress relaxation)"
    amplitude: ClassVar[str] = "c"
    before_sensor: ClassVar[bool] = True
    begins_with_log: ClassVar[bool] = True
    essential: ClassVar[tuple[str, ...]] = ("tau",)
    ceilings: ClassVar[tuple[str, ...]] = ("c",)

    def parameters(self, scale: Scale) -> ParameterSet:
        """Share c by which the reading returns, and the time τ in which it does."""
        share = Parameter(
            "c",
            SHARE,
            "1",
            *SHARES,
            "log",
            meaning="fraction of a change by which the reading returns",
            source=self.source,
        )
        return ParameterSet((share, settling_time(scale, "time constant of the return")))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Times from a thirtieth to a third of the log."""
        return settling_starts(self.parameters(scale), scale)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The reading without what has returned, settled at the first sample."""
        del scale
        relaxed: Array = y - float(eta[0]) * settling(time_s, y, float(eta[1]))
        return relaxed
