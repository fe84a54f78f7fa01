"""Hidden loads that move by themselves."""

from __future__ import annotations

from math import pi

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
    between,
    entry,
)


def _swinging(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    """A mass on a spring with a damper: what it pulls with is what speeds it up."""
    del sizes, occasion
    k, turn, zeta = values["k"], 2.0 * pi / values["period"], values["zeta"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        place, speed = z
        pull = (x - place) + 2.0 * zeta / turn * (v - speed)
        parts.force += k * pull
        return (speed, turn**2 * pull)

    return MotionLaw(act, lambda x: (x, 0.0))


LOADS: tuple[Hidden, ...] = (
    entry(
        "swinging_load", "state", "+ k (x - q) + 2 zeta k/w (v - q'),  q''/w^2 the same over k",
        "k {f}/{x}, period s, zeta 1",
        lambda s, rng, size: {
            "k": about(rng, 0.25 * size * s.stiffness),
            "period": between(rng, 8.0, 20.0) * s.motion_s,
            "zeta": between(rng, 0.02, 0.1),
        }, _swinging, relation="outside",
    ),
)  # fmt: skip
