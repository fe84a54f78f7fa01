"""State effects as a textbook writes them, integrated by scipy, and drives to try them on.

Nothing here calls softid's simulator: the laws are written again, splines come from scipy, and an
adaptive solver at a tolerance of 1e-9 does the integration.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from softid.effects import Effect, ExtendedModel, Scale
from softid.log import Log
from softid.models.oscillator import Oscillator
from softid.segment import Segment

PERIOD_S = 0.01
MUSCLE = np.array([3e-3, 1 / 60, 2.0, 0.3, 0.02, 0.3, 0.05])
OSCILLATOR = np.array([1e-2, 0.12, 2.0, 1.0, 0.0])

Values = Mapping[str, float]


@dataclass
class Parts:
    """What an effect adds: force, factors of inertia, damping and stiffness, shift, and ż."""

    force: float = 0.0
    mass: float = 1.0
    damping: float = 1.0
    stiffness: float = 1.0
    shift: float = 0.0
    rate: float = 0.0


@dataclass
class Instant:
    """Where and when a law is asked."""

    x: float
    v: float
    z: float
    u: float
    t: float
    scale: Scale
    memory: dict[str, object] = field(default_factory=dict)


Law = Callable[[Instant, Values], Parts]


def _static_curve(at: Instant, p: Values) -> Parts:
    low, high = at.scale.u_low, at.scale.u_high
    if "spline" not in at.memory:
        knots = np.linspace(low, high, 6)
        at.memory["spline"] = CubicSpline(
            knots, [0.0, *(p[f"k{i}"] for i in range(2, 7))], bc_type="natural"
        )
    spline = at.memory["spline"]
    inside = min(max(at.u, low), high)
    width = 0.1 * (high - low)
    beyond = width * np.tanh((at.u - inside) / width)
    return Parts(shift=float(spline(inside)) + float(spline(inside, 1)) * beyond)


def _contact(at: Instant, p: Values) -> Parts:
    width = 0.01 * at.scale.x_span / (1.0 + p["kw"] * at.scale.x_span / at.scale.force)
    return Parts(force=p["kw"] * width * float(np.logaddexp(0.0, (at.x - p["xw"]) / width)))


def _contact_below(at: Instant, p: Values) -> Parts:
    width = 0.01 * at.scale.x_span / (1.0 + p["kw"] * at.scale.x_span / at.scale.force)
    return Parts(force=-p["kw"] * width * float(np.logaddexp(0.0, (p["xw"] - at.x) / width)))


def _stribeck(at: Instant, p: Values) -> Parts:
    excess = p["beta"] * np.exp(-((at.v / p["vb"]) ** 2))
    return Parts(force=float(p["Fc"] * np.tanh(at.v / p["vs"]) * (1 + excess)))


LAWS: dict[str, Law] = {
    "static_curve": _static_curve,
    "stiffening": lambda at, p: Parts(force=p["k3"] * at.x**3),
    "contact": _contact,
    "contact.lower": _contact_below,
    "quadratic_damping.power": lambda at, p: Parts(
        force=p["d2"] * at.scale.v_max**2 * np.sign(at.v) * abs(at.v / at.scale.v_max) ** p["n"]
    ),
    "quadratic_damping": lambda at, p: Parts(force=p["d2"] * at.v * abs(at.v)),
    "asymmetric_damping": lambda at, p: Parts(
        damping=1 + p["eps"] * float(np.tanh(at.v / p["v0"]))
    ),
    "coulomb_friction": lambda at, p: Parts(force=p["Fc"] * float(np.tanh(at.v / p["vs"]))),
    "coulomb_friction.stribeck": _stribeck,
    "coulomb_friction.pressure": lambda at, p: Parts(
        force=p["Fc"] * float(np.tanh(at.v / p["vs"])) * (1 + p["k"] * abs(at.u))
    ),
    "hysteresis": lambda at, p: Parts(
        force=p["alpha"] * at.z, rate=(at.v - abs(at.v) * at.z) / p["zs"]
    ),
    "hysteresis.pressure": lambda at, p: Parts(
        force=p["alpha"] * at.z * (1 + p["k"] * abs(at.u)),
        rate=(at.v - abs(at.v) * at.z) / p["zs"],
    ),
    "hysteresis.branch": lambda at, p: Parts(  # z counts from z0 here
        force=p["alpha"] * (p["z0"] + at.z),
        rate=(at.v - abs(at.v) * (p["z0"] + at.z)) / p["zs"],
    ),
    "creep": lambda at, p: Parts(force=p["k"] * (at.x - at.z), rate=(at.x - at.z) / p["tau"]),
    # z is the path itself here
    "softening": lambda at, p: Parts(
        stiffness=1 - p["s"] * (1 - float(np.exp(-at.z / p["W0"]))), rate=abs(at.v)
    ),
    "ageing": lambda at, p: Parts(stiffness=1 + p["r"] * at.t),
    "pressure_mass": lambda at, p: Parts(mass=1 + p["m"] * at.u),
}


def muscle_coefficients(u_kpa: float) -> tuple[float, float, float, float]:
    """M, N, Q and P of Ru et al. 2019, Eq 4 to 7."""
    mass, a1, b1, c1, a2, b2, c2 = MUSCLE
    bar = u_kpa / 100.0
    drive = np.exp(b1 * bar)
    return mass, a2 * np.exp(b2 * bar) + c2, a1 * drive + c1, drive


def oscillator_coefficients(u: float) -> tuple[float, float, float, float]:
    """M, N, Q and G u."""
    mass, damping, stiffness, gain, _ = OSCILLATOR
    return mass, damping, stiffness, gain * u


COEFFICIENTS = {"muscle": muscle_coefficients, "oscillator": oscillator_coefficients}
SIZES = {"muscle": 250.0, "oscillator": 1.0}


def rich_input(time_s: np.ndarray) -> np.ndarray:
    """Rest, ramped steps up and down, a sine and a chirp between 0 and 1."""
    u = np.interp(
        time_s, [0, 0.3, 0.33, 0.9, 0.93, 1.5, 1.53, 2.0], [0, 0, 0.5, 0.5, 1.0, 1.0, 0.25, 0.25]
    )
    sine = 0.25 + 0.4 * np.sin(2 * np.pi * (time_s - 2.0))
    chirp = 0.25 + 0.3 * np.sin(2 * np.pi * (time_s - 4.0) * (0.5 + 1.2 * (time_s - 4.0)))
    return np.clip(np.where(time_s < 2.0, u, np.where(time_s < 4.0, sine, chirp)), 0.0, 1.0)


def driven(model: str, duration_s: float = 6.0) -> Segment:
    """The rich input for a model at 100 Hz; the output is blank."""
    time_s = np.arange(round(duration_s / PERIOD_S)) * PERIOD_S
    u = SIZES[model] * rich_input(time_s)
    return segment(time_s, u)


def segment(time_s: np.ndarray, u: np.ndarray) -> Segment:
    """A drive without a recorded output."""
    channels = {"pressure": u, "position": time_s}
    return Log.from_arrays(time_s, channels, input="pressure", outputs=("position",)).segments()[0]


def round_scale() -> Scale:
    """Round sizes, for laws that are tried by themselves."""
    return Scale(
        u_low=0.0, u_high=1.0, x_low=0.0, x_high=0.5, v_max=2.0, force=1.0, y_low=0.0, y_high=0.5,
        period_s=PERIOD_S, duration_s=10.0, motion_s=0.1, travel=10.0,
    )  # fmt: skip


def oscillation(
    effect: Effect,
    values: Values,
    drive: Segment,
    coefficients: tuple[float, float, float],
    start: tuple[float, ...] | None = None,
    model: Oscillator | None = None,
) -> np.ndarray:
    """Position of an oscillator (M, N, Q) with one effect, by softid's simulator."""
    extended = ExtendedModel(model or Oscillator(), (effect,), round_scale())
    eta = [values[name] for name in effect.parameters(round_scale())]
    theta = np.array([*coefficients, 1.0, 0.0, *eta])
    began = None if start is None else np.array(start)
    found = extended.response(theta, drive, ("position",), start=began, derivatives=False)
    return found.outputs["position"]


