"""The conventional mass–spring–damper, for any pair of channels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import ClassVar, Literal

import numpy as np
import numpy.typing as npt

from softid.kernels.affine_blocks import OSCILLATOR
from softid.models.base import Model, Response
from softid.models.division import Division, divide_segment
from softid.models.option_kinds import require_choice
from softid.models.products import Keep, Products
from softid.models.second_order import (
    ORDERS,
    AffineForm,
    Law,
    Order,
    simulate_law,
)
from softid.models.summed_products import sum_law
from softid.models.time_scales import Speeds, order_seen, returning_late, speeds_of
from softid.models.weak_form import weak_form_coefficients
from softid.parameters import Parameter, ParameterSet
from softid.segment import Segment

Array = npt.NDArray[np.float64]

NAMES = ("M", "N", "Q", "G", "offset")
WINDOWS = (0.01, 0.03, 0.1, 0.3)
"""Lengths of the weak form's test functions as fractions of the longest segment."""

SPEEDS = 7
DAMPING_RATIOS = (0.15, 0.7, 3.0)
"""Time constants, from a sampling interval to a quarter of the log, and damping ratios, ringing,
hardly and creeping, that are tried beside the weak form, which noise misleads; a judgement."""

N_STARTS = 4
"""Starts that are handed on at most, a judgement: each costs a run of the optimiser."""


class OscillatorLaw(Law):
    """Constant coefficients and a force linear in the input."""

    def __init__(self, theta: Array) -> None:
        self._theta = theta
        self.mass = float(theta[0])
        self.mass_by = np.eye(len(NAMES))[0]

    def coefficients(self, u: Array) -> tuple[Array, Array, Array]:
        """N, Q and G·(u − offset) at inputs of shape (L,)."""
        _, damping, stiffness, gain, offset = self._theta
        return np.full(u.size, damping), np.full(u.size, stiffness), gain * (u - offset)

    def derivatives(self, u: Array) -> tuple[Array, Array, Array]:
        """Derivatives by the five parameters, each of shape (L, 5)."""
        damping_by, stiffness_by, force_by = (np.zeros((u.size, len(NAMES))) for _ in range(3))
        damping_by[:, 1] = 1.0
        stiffness_by[:, 2] = 1.0
        force_by[:, 3] = u - self._theta[4]
        force_by[:, 4] = -self._theta[3]
        return damping_by, stiffness_by, force_by

    def affine(self) -> AffineForm | None:
        """Constant coefficients; the gain's derivative follows from those by M, N and Q.

        Multiplying M, N, Q and G by one number changes nothing, so G·∂x/∂G is minus the sum of
        M·∂x/∂M, N·∂x/∂N and Q·∂x/∂Q. Without a gain nothing moves and nothing follows.
        """
        mass, damping, stiffness, gain, offset = self._theta
        if gain == 0.0:
            return None
        by_theta = np.zeros((7, len(NAMES)))
        by_theta[0, 0] = by_theta[6, 1] = by_theta[3, 2] = by_theta[2, 4] = 1.0
        by_theta[[0, 6, 3], 3] = -mass / gain, -damping / gain, -stiffness / gain
        theta = np.array([mass, 0.0, offset, stiffness, 0.0, 0.0, damping, gain])
        return AffineForm(OSCILLATOR, theta, by_theta)

    def exponent_rate(self) -> float:
        """Nothing bends: the coefficients do not depend on the input."""
        return 0.0


