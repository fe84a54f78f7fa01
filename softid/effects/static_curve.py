"""Static curve: the settled positions do not lie on the curve that the model can draw."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import StateEffect
from softid.effects.scale import Scale
from softid.kernels.terms import SHIFT
from softid.parameters import Parameter, ParameterSet

KNOTS = 6
"""Enough for a bow, an S and a W, and few enough that held levels determine each value."""

LAST = KNOTS - 1
NAMES = tuple(f"k{i + 1}" for i in range(1, KNOTS))
"""Names of the values at the knots behind the first."""

SHARE = 0.05
"""Size of the starts, as a share of the range of positions."""

LEVELLING = 0.5
"""Distance, in knots, over which the curve levels off outside the range of the knots."""

BENDING = (
    (56.0 / 209.0, -15.0 / 209.0, 4.0 / 209.0, -1.0 / 209.0),
    (-15.0 / 209.0, 60.0 / 209.0, -16.0 / 209.0, 4.0 / 209.0),
    (4.0 / 209.0, -16.0 / 209.0, 60.0 / 209.0, -15.0 / 209.0),
    (-1.0 / 209.0, 4.0 / 209.0, -15.0 / 209.0, 56.0 / 209.0),
)
"""Inverse of the tridiagonal matrix (1, 4, 1): a natural spline's second derivatives at the inner
knots are six times this matrix times the second differences of its values."""

SHAPES = (
    (1.0, -0.2, -0.8, -0.8, -0.2, 1.0),
    (-5.0 / 7.0, 1.0, 4.0 / 7.0, -4.0 / 7.0, -1.0, 5.0 / 7.0),
    (1.0 / 3.0, -1.0, 2.0 / 3.0, 2.0 / 3.0, -1.0, 1.0 / 3.0),
)
"""The orthogonal polynomials of degree 2, 3 and 4 on six places: what a straight line leaves."""


@dataclass(frozen=True)
class StaticCurve(StateEffect):
    r"""Shift of the spring's rest by a natural cubic spline in the input, q(x − s(u)).

    At rest the position is that of the model plus s(u). The spline goes through six equally spaced
    knots over the range of the input, and levels off outside it. It is zero at the first one: a
    level of the whole curve is that of the sensor's zero, which no log can tell from it.

    Source: de Boor, *A Practical Guide to Splines*, ch. IV (natural cubic spline).
    """

    name: ClassVar[str] = "static_curve"
    title: ClassVar[str] = "Correction of the static curve"
    law: ClassVar[str] = (
        "x - s(u) in place of x in the spring; s a natural cubic spline through 6 knots over the "
        "range of the fitted input, level beyond it; at the first knot 0, at the others k2 … k6"
    )
    meaning: ClassVar[str] = (
        "The settled positions follow a curve whose shape the model cannot reproduce."
    )
    signature: ClassVar[str] = (
        "The residual at rest depends only on the level: it is the same on the way up and on the "
        "way down, and stays as long as the level is held."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("stiffening", "contact", "dead_zone")
    draws: ClassVar[tuple[str, ...]] = ("stiffening",)
    remedy: ClassVar[str] = "none is needed: use the measured curve for control"
    shown_by: ClassVar[str] = "held levels over the full range, up and down"
    source: ClassVar[str] = "de Boor, A Practical Guide to Splines, ch. IV"
    amplitude: ClassVar[str] = "k2"
    changes_sign: ClassVar[bool] = True

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """All values at the knots: the effect is linear in them."""
        return NAMES

    def parameters(self, scale: Scale) -> ParameterSet:
        """Shifts k2 to k6 at the knots, at most the range of positions either way."""
        largest, spacing = scale.x_span, scale.u_span / LAST
        return ParameterSet(
            tuple(
                Parameter(
                    name,
                    SHARE * scale.x_span * (SHAPES[0][i] - SHAPES[0][0]),
                    scale.x_unit,
                    -largest,
                    largest,
                    meaning=f"shift at {scale.u_low + i * spacing:.3g} {scale.u_unit}, "
                    f"that at {scale.u_low:.3g} {scale.u_unit} being 0",
                    source=self.source,
                )
                for i, name in enumerate(NAMES, start=1)
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """A bow, an S and a W."""
        size = SHARE * scale.x_span
        return tuple(
            {name: size * (value - shape[0]) for name, value in zip(NAMES, shape[1:], strict=True)}
            for shape in SHAPES
        )

    def law_at(self, scale: Scale) -> str:
        """With the places of the knots."""
        places = f"evenly from {scale.u_low:.5g} to {scale.u_high:.5g} {scale.u_unit}"
        return self.law.replace("6 knots", f"6 knots {places}")

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """Place of the first knot, and knots per unit of the input."""
        return (scale.u_low, LAST / scale.u_span)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Shift s(u); beyond the ends, where the spline is straight, tanh brings it to a level."""
        place = (u - eta[LAST]) * eta[LAST + 1]
        inside = min(max(place, 0.0), float(LAST))
        left = min(int(inside), LAST - 1)
        bend_left, bend_right = 0.0, 0.0
        for j in range(LAST - 1):
            before = eta[j - 1] if j > 0 else 0.0
            bent = 6.0 * (before - 2.0 * eta[j] + eta[j + 1])
            if left > 0:
                bend_left += BENDING[left - 1][j] * bent
            if left < LAST - 1:
                bend_right += BENDING[left][j] * bent
        b = inside - left
        a = 1.0 - b
        lower, upper = eta[left - 1] if left > 0 else 0.0, eta[left]
        shift = a * lower + b * upper
        shift += ((a * a * a - a) * bend_left + (b * b * b - b) * bend_right) / 6.0
        if place != inside:
            slope = upper - lower
            slope += ((3.0 * b * b - 1.0) * bend_right - (3.0 * a * a - 1.0) * bend_left) / 6.0
            shift += slope * LEVELLING * math.tanh((place - inside) / LEVELLING)
        out[SHIFT] += shift