def settled(effect: Effect, values: Values, u: np.ndarray, stiffness: float) -> np.ndarray:
    """Position at rest of an oscillator with one effect, by softid."""
    extended = ExtendedModel(Oscillator(), (effect,), round_scale())
    eta = [values[name] for name in effect.parameters(round_scale())]
    theta = np.array([0.01, 0.1, stiffness, 1.0, 0.0, *eta])
    return extended.static_output(theta, u, "position")


def sizes(model: str, drive: Segment) -> Scale:
    """Sizes of the base motion, from scipy's integration of it."""
    motion = textbook_motion(model, drive, None, {}, None)
    u, x, v = drive.input, motion[0], motion[1]
    _, _, low, _ = COEFFICIENTS[model](float(u.min()))
    _, _, high, _ = COEFFICIENTS[model](float(u.max()))
    return Scale(
        u_low=float(u.min()), u_high=float(u.max()), x_low=float(x.min()), x_high=float(x.max()),
        v_max=float(np.quantile(np.abs(v), 0.99)), force=0.5 * (low + high) * float(np.ptp(x)),
        y_low=float(x.min()), y_high=float(x.max()), period_s=PERIOD_S,
        duration_s=float(drive.time_s[-1]), motion_s=0.1,
        travel=float(np.sum(np.abs(v)) * PERIOD_S),
    )  # fmt: skip