@dataclass(frozen=True)
class Oscillator(Model):
    """M·ẍ + N·ẋ + Q·x = G·(u − offset).

    Multiplying all coefficients by one number changes nothing, so G is held at 1 and M, N and Q are
    in units of the input: for a force in N and a position in m they are a mass, a viscous friction
    and a stiffness.

    Attributes
    ----------
    order
        ``"second"``; ``"first"`` drops M, ``"static"`` drops N too.
    spring
        ``"linear"``, or ``"none"`` for Q = 0 with an offset of the input to be found.
    x_unit, u_unit
        Units of output and input.
    inverted
        Whether the output falls as the input rises; G is then −1.

    Raises
    ------
    UsageError
        An option is none of its choices.
    """

    order: Order = "second"
    spring: Literal["linear", "none"] = "linear"
    x_unit: str = "1"
    u_unit: str = "1"
    inverted: bool = False

    name: ClassVar[str] = "oscillator"
    title: ClassVar[str] = "Mass–spring–damper with constant coefficients"
    equation: ClassVar[str] = "M x'' + N x' + Q x = G (u - offset)"
    source: ClassVar[str] = "the conventional second-order model; baseline in Ru et al. 2019, Eq 4"
    states: ClassVar[tuple[str, ...]] = ("x", "v")
    is_linear: ClassVar[bool] = True
    inertia_parameter: ClassVar[str | None] = "M"
    stiffness_parameter: ClassVar[str | None] = "Q"
    rest_parameter: ClassVar[str | None] = "offset"
    damping_parameters: ClassVar[tuple[str, ...]] = ("N",)
    identified_by: ClassVar[Mapping[str, str]] = {
        "M": "fast steps or a chirp past the natural frequency, sampled well above it",
        "N": "any transient that is slow enough to be sampled",
        "Q": "two or more settled levels",
        "G": "nothing: only its ratio to M, N and Q shows",
        "offset": "levels of both signs, and a known sensor zero",
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        require_choice("order", self.order, ORDERS)
        require_choice("spring", self.spring, ("linear", "none"))

    @property
    def label(self) -> str:
        """Name, and whether there is a spring."""
        return self.name if self.spring == "linear" else f"{self.name} without spring"

    def variants(self, input_name: str) -> tuple[Oscillator, ...]:
        """With a spring, and for a force also without one: a drive has none.

        Without one first, for it is the limit Q → 0, −Q·zero → −offset of the other: a spring that
        explains no more than this is none, whatever stiffness was found.
        """
        return (replace(self, spring="none"), self) if input_name == "force" else (self,)

    def adapted(self, units: Mapping[str, str], *, inverted: bool = False) -> Oscillator:
        """The model with the units of the logs."""
        output = next(name for name in units if name != "input")
        return replace(self, x_unit=units[output], u_unit=units["input"], inverted=inverted)

    @property
    def start_states(self) -> tuple[str, ...]:
        """Both states, or fewer in the first-order and static limits."""
        return self.states[: ORDERS.index(self.order)]

    def parameters(self) -> ParameterSet:
        """M, N, Q; G held at ±1 and, with a spring, the offset held at 0."""
        per = f"{self.u_unit}/{self.x_unit}"
        declared = ParameterSet(
            (
                Parameter("M", 1e-2, f"{per}·s²", 1e-15, 1e15, "log", meaning="inertia"),
                Parameter("N", 1.0, f"{per}·s", 1e-15, 1e15, "log", meaning="viscous damping"),
                Parameter("Q", 1.0, per, 1e-15, 1e15, "log", meaning="stiffness"),
                Parameter("G", 1.0, "1", meaning="input gain, held: it sets the scale"),
                Parameter("offset", 0.0, self.u_unit, meaning="input at which nothing pushes"),
            )
        )
        held = {"G": -1.0 if self.inverted else 1.0}
        if self.spring == "linear":
            held["offset"] = 0.0
        else:
            held["Q"] = 0.0
        if self.order != "second":
            held["M"] = 0.0
        if self.order == "static":
            held["N"] = 0.0
        return declared.with_fixed(held)

    def hidden_terms(self, damping: float, hidden_s: float) -> Mapping[str, float]:
        """Inertia and damping."""
        return {"M": hidden_s * damping, "N": damping}

    def guess(self, segments: Sequence[Segment], output: str) -> tuple[ParameterSet, ...]:
        """Weak-form regression at several window lengths and a grid of speeds, ranked."""
        declared = self.parameters()
        sign = declared["G"].value
        candidates = [
            np.array([m, n, q, sign, offset])
            for window in WINDOWS
            for m, n, q, offset in weak_form_coefficients(
                segments, output, window, gain=sign, spring=self.spring == "linear"
            )
        ]
        scored = [(_score(segments, output, theta, declared), theta) for theta in candidates]
        if self.spring == "linear":
            scored += _grid(segments, output, sign)
        scored = sorted((row for row in scored if np.isfinite(row[0])), key=lambda row: row[0])
        starts = []
        for _, theta in scored[:N_STARTS]:
            named = dict(zip(NAMES, theta.tolist(), strict=True))
            starts.append(
                declared.with_values({k: v for k, v in named.items() if not declared[k].fixed})
            )
        return tuple(starts)

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
        law = OscillatorLaw(theta)
        motion = simulate_law(
            law,
            segment.time_s,
            segment.input,
            start,
            derivatives=derivatives,
            relative=relative,
            plan=self.plan(theta, segment) if plan is None else plan,
        )
        first = np.array([motion.x[0], motion.v[0]])
        values = dict.fromkeys(outputs, motion.x)
        if motion.by_parameter is None or motion.by_state is None:
            return Response(values, None, None, first, motion.x, motion.v)
        return Response(
            values,
            dict.fromkeys(outputs, motion.by_parameter),
            dict.fromkeys(outputs, motion.by_state[:, : len(self.start_states)]),
            first,
            motion.x,
            motion.v,
        )

    def motion_law(self, theta: Array) -> OscillatorLaw:
        """The constant coefficients."""
        return OscillatorLaw(theta)

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
        """Summed: every output is x itself; see `Model.products`."""
        return sum_law(
            OscillatorLaw(theta),
            segment,
            channel,
            start,
            relative=relative,
            plan=self.plan(theta, segment) if plan is None else plan,
            gain=1.0,
            level=zero,
            keep=keep,
        )

    def plan(self, theta: Array, segment: Segment) -> Division:
        """Division of the sampling intervals; see `Model.plan`."""
        return divide_segment(OscillatorLaw(theta), theta, segment)

    def static_output(self, theta: Array, input_values: Array, output: str) -> Array:
        """The line x = G·(u − offset)/Q; NaN without a spring."""
        del output
        _, stiffness, force = OscillatorLaw(theta).coefficients(input_values)
        return np.where(stiffness > 0, force / np.where(stiffness > 0, stiffness, 1.0), np.nan)

    def derived(
        self, values: Mapping[str, float], input_range: tuple[float, float]
    ) -> dict[str, tuple[float, str]]:
        """Static gain, time constant, natural frequency and damping ratio."""
        if values["Q"] <= 0:
            return {}
        gain = values["G"] / values["Q"], f"{self.x_unit}/{self.u_unit}"
        return {"static_gain": gain} | self.speeds(values, input_range[0]).named()

    def speeds(self, values: Mapping[str, float], u: float) -> Speeds:
        """Time constant, natural frequency and damping ratio, the same at any input."""
        return speeds_of(OscillatorLaw(np.array([values[name] for name in NAMES])), u)

    def limit(
        self, theta: Array, period_s: float, input_range: tuple[float, float], longest_s: float
    ) -> tuple[Oscillator, str] | None:
        """The lower order where a term is too fast for the samples, no spring where it is slow."""
        law = OscillatorLaw(theta)
        found = order_seen(law, self.order, period_s, np.array(input_range))
        if found:
            return replace(self, order=found[0]), found[1]
        late = returning_late(law, input_range[0], longest_s) if self.spring == "linear" else None
        return (replace(self, spring="none"), late) if late else None


def _grid(segments: Sequence[Segment], output: str, sign: float) -> list[tuple[float, Array]]:
    """Speeds and damping ratios on a grid, each with the stiffness that explains most, scored.

    A stiffness from the slope of the output over the input would be none past the natural
    frequency, where the output moves against its input.
    """
    shortest = min(float(np.median(np.diff(s.time_s))) for s in segments)
    longest = max(float(s.time_s[-1] - s.time_s[0]) for s in segments)
    scored = []
    for tau, ratio in product(np.geomspace(shortest, longest / 4, SPEEDS), DAMPING_RATIOS):
        theta = np.array([tau**2 / (4 * ratio**2), tau, 1.0, sign, 0.0])
        left, gain = _at_best_gain(segments, output, theta)
        if gain > 0.0:
            theta[:3] /= gain
            scored.append((left, theta))
    return scored


def _at_best_gain(segments: Sequence[Segment], output: str, theta: Array) -> tuple[float, float]:
    """Residual sum of squares with zeros and a common gain projected out, and that gain."""
    cross = power = whole = 0.0
    for s in segments:
        used = s.used[output]
        if not used.any():
            continue
        x = simulate_law(OscillatorLaw(theta), s.time_s, s.input, None, derivatives=False).x[used]
        y = s.outputs[output][used]
        x, y = x - x.mean(), y - y.mean()
        cross, power, whole = cross + float(x @ y), power + float(x @ x), whole + float(y @ y)
    gain = cross / power if power > 0.0 else 0.0
    return whole - gain * cross, gain


def _score(segments: Sequence[Segment], output: str, theta: Array, declared: ParameterSet) -> float:
    """Residual sum of squares with the zeros projected out, or infinity."""
    at = theta.copy()
    for k, p in enumerate(declared.values()):
        at[k] = p.value if p.fixed else min(max(at[k], p.lower), p.upper)
    total = 0.0
    for s in segments:
        used = s.used[output]
        if not used.any():
            continue
        start = None
        if at[2] <= 0:
            first = np.flatnonzero(used)[0]
            start = np.array([s.outputs[output][first], 0.0])
        x = simulate_law(OscillatorLaw(at), s.time_s, s.input, start, derivatives=False).x[used]
        r = s.outputs[output][used] - x
        r = r - r.mean()
        total += float(r @ r)
    return total
