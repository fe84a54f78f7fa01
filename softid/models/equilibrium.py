"""The bi-directional actuator of DEE 2022: dynamic equilibrium with a compensated mass."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import ClassVar, Literal

import numpy as np
import numpy.typing as npt

from softid.errors import Issue, UsageError
from softid.kernels.bending import (
    N_DYNAMIC,
    fastest_rates,
    propagate_bending,
    propagate_bending_with_sensitivities,
    rest_angle,
    rest_slopes,
    torque_parts,
)
from softid.kernels.bending_body import LARGEST_ANGLE_RAD, MOST_STRETCH, Body
from softid.models.actuator_geometry import Actuator
from softid.models.base import Model, MotionTerm, Response
from softid.models.bending_inertia import INERTIAS, KERNELS, Inertia, Kernels
from softid.models.division import Division, held
from softid.models.equilibrium_cautions import cautions_of
from softid.models.equilibrium_starts import equilibrium_starts
from softid.models.option_kinds import require_choice
from softid.models.time_scales import Speeds
from softid.parameters import Parameter, ParameterSet
from softid.segment import Segment

Array = npt.NDArray[np.float64]

NAMES = ("C_d", "a", "b", "c", "stiffness", "drive", "rest_torque", "drift")
STAGES: Array = np.array([0.0, 0.5, 1.0])
"""Where the Runge–Kutta rule needs the pressure within a step."""

MAX_PHASE_PER_STEP = 0.2
MAX_FADING_PER_STEP = 1.5
"""Largest product of step and natural frequency, and of step and damping rate: the error stays
below 1e-4 of the motion, and the rule is stable up to 2.8."""

MAX_SUBSTEPS = 16
"""Most steps in a sampling interval. A swing at half the sampling rate, the fastest that samples
can show, takes π/0.2 steps. A motion that is stiffer than that ends in NaN, which a fit rejects."""

OVERSHOOT = 2.0
N_ANGLES = 9
"""Angles at which the fastest motion is looked for, up to so many times the largest rest: a swing
without damping goes as far beyond its rest as it came from before it."""

_DEE = "DEE 2022"


@dataclass(frozen=True)
class Equilibrium(Actuator, Model):
    """C_m(θ)·[M(θ)·θ̈ + D(θ)·θ̇²] + C_d·θ̇ + s·K(θ) + τ0 = d·F(p), C_m = a·θ² + b·|θ| + c.

    M, D, K and F follow from geometry and material, which are fields of the model (see `Actuator`),
    so that its options alone are enough to simulate. A negative pressure drives the other chamber
    bank. Multiplying C_d, a, b, c, s and d by one number changes nothing, so d is held at 1.

    Attributes
    ----------
    inertia
        ``"root-moment"``, the paper's balance at the root, or ``"lagrangian"``, the kinetic energy.
    kernels
        ``"exact"``, or ``"taylor"`` for the paper's expansion cut term by term.
    compensation
        ``"quadratic"``; ``"constant"`` holds a = b = 0, ``"none"`` holds c = 1 as well.
    drift
        ``"linear"`` adds a constant drift rate of the sensor, ``"none"`` does not.
    driving
        ``"geometry"`` holds d at 1; ``"free"`` lets it go, and only ratios are known then.
    inverted
        Whether the recorded angle falls as the pressure rises.

    Raises
    ------
    UsageError
        An option is none of its choices, or the Taylor kernels are asked of the Lagrangian inertia.
    InputError
        A dimension or a material value is none that an actuator can have.

    Source: DEE 2022, Eq 13 and 14.
    """

    inertia: Inertia = "root-moment"
    kernels: Kernels = "exact"
    compensation: Literal["quadratic", "constant", "none"] = "quadratic"
    drift: Literal["none", "linear"] = "none"
    driving: Literal["geometry", "free"] = "geometry"
    inverted: bool = False

    name: ClassVar[str] = "equilibrium"
    title: ClassVar[str] = "Bi-directional bending actuator in dynamic equilibrium"
    equation: ClassVar[str] = (
        "(a θ² + b |θ| + c) (M(θ) θ'' + D(θ) θ'²) + C_d θ' + stiffness K(θ) + rest_torque "
        "= drive F(p),  recorded θ + drift t"
    )
    source: ClassVar[str] = (
        "A Dynamic Modeling Method for the Bi-Directional Pneumatic Actuator Using Dynamic "
        "Equilibrium Equation, Actuators 2022, Eq 9 to 14, corrected; wall stresses and default "
        "dimensions are assumptions of softid"
    )
    note: ClassVar[str] = (
        "M(θ) is the inertia of the bent actuator about its root, and D(θ) the part of it that the "
        "square of the speed meets (option inertia); K(θ) is the torque of the stretched walls and "
        "of the layer between the chambers, F(p) that of the pressure on the ends of the chambers. "
        "All four follow from the dimensions and the material below, and the parameters only scale "
        "them"
    )
    states: ClassVar[tuple[str, ...]] = ("x", "v")
    inputs: ClassVar[tuple[str, ...]] = ("pressure", "pressure_command")
    outputs: ClassVar[tuple[str, ...]] = ("angle",)
    force_unit: ClassVar[str] = "N·m"
    identified_by: ClassVar[Mapping[str, str]] = {
        "C_d": "a step after which the angle swings, sampled well above that swing",
        "a": "steps of two levels or more, and of both signs: the swing must reach large angles",
        "b": "steps of two levels or more, so that the swing is seen at small and large angles",
        "c": "a step of a small level; its absolute value needs the actuator's weight",
        "stiffness": "a settled level with a known torque of the pressure",
        "drive": "nothing: only its ratio to the other torques shows",
        "rest_torque": "settled levels of both signs, and a known sensor zero",
        "drift": "a long rest after the step",
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        require_choice("inertia", self.inertia, INERTIAS)
        require_choice("kernels", self.kernels, KERNELS)
        require_choice("compensation", self.compensation, ("quadratic", "constant", "none"))
        require_choice("drift", self.drift, ("none", "linear"))
        require_choice("driving", self.driving, ("geometry", "free"))
        if self.kernels == "taylor" and self.inertia == "lagrangian":
            raise UsageError(
                "the paper's Taylor form exists for the root moment only",
                where="option kernels",
                value=self.kernels,
                remedy="choose kernels=exact, or inertia=root-moment",
            )

    @classmethod
    def of(
        cls,
        actuator: Actuator,
        *,
        inertia: Inertia = "root-moment",
        compensation: Literal["quadratic", "constant", "none"] = "quadratic",
        drift: Literal["none", "linear"] = "none",
    ) -> Equilibrium:
        """The model of an actuator, as from `load_actuator`."""
        values = {f.name: getattr(actuator, f.name) for f in fields(Actuator)}
        return cls(**values, inertia=inertia, compensation=compensation, drift=drift)

    def variants(self, input_name: str) -> tuple[Equilibrium, ...]:
        """None when softid chooses by itself: its assumed dimensions fit nobody's actuator."""
        del input_name
        return () if self == type(self)() else (self,)

    def adapted(self, units: Mapping[str, str], *, inverted: bool = False) -> Equilibrium:
        """The model with the direction of the logs; its units are fixed."""
        del units
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return type(self)(**(values | {"inverted": inverted}))

    def parameters(self) -> ParameterSet:
        """C_d, a, b, c and stiffness; drive, rest torque and drift as the options say."""
        declared = ParameterSet(
            (
                _positive("C_d", 4.5e-4, "N·m·s/rad", 1e-9, 1e3, "viscous damping", "Eq 14"),
                _linear("a", 0.0, "1/rad²", "mass compensation, quadratic part", "Eq 14"),
                _linear("b", 0.0, "1/rad", "mass compensation by the size of the angle", "Eq 14"),
                _positive("c", 1.0, "1", 1e-2, 1e3, "mass compensation at rest", "Eq 14"),
                _positive("stiffness", 1.0, "1", 1e-3, 1e3, "scale of K(θ)", "Eq 13"),
                _positive("drive", 1.0, "1", 1e-3, 1e3, "scale of F(p)", "Eq 13"),
                _linear("rest_torque", 0.0, "N·m", "constant torque, the paper's C", "Eq 13"),
                _linear("drift", 0.0, "rad/s", "drift rate of the angle sensor", "section 4"),
            )
        )
        held = {"rest_torque": 0.0}
        if self.driving == "geometry":
            held["drive"] = 1.0
        if self.drift == "none":
            held["drift"] = 0.0
        if self.compensation != "quadratic":
            held |= {"a": 0.0, "b": 0.0}
        if self.compensation == "none":
            held["c"] = 1.0
        return declared.with_fixed(held)

    @property
    def compiled_body(self) -> Body:
        """Geometry and material as the compiled equation of motion takes them."""
        return _body(self)

    def torques(
        self, theta: Array, angle_rad: float, velocity_rad_s: float, pressure_kpa: float
    ) -> dict[str, float]:
        """The parts of the equation of motion at one state.

        Parameters
        ----------
        theta
            Parameter values, shape (8,).
        angle_rad, velocity_rad_s, pressure_kpa
            The state and the pressure.

        Returns
        -------
        dict
            ``inertia`` in kg·m²; ``inertial``, ``damping``, ``elastic`` and ``driving`` in N·m,
            with inertia·θ̈ + inertial + damping + elastic = driving.
        """
        parts = torque_parts(angle_rad, velocity_rad_s, pressure_kpa, theta, _body(self))
        names = ("inertia", "inertial", "damping", "elastic", "driving")
        return dict(zip(names, parts, strict=True))

    def guess(self, segments: Sequence[Segment], output: str) -> tuple[ParameterSet, ...]:
        """Stiffness from the levels, then a grid of C_d and c by simulation."""
        return equilibrium_starts(self, segments, output)

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
        body = _body(self)
        division = plan if plan is not None else self.plan(theta, segment)
        from_rest = start is None or relative
        state, tangent = np.zeros(2), np.zeros((2, N_DYNAMIC + 2))
        tangent[0, N_DYNAMIC] = tangent[1, N_DYNAMIC + 1] = 1.0
        if from_rest:
            pressure_kpa = float(segment.input[0])
            state[0] = rest_angle(pressure_kpa, theta, body)
            tangent[0, :N_DYNAMIC] = _rest_slopes(float(state[0]), pressure_kpa, theta, body)
        if start is not None:
            state += start
        begin = state.copy()
        n_steps = division.step_s.size
        states = np.empty((n_steps, 2))
        sign = -1.0 if self.inverted else 1.0
        arguments = (division.step_s, division.input_at(STAGES), theta, body, state)
        if not derivatives:
            propagate_bending(*arguments, states)
        else:
            first = tangent[0].copy()
            tangents = np.empty((n_steps, N_DYNAMIC + 2))
            propagate_bending_with_sensitivities(*arguments, tangent, states, tangents)
        angle = np.concatenate(([begin[0]], states[division.ends, 0]))
        values = dict.fromkeys(outputs, sign * angle + theta[N_DYNAMIC] * segment.time_s)
        if not derivatives:
            return Response(values, None, None, begin)
        by = sign * np.vstack((first, tangents[division.ends]))
        by_parameter = np.column_stack((by[:, :N_DYNAMIC], segment.time_s))
        return Response(
            values,
            dict.fromkeys(outputs, by_parameter),
            dict.fromkeys(outputs, by[:, N_DYNAMIC:]),
            begin,
        )

    def motion_term(self, theta: Array) -> MotionTerm:
        """The compiled law with its body, by which effects join the motion."""
        from softid.kernels.bending_term import law_address, pack, slopes_address

        body = _body(self)
        return MotionTerm(
            law_address(),
            pack(theta, body),
            slopes_address(),
            lambda pressure_kpa: float(rest_angle(pressure_kpa, theta, body)),
            lambda angle: float(torque_parts(angle, 0.0, 0.0, theta, body)[3]),
            N_DYNAMIC,
        )

    def observed(self, x: Array, output: str) -> tuple[Array, Array]:
        """The recorded angle, without drift, at positions of shape (n,), and its slope."""
        del output
        sign = -1.0 if self.inverted else 1.0
        return sign * x, np.full_like(x, sign)

    def plan(self, theta: Array, segment: Segment) -> Division:
        """Division of the sampling intervals by the fastest motion over the reached angles."""
        return self.plan_for(theta, segment, MAX_PHASE_PER_STEP)

    def plan_for(self, theta: Array, segment: Segment, phase: float) -> Division:
        """`plan` with another largest product of step and natural frequency."""
        body = _body(self)
        ends = (float(segment.input.min()), float(segment.input.max()))
        levels = np.array([rest_angle(p, theta, body) for p in ends])
        levels = np.where(np.isfinite(levels), levels, [np.sign(p) for p in ends])
        low, high = min(0.0, levels.min()), max(0.0, levels.max())
        # where the pressed wall is a tenth of its length, its stiffness is no guide to a step
        widest = min(LARGEST_ANGLE_RAD, MOST_STRETCH / float(body.stretch.max()))
        angles = OVERSHOOT * np.linspace(low, high, N_ANGLES)
        if theta[1] > 0.0:  # where C_m is smallest
            lightest = -theta[2] / (2.0 * theta[1])
            angles = np.append(angles, np.clip((-lightest, lightest), angles[0], angles[-1]))
        angles = np.clip(angles, -widest, widest)
        swing, fading = fastest_rates(angles, theta, body)
        rate = max(swing / phase, fading / MAX_FADING_PER_STEP)
        wanted = np.diff(segment.time_s) * (rate if np.isfinite(rate) else 0.0)
        counts = np.clip(np.ceil(wanted), 1, MAX_SUBSTEPS).astype(np.intp)
        return Division(held(segment.time_s), held(segment.input), counts.astype(np.int16), "rk4")

    def static_output(self, theta: Array, input_values: Array, output: str) -> Array:
        """The angle at which s·K(θ) + τ0 = d·F(p), without drift; NaN where there is none."""
        del output
        body, sign = _body(self), -1.0 if self.inverted else 1.0
        return np.array([sign * rest_angle(float(p), theta, body) for p in input_values])

    def derived(
        self, values: Mapping[str, float], input_range: tuple[float, float]
    ) -> dict[str, tuple[float, str]]:
        """Rest angle, natural frequency and damping ratio at the largest fitted pressure."""
        level = max(input_range, key=abs)
        angle = rest_angle(level, np.array([values[name] for name in NAMES]), _body(self))
        if not np.isfinite(angle):
            return {}
        at = f"_at_{level:.0f}_kPa"
        return {f"rest_angle{at}": (float(angle), "rad")} | self.speeds(values, level).named(at)

    def speeds(self, values: Mapping[str, float], u: float) -> Speeds:
        """Natural frequency and damping ratio at the angle where a pressure lets it rest."""
        theta, body = np.array([values[name] for name in NAMES]), _body(self)
        angle = rest_angle(u, theta, body)
        if not np.isfinite(angle):
            return Speeds()
        swing, fading = fastest_rates(np.array([angle]), theta, body)
        if not swing > 0:
            return Speeds()
        hz, ratio = float(swing) / (2.0 * np.pi), float(fading / (2.0 * swing))
        return Speeds(natural_frequency_hz=hz, damping_ratio=ratio)

    def cautions(
        self, values: Mapping[str, float], known: Sequence[str], covariance: Array | None
    ) -> tuple[Issue, ...]:
        """Assumed values, ratios, and logs that hardly separate the compensation."""
        return cautions_of(self, values, known, covariance)


@lru_cache(maxsize=32)
def _body(model: Equilibrium) -> Body:
    body: Body = Actuator.body(model, model.inertia, model.kernels)
    return body


def _rest_slopes(angle: float, pressure_kpa: float, theta: Array, body: Body) -> Array:
    """∂(rest angle)/∂(seven parameters), shape (7,)."""
    slopes = np.empty(N_DYNAMIC)
    rest_slopes(angle, pressure_kpa, theta, body, slopes)
    return slopes


def _positive(
    name: str, value: float, unit: str, lower: float, upper: float, meaning: str, equation: str
) -> Parameter:
    source = f"{_DEE}, {equation}"
    return Parameter(name, value, unit, lower, upper, "log", meaning=meaning, source=source)


def _linear(name: str, value: float, unit: str, meaning: str, equation: str) -> Parameter:
    return Parameter(name, value, unit, meaning=meaning, source=f"{_DEE}, {equation}")
