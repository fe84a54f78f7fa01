"""The bending pneumatic muscle of Ru et al.: a mass, damper and spring that depend on pressure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

import numpy as np
import numpy.typing as npt

from softid.errors import UsageError
from softid.kernels.muscle import KPA_PER_BAR
from softid.models.base import Model, Response
from softid.models.division import Division, divide_segment
from softid.models.geometry import ArcGeometry
from softid.models.muscle_law import NAMES, MuscleLaw
from softid.models.option_kinds import require_choice
from softid.models.products import Keep, Products
from softid.models.ringing import ringing_starts
from softid.models.second_order import ORDERS, Order, simulate_law
from softid.models.starts import as_values, damping_shapes, hammerstein_starts
from softid.models.summed_products import sum_law
from softid.models.time_scales import Speeds, order_seen, speeds_of
from softid.parameters import Parameter, ParameterSet
from softid.segment import Segment

Array = npt.NDArray[np.float64]

_RU = "Ru et al. 2019"

_LENGTHS = "--fixed-length and --diameter (fixed_length_mm= and diameter_mm= in Python)"

GROWING = 0.1
"""Share that grows with the pressure of a damping that comes back: small, but enough to fit."""


@dataclass(frozen=True)
class Muscle(Model):
    """M·ẍ + N(p)·ẋ + Q(p)·x = P(p) with P = exp(b1·p), Q = a1·P + c1, N = a2·exp(b2·p) + c2.

    x is the recorded angle, contraction or position; with the arc geometry, the contraction L0 − L.
    p is the pressure in bar. P has no factor of its own, which fixes the scale: M, N and Q are not
    in SI units. At rest x∞(p) = 1/(a1 + c1·exp(−b1·p)), a sigmoid that does not pass through zero
    at p = 0.

    Attributes
    ----------
    damping
        ``"exponential"``, or ``"constant"`` for N = c2.
    order
        ``"second"``; ``"first"`` drops M, ``"static"`` drops N too.
    fixed_length_mm, diameter_mm
        L0 and d of the arc geometry; without them x is whatever the output records, so an angle
        makes x an angle.
    x_unit
        Unit of x: ``"mm"``, or ``"rad"`` for an angle without geometry.
    inverted
        Whether the recorded output goes against x: an angle that falls as the pressure rises, or a
        length that grows, L = L0 + x, as that of a bellows or an extending muscle.

    Raises
    ------
    UsageError
        An option is none of its choices, or one of the two lengths is missing.

    Source: Ru et al. 2019, Eq 3 to 7; geometry Eq 1 and 2.
    """

    damping: Literal["exponential", "constant"] = "exponential"
    order: Order = "second"
    fixed_length_mm: float | None = None
    diameter_mm: float | None = None
    x_unit: str = "mm"
    inverted: bool = False

    name: ClassVar[str] = "muscle"
    title: ClassVar[str] = "Bending pneumatic muscle with pressure-dependent coefficients"
    equation: ClassVar[str] = (
        "M x'' + (a2 exp(b2 p) + c2) x' + (a1 exp(b1 p) + c1) x = exp(b1 p),  p in bar"
    )
    source: ClassVar[str] = "Ru et al. 2019, doi 10.1007/s11432-018-9709-x, Eq 4 to 7"
    note: ClassVar[str] = (
        "M, a1, c1, a2 and c2 are relative to the right-hand side exp(b1 p), which has no factor, "
        "so they are not in SI units"
    )
    states: ClassVar[tuple[str, ...]] = ("x", "v")
    inputs: ClassVar[tuple[str, ...]] = ("pressure", "pressure_command")
    outputs: ClassVar[tuple[str, ...]] = ("angle", "contraction", "length", "distance", "position")
    inertia_parameter: ClassVar[str | None] = "M"
    damping_parameters: ClassVar[tuple[str, ...]] = ("a2", "c2")
    identified_by: ClassVar[Mapping[str, str]] = {
        "M": "fast steps or a chirp past the natural frequency, sampled well above it",
        "a1": "settled levels close to the highest pressure, where the curve saturates",
        "b1": "settled levels across the steep middle of the curve",
        "c1": "settled levels at low pressure",
        "a2": "steps up and down, or a sine, that reach high pressures",
        "b2": "transients at three or more pressures spread over the range",
        "c2": "any transient that is slow enough to be sampled",
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        require_choice("damping", self.damping, ("exponential", "constant"))
        require_choice("order", self.order, ORDERS)
        if (self.fixed_length_mm is None) != (self.diameter_mm is None):
            raise UsageError(
                "the arc geometry needs both lengths",
                value=(self.fixed_length_mm, self.diameter_mm),
                remedy=f"give {_LENGTHS}, or neither",
            )
        _ = self.geometry

    @property
    def geometry(self) -> ArcGeometry | None:
        """The arc geometry, or None when it was not given."""
        if self.fixed_length_mm is None or self.diameter_mm is None:
            return None
        return ArcGeometry(self.fixed_length_mm, self.diameter_mm)

    def adapted(self, units: Mapping[str, str], *, inverted: bool = False) -> Muscle:
        """The model with x in the unit that the outputs call for.

        Raises
        ------
        UsageError
            The outputs are not linked without the arc geometry.
        """
        wanted = [name for name in units if name != "input"]
        if self.geometry is None:
            if "distance" in wanted:
                raise UsageError(
                    "a distance is linked to the contraction by the arc geometry",
                    remedy=f"give {_LENGTHS} in mm",
                )
            if "angle" in wanted and len(wanted) > 1:
                raise UsageError(
                    "angle and length outputs are linked by the arc geometry",
                    remedy=f"give {_LENGTHS} in mm, or fit one output",
                )
        angle_is_x = self.geometry is None and wanted == ["angle"]
        against = {"length": not inverted, "distance": False}.get(wanted[0], inverted)
        return replace(self, x_unit="rad" if angle_is_x else "mm", inverted=against)

    @property
    def start_states(self) -> tuple[str, ...]:
        """Both states, or fewer in the first-order and static limits."""
        return self.states[: ORDERS.index(self.order)]

    def parameters(self) -> ParameterSet:
        """The seven parameters; those that the options drop are fixed at zero."""
        x = self.x_unit
        declared = (
            _positive("M", 1e-3, f"s²/{x}", "inertia", "Eq 4"),
            _positive("a1", 1e-2, f"1/{x}", "inverse of the largest x", "Eq 5"),
            _positive("b1", 2.0, "1/bar", "steepness of the static curve", "Eq 5", 1e-3, 300.0),
            _positive("c1", 1.0, f"1/{x}", "pressure-independent part of the stiffness", "Eq 5"),
            _positive("a2", 1e-4, f"s/{x}", "damping that changes with pressure", "Eq 6"),
            Parameter(
                "b2",
                0.0,
                "1/bar",
                -300.0,
                300.0,
                meaning="how fast damping changes with pressure",
                source=f"{_RU}, Eq 6",
            ),
            _positive("c2", 1e-1, f"s/{x}", "pressure-independent part of the damping", "Eq 6"),
        )
        dropped: set[str] = set()
        if self.order != "second":
            dropped.add("M")
        if self.order == "static":
            dropped |= {"a2", "b2", "c2"}
        if self.damping == "constant":
            dropped |= {"a2", "b2"}
        return ParameterSet(declared).with_fixed(dict.fromkeys(dropped, 0.0))

    def guess(self, segments: Sequence[Segment], output: str) -> tuple[ParameterSet, ...]:
        """Starts by a search over steepness, midpoint and speed, with the gain solved linearly."""
        motions = self._motions(segments, output)
        starts = hammerstein_starts(
            segments, motions, output, MuscleLaw, static=self.order == "static"
        )
        return self._usable(starts)

    def ringing(self, segments: Sequence[Segment], output: str) -> tuple[ParameterSet, ...]:
        """Starts by weak-form regression where it finds a damping ratio below one."""
        if self.order != "second":
            return ()
        motions = self._motions(segments, output)
        return self._usable(ringing_starts(segments, motions, output, MuscleLaw))

    def hidden_terms(self, damping: float, hidden_s: float) -> Mapping[str, float]:
        """Inertia, and a damping of which a tenth grows with the pressure."""
        return {"M": hidden_s * damping, "c2": damping, "a2": GROWING * damping}

    def plainer(self) -> Muscle | None:
        """The same with a damping that does not change with the pressure."""
        if self.order == "static" or self.damping == "constant":
            return None
        return replace(self, damping="constant")

    def alternatives(self, values: Mapping[str, float]) -> tuple[ParameterSet, ...]:
        """The same static curve with damping that grows or falls with the pressure."""
        if self.order == "static" or self.damping == "constant":
            return ()
        b1, b2 = values["b1"], values["b2"]
        mass, c1, a2, c2 = (values[name] / values["a1"] for name in ("M", "c1", "a2", "c2"))
        with np.errstate(over="ignore"):
            damping = a2 * float(np.exp(b2 * np.log(c1) / b1)) + c2
        if not np.isfinite(damping) or damping <= 0.0:
            return ()
        shapes = damping_shapes(np.array([mass, 1.0, b1, c1, 0.0, 0.0, damping]))
        starts = [as_values(shape, 1.0 / values["a1"]) for shape in shapes]
        return self._usable([s for s in starts if np.isfinite(list(s.values())).all()])

    def _motions(self, segments: Sequence[Segment], output: str) -> list[Array]:
        """Measured x up to a zero."""
        geometry = self.geometry
        sign = -1.0 if self.inverted != (output == "length") else 1.0
        motions = []
        for segment in segments:
            y = segment.outputs[output]
            if geometry is not None and output == "distance":
                y = geometry.contraction_from_distance_mm(y)
            elif geometry is not None and output == "angle":
                y = y * geometry.diameter_mm
            motions.append(sign * y)
        return motions

    def _usable(self, starts: Sequence[Mapping[str, float]]) -> tuple[ParameterSet, ...]:
        declared = self.parameters()
        free = declared.free
        return tuple(declared.with_values({name: start[name] for name in free}) for start in starts)

    def response(
        self,
        theta: Array,
        segment: Segment,
        outputs: Sequence[str],
        *,
        start: Array | None,
        derivatives: bool,
        relative: bool = False,
        plan: Division | None = None,
    ) -> Response:
        """Simulate one segment; see `Model.response`."""
        law = MuscleLaw(theta)
        motion = simulate_law(
            law,
            segment.time_s,
            segment.input,
            start,
            derivatives=derivatives,
            relative=relative,
            plan=self.plan(theta, segment) if plan is None else plan,
        )
        values: dict[str, Array] = {}
        by_parameter: dict[str, Array] = {}
        by_state: dict[str, Array] = {}
        for name in outputs:
            line = self._line(name)
            if line is not None and not derivatives:
                values[name] = _on(line, motion.x)
                continue
            values[name], slope = self.observed(motion.x, name)
            if motion.by_parameter is not None and motion.by_state is not None:
                by_parameter[name] = motion.by_parameter * slope[:, None]
                by_state[name] = (motion.by_state * slope[:, None])[:, : len(self.start_states)]
        return Response(
            values,
            by_parameter if derivatives else None,
            by_state if derivatives else None,
            np.array([motion.x[0], motion.v[0]]),
            motion.x,
            motion.v,
        )

    def motion_law(self, theta: Array) -> MuscleLaw:
        """Ru's coefficients at these parameters."""
        return MuscleLaw(theta)

    def products(
        self,
        theta: Array,
        segment: Segment,
        channel: str,
        *,
        start: Array | None,
        relative: bool,
        plan: Division | None,
        zero: float,
        keep: Keep,
    ) -> Products | None:
        """Summed unless the output is a distance, nonlinear in x; see `Model.products`."""
        line = self._line(channel)
        if line is None:
            return None
        level, gain = line
        return sum_law(
            MuscleLaw(theta),
            segment,
            channel,
            start,
            relative=relative,
            plan=self.plan(theta, segment) if plan is None else plan,
            gain=gain,
            level=level + zero,
            keep=keep,
        )

    def observed(self, x: Array, output: str) -> tuple[Array, Array]:
        """Output and its slope dy/dx; Ru Eq 1 to 3."""
        line = self._line(output)
        if line is not None:
            return _on(line, x), np.full(x.size, line[1])
        geometry = self.geometry
        assert geometry is not None
        return geometry.distance_mm(x), geometry.distance_slope(x)

    def _line(self, output: str) -> tuple[float, float] | None:
        """Level and gain of the output, level + gain·x; None for a distance, which is no line."""
        geometry = self.geometry
        sign = -1.0 if self.inverted else 1.0
        if output == "distance" and geometry is not None:
            return None
        if output == "length":
            return (geometry.fixed_length_mm if geometry is not None else 0.0), -sign
        bends = geometry is not None and output == "angle"
        return 0.0, sign / geometry.diameter_mm if geometry is not None and bends else sign

    def plan(self, theta: Array, segment: Segment) -> Division:
        """Division of the sampling intervals; see `Model.plan`."""
        return divide_segment(MuscleLaw(theta), theta, segment)

    def static_output(self, theta: Array, input_values: Array, output: str) -> Array:
        """The sigmoid x∞(p) = 1/(a1 + c1·exp(−b1·p)) as the output records it."""
        _, stiffness, force = MuscleLaw(theta).coefficients(input_values)
        return self.observed(force / stiffness, output)[0]

    def damping_curve(self, theta: Array, pressure_kpa: Array) -> Array:
        """N(p) at pressures of shape (m,), in s per unit of x; Ru Eq 6."""
        return MuscleLaw(theta).coefficients(pressure_kpa)[0]

    def derived(
        self, values: Mapping[str, float], input_range: tuple[float, float]
    ) -> dict[str, tuple[float, str]]:
        """Shape of the static curve, and the motion's speed at the centre of the fitted range."""
        a1, b1, c1 = values["a1"], values["b1"], values["c1"]
        found = {
            "x_max": (1.0 / a1, self.x_unit),
            "x_at_zero_pressure": (1.0 / (a1 + c1), self.x_unit),
            "midpoint_pressure": (float(np.log(c1 / a1) / b1) * KPA_PER_BAR, "kPa"),
        }
        centre_kpa = 0.5 * (input_range[0] + input_range[1])
        return found | self.speeds(values, centre_kpa).named(f"_at_{centre_kpa:.0f}_kPa")

    def speeds(self, values: Mapping[str, float], u: float) -> Speeds:
        """Time constant, natural frequency and damping ratio at a pressure."""
        return speeds_of(MuscleLaw(np.array([values[name] for name in NAMES])), u)

    def limit(
        self, theta: Array, period_s: float, input_range: tuple[float, float], longest_s: float
    ) -> tuple[Muscle, str] | None:
        """The lower order where the inertia, or all of the motion, is too fast for the samples."""
        del longest_s
        inputs = np.linspace(*input_range, 20)
        found = order_seen(MuscleLaw(theta), self.order, period_s, inputs)
        return (replace(self, order=found[0]), found[1]) if found else None


def _on(line: tuple[float, float], x: Array) -> Array:
    level, gain = line
    return level + gain * x if level else gain * x


def _positive(
    name: str,
    value: float,
    unit: str,
    meaning: str,
    equation: str,
    lower: float = 1e-15,
    upper: float = 1e15,
) -> Parameter:
    return Parameter(
        name, value, unit, lower, upper, "log", meaning=meaning, source=f"{_RU}, {equation}"
    )
