"""Hidden effects of a sensor that reads more than the motion of the actuator."""

from __future__ import annotations

from cmath import exp
from math import pi, sqrt

import numpy as np
import numpy.typing as npt

from softid.synthesis.actuators import Sizes
from softid.synthesis.hidden_base import (
    Hidden,
    Occasion,
    OutputLaw,
    Values,
    about,
    either,
    entry,
)

Array = npt.NDArray[np.float64]


def _pickup(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    return OutputLaw(pickup=values["gain"])


def _swinging_tip(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    """The tip turns with what carries it, and swings about it as its base moves."""
    del sizes, occasion
    share, omega, zeta = values["share"], 2.0 * pi / values["period"], values["zeta"]
    pole = omega * complex(-zeta, sqrt(1.0 - zeta**2))

    def read(t: Array, y: Array) -> Array:
        """Behind a straight piece the swing is late by 2 zeta/omega, but for what rings out."""
        swing, speed, swung = float(y[0]), 0.0, [float(y[0])]
        for h, begin, end in zip(np.diff(t).tolist(), y.tolist(), y[1:].tolist(), strict=False):
            slope = (end - begin) / h
            behind = 2.0 * zeta / omega * slope
            off = swing - (begin - behind)
            turned = (off * pole.real - (speed - slope)) / pole.imag
            rings = complex(off, turned) * exp(pole * h)
            swing, speed = end - behind + rings.real, slope + (rings * pole).real
            swung.append(swing)
        return (1.0 - share) * y + share * np.array(swung)

    return OutputLaw(read)


SENSORS: tuple[Hidden, ...] = (
    entry(
        "pressure_pickup", "output", "recorded y = x + gain p", "gain {x}/kPa",
        lambda s, rng, size: {"gain": either(rng) * about(rng, 0.06 * size * s.x_span / s.p_span)},
        _pickup, relation="outside",
    ),
    entry(
        "swinging_tip", "output",
        "recorded y = (1 - share) x + share z, z''/w^2 + 2 zeta z'/w + z = x, w = 2 pi/period",
        "share 1, period s, zeta 1",
        lambda s, rng, size: {
            "share": about(rng, 0.3 * size), "period": rng.uniform(0.15, 0.5),
            "zeta": rng.uniform(0.03, 0.15),
        }, _swinging_tip, relation="outside",
    ),
)  # fmt: skip
