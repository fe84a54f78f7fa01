"""A hidden law that is drawn at random, so that no diagnosis can have been made for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, exp, pi, tanh

import numpy as np

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

Generator = np.random.Generator

DRAWS = 2**31
"""So many laws there are."""

WIDTHS = (0.08, 0.4)
"""Ends of the share of its range within which a factor bends."""

TIMES_S = (0.1, 6.0)
"""Ends of the time with which a law follows, where it does not act at once."""

BENDS: tuple[Callable[[float], float], ...] = (
    tanh,
    lambda s: exp(-(s**2)),
    lambda s: cos(0.5 * pi * s),
    lambda s: max(s, 0.0) / (1.0 + abs(s)),
    lambda s: s / (1.0 + s**2),
)
"""Bounded functions of a distance in widths."""


@dataclass(frozen=True)
class Factor:
    """A bend of one variable of the motion.

    Attributes
    ----------
    variable
        0 for the position, 1 for the speed, 2 for the pressure.
    low, span
        Where the variable is zero, and its range.
    place, width
        Where the bend is, and how wide, as shares of the range.
    bend
        One of `BENDS`.
    """

    variable: int
    low: float
    span: float
    place: float
    width: float
    bend: Callable[[float], float]

    def __call__(self, now: tuple[float, float, float]) -> float:
        """The factor at a position, a speed and a pressure."""
        share = (now[self.variable] - self.low) / self.span
        return self.bend((share - self.place) / self.width)


def _factor(rng: Generator, variable: int, sizes: Sizes) -> Factor:
    low = (sizes.x_low, -sizes.v_max, sizes.p_low)[variable]
    span = (sizes.x_span, 2.0 * sizes.v_max, sizes.p_high - sizes.p_low)[variable]
    place, width = rng.uniform(0.2, 0.8), between(rng, *WIDTHS)
    return Factor(variable, low, span, place, width, BENDS[int(rng.integers(len(BENDS)))])


def _random_law(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del occasion
    rng = np.random.default_rng(int(values["draw"]))
    variables = rng.choice(3, size=2, replace=False).tolist()
    first, second = (_factor(rng, variable, sizes) for variable in variables)
    force, time_s = values["force"], between(rng, *TIMES_S)
    remembers = bool(rng.integers(2))

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        now = (x, v, p)
        product = first(now) * second(now)
        if not remembers:
            parts.force += force * product
            return NO_RATES
        parts.force += force * z[0]
        return ((product - z[0]) / time_s,)

    def start(x: float) -> Rates:
        rest = (x, 0.0, sizes.p_low)
        return (first(rest) * second(rest),) if remembers else NO_RATES

    return MotionLaw(act, start)


RANDOM: tuple[Hidden, ...] = (
    entry(
        "random_law",
        "state",
        "+ force a b, a and b bends of two of position, speed and pressure that the draw tells, "
        "half of them with a memory",
        "force {f}, draw 1",
        lambda s, rng, size: {
            "force": either(rng) * about(rng, 0.15 * size * s.force),
            "draw": float(rng.integers(DRAWS)),
        },
        _random_law,
        relation="outside",
    ),
)