def textbook_motion(
    model: str, drive: Segment, effect: str | None, values: Values, scale: Scale | None
) -> np.ndarray:
    """x, v and the effect's own state from rest, shape (3, n), by LSODA at 1e-9."""
    law = LAWS[effect] if effect else None
    memory: dict[str, object] = {}

    def parts(t: float, y: np.ndarray, u: float) -> Parts:
        if law is None or scale is None:
            return Parts()
        return law(Instant(y[0], y[1], y[2], u, t, scale, memory), values)

    def motion(t: float, y: np.ndarray) -> tuple[float, float, float]:
        u = float(np.interp(t, drive.time_s, drive.input))
        m, n, q, drives = COEFFICIENTS[model](u)
        p = parts(t, y, u)
        pull = drives - p.force - n * p.damping * y[1] - q * p.stiffness * (y[0] - p.shift)
        return y[1], pull / (m * p.mass), p.rate

    follows = effect == "creep"
    start = _rest(model, drive, parts, follows)
    followed = start if follows else 0.0
    solved = solve_ivp(
        motion, (0.0, drive.time_s[-1]), (start, 0.0, followed), "LSODA", drive.time_s,
        rtol=1e-9, atol=1e-10, max_step=PERIOD_S,
    )  # fmt: skip
    assert solved.success
    return np.asarray(solved.y)


def _rest(
    model: str,
    drive: Segment,
    parts: Callable[[float, np.ndarray, float], Parts],
    follows: bool,
) -> float:
    """Where nothing moves under the first input, near the rest of the model alone."""
    u = float(drive.input[0])
    _, _, q, drives = COEFFICIENTS[model](u)

    def left(x: float) -> float:
        p = parts(0.0, np.array([x, 0.0, x if follows else 0.0]), u)
        return q * p.stiffness * (x - p.shift) + p.force - drives

    reach = 0.5 * drives / q + 0.1 * SIZES[model] / OSCILLATOR[2]
    while left(drives / q - reach) * left(drives / q + reach) > 0.0:
        reach *= 1.5
    return float(brentq(left, drives / q - reach, drives / q + reach, xtol=1e-13))
