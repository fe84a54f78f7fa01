"""Hidden springs beside the actuator's own: what pulls with the position alone, in any shape."""

from __future__ import annotations

from math import pi, sin, tanh

from softid.synthesis.actuators import Sizes
from softid.synthesis.hidden_base import (
    NO_RATES,
    Hidden,
    MotionLaw,
    Occasion,
    Parts,
    Rates,
    States,
    Values,
    about,
    between,
    either,
    entry,
)


def _saturating(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    force, reach = values["force"], values["reach"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.force += force * tanh(x / reach)
        return NO_RATES

    return MotionLaw(act)


def _wavy(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del occasion
    force, low, turn = values["force"], sizes.x_low, 2.0 * pi / values["period"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.force += force * sin(turn * (x - low))
        return NO_RATES

    return MotionLaw(act)


SPRINGS: tuple[Hidden, ...] = (
    entry(
        "saturating_spring", "state", "+ force tanh(x/reach)", "force {f}, reach {x}",
        lambda s, rng, size: {
            "force": about(rng, 0.6 * size * s.force), "reach": between(rng, 0.1, 0.3) * s.x_span,
        }, _saturating, relation="other_form", names=("stiffening", "static_curve"),
    ),
    entry(
        "wavy_spring", "state", "+ force sin(2 pi (x - x_low)/period)", "force {f}, period {x}",
        lambda s, rng, size: {
            "force": either(rng) * about(rng, 0.08 * size * s.force),
            "period": rng.uniform(0.25, 0.6) * s.x_span,
        }, _wavy, relation="other_form", names=("static_curve",),
    ),
)  # fmt: skip
