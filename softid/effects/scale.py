"""Sizes of a fitted motion, by which bounds and starts of effects go."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Scale:
    """Sizes that the bounds and starts of an effect's parameters go by.

    They are taken once from the fitted logs and the fitted base model, and are stored with an
    extended model, because knots and bounds follow from them.

    Attributes
    ----------
    u_low, u_high
        Range of the input.
    x_low, x_high
        Range of the position in the law of motion.
    v_max
        Largest speed that is reached for more than a moment.
    force
        Span of the elastic force over the range of positions.
    y_low, y_high
        Range of the first output as it is recorded, less the sensor zeros of the logs.
    period_s, duration_s
        Median sampling interval, and the length of the longest log.
    motion_s
        Typical time constant of the motion, its median damping over its median stiffness.
    travel
        ∫|v| dt over the longest log.
    a_turn
        Typical acceleration with which the motion turns round; 0 where that is unknown.
    u_unit, x_unit, force_unit, y_unit
        Units of input, position, force and first output.
    """

    u_low: float
    u_high: float
    x_low: float
    x_high: float
    v_max: float
    force: float
    y_low: float
    y_high: float
    period_s: float
    duration_s: float
    motion_s: float
    travel: float
    u_unit: str = "kPa"
    x_unit: str = "mm"
    force_unit: str = "1"
    y_unit: str = "mm"
    a_turn: float = 0.0

    @property
    def u_span(self) -> float:
        """Span of the input."""
        return self.u_high - self.u_low

    @property
    def x_span(self) -> float:
        """Span of the position."""
        return self.x_high - self.x_low

    @property
    def y_span(self) -> float:
        """Span of the first output."""
        return self.y_high - self.y_low

    @property
    def turning_rate(self) -> float:
        """How often in a second the speed may go from its largest to none, in 1/s."""
        return max(self.v_max / self.x_span, self.a_turn / self.v_max)
