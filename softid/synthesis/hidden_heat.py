"""A hidden effect of an actuator that its own moves warm up, and that cools down at rest."""

from __future__ import annotations

from softid.synthesis.actuators import Sizes
from softid.synthesis.hidden_base import (
    Hidden,
    MotionLaw,
    Occasion,
    Parts,
    Rates,
    States,
    Values,
    about,
    entry,
)

LARGEST_LOSS = 0.8
"""Share of the stiffness that goes at most."""


def _self_heating(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    loss, speed, time_s = values["loss"], values["speed"], values["time"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.spring *= 1.0 - min(loss * z[0], LARGEST_LOSS)
        return ((abs(v) / speed - z[0]) / time_s,)

    return MotionLaw(act, lambda x: (0.0,))


HEAT: tuple[Hidden, ...] = (
    entry(
        "self_heating", "state", "Q (1 - loss z) in place of Q, time z' = |v|/speed - z",
        "loss 1, speed {x}/s, time s",
        lambda s, rng, size: {
            "loss": about(rng, 0.2 * size), "speed": s.travel / s.duration_s,
            "time": rng.uniform(0.1, 0.3) * s.duration_s,
        }, _self_heating, relation="outside",
    ),
)  # fmt: skip
