"""Hidden effects in the equation of motion that are laws of the catalogue of effects."""

from __future__ import annotations

from collections.abc import Callable
from math import exp, log1p, tanh

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
Draw = Callable[[Sizes, Generator, float], dict[str, float]]
CURVE_KNOTS = 6
HEIGHTS = tuple(f"k{i + 1}" for i in range(1, CURVE_KNOTS))
CORNER_WIDTH = 0.01
"""Share of the range over which a contact closes."""

LARGEST_SOFTENING = 0.12
"""Largest share of cubic softening: above 4/27 no position balances the largest force."""

LEVELLING_WIDTH = 0.1
"""Share of the pressures over which a static curve levels off beyond its range."""


def rest_at_zero(_: float) -> Rates:
    """One own state that begins at zero, wherever the actuator rests."""
    return (0.0,)


def rest_on_branch(branch: float) -> Callable[[float], Rates]:
    """One own state that begins where an earlier motion has left it.

    Parameters
    ----------
    branch
        Where that is.
    """
    return lambda _: (branch,)


def rest_at_position(x: float) -> Rates:
    """One own state that begins at the position."""
    return (x,)


def _static_curve(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    from scipy.interpolate import CubicSpline  # 0.2 s, and `softid --help` needs none of it

    del occasion
    low, high = sizes.p_low, sizes.p_high
    knots = np.linspace(low, high, CURVE_KNOTS)
    spline = CubicSpline(knots, [0.0, *(values[name] for name in HEIGHTS)], bc_type="natural")
    cubes = spline.c.T.tolist()
    ends = (float(spline(low, 1)), float(spline(high, 1)))
    width, pieces = LEVELLING_WIDTH * (high - low), CURVE_KNOTS - 1

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        inside = min(max(p, low), high)
        at = min(int((inside - low) / (high - low) * pieces), pieces - 1)
        a, b, c, d = cubes[at]
        h = inside - low - at * (high - low) / pieces
        parts.shift += ((a * h + b) * h + c) * h + d
        if p != inside:
            parts.shift += ends[p > high] * width * tanh((p - inside) / width)
        return NO_RATES

    return MotionLaw(act)


def _stiffening(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    k3 = values["k3"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.force += k3 * x * x * x
        return NO_RATES

    return MotionLaw(act)


def _contact(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del occasion
    return _obstacle(values, sizes, 1.0)


def _contact_below(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del occasion
    return _obstacle(values, sizes, -1.0)


def _obstacle(values: Values, sizes: Sizes, side: float) -> MotionLaw:
    """An obstacle above a position (side 1), or below it (−1)."""
    kw, xw = values["kw"], values["xw"]
    width = CORNER_WIDTH * sizes.x_span / (1.0 + kw * sizes.x_span / sizes.force)

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        depth = side * (x - xw)
        parts.force += side * kw * (max(depth, 0.0) + width * log1p(exp(-abs(depth) / width)))
        return NO_RATES

    return MotionLaw(act)


def _quadratic(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    d2 = values["d2"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.force += d2 * v * abs(v)
        return NO_RATES

    return MotionLaw(act)


def _power_damping(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del occasion
    power, speed = values["n"], sizes.v_max
    force = values["d2"] * speed**2

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.force += (force if v > 0.0 else -force) * (abs(v) / speed) ** power
        return NO_RATES

    return MotionLaw(act)


def _asymmetric(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    eps, v0 = values["eps"], values["v0"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.damping *= 1.0 + eps * tanh(v / v0)
        return NO_RATES

    return MotionLaw(act)


def _friction(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    dry, vs = values["Fc"], values["vs"]
    beta, vb, k = values.get("beta", 0.0), values.get("vb", 1.0), values.get("k", 0.0)

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        excess = k * abs(p) + (beta * exp(-((v / vb) ** 2)) if beta else 0.0)
        parts.force += dry * tanh(v / vs) * (1.0 + excess)
        return NO_RATES

    return MotionLaw(act)


def _hysteresis(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    alpha, zs, k = values["alpha"], values["zs"], values.get("k", 0.0)

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.force += alpha * z[0] * (1.0 + k * abs(p))
        return ((v - abs(v) * z[0]) / zs,)

    return MotionLaw(act, rest_on_branch(values.get("z0", 0.0)))


def _creep(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    k, tau = values["k"], values["tau"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        stretch = x - z[0]
        parts.force += k * stretch
        return (stretch / tau,)

    return MotionLaw(act, rest_at_position)


def _softening(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    lost, path = values["s"], values["W0"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.spring *= 1.0 - lost * (1.0 - exp(-z[0]))
        return (abs(v) / path,)

    return MotionLaw(act, rest_at_zero)


def _ageing(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    rate = values["r"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.spring *= 1.0 + rate * t
        return NO_RATES

    return MotionLaw(act)


def _mass(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    growth = values["m"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.inertia *= 1.0 + growth * p
        return NO_RATES

    return MotionLaw(act)


def _draw_curve(s: Sizes, rng: Generator, size: float) -> dict[str, float]:
    """A random mixture of a bow and an S that no linear function explains."""
    at = np.linspace(-1.0, 1.0, CURVE_KNOTS)
    bow, bend = at**2 - np.mean(at**2), at**3 - at * np.sum(at**4) / np.sum(at**2)
    angle = rng.uniform(0.0, 2.0 * np.pi)
    shape = np.cos(angle) * bow / np.max(np.abs(bow)) + np.sin(angle) * bend / np.max(np.abs(bend))
    heights = about(rng, 0.06 * size) * s.x_span * shape
    return {name: float(heights[i] - heights[0]) for i, name in enumerate(HEIGHTS, start=1)}


def _draw_stiffening(s: Sizes, rng: Generator, size: float) -> dict[str, float]:
    natural = s.force / s.x_span / max(abs(s.x_low), abs(s.x_high)) ** 2
    if rng.random() < 0.5:
        return {"k3": about(rng, 0.3 * size) * natural}
    return {"k3": -min(about(rng, 0.1 * size), LARGEST_SOFTENING) * natural}


def _draw_mass(s: Sizes, rng: Generator, size: float) -> dict[str, float]:
    if rng.random() < 0.5:
        return {"m": about(rng, 3.0 * size) / s.p_high}
    return {"m": -min(about(rng, 0.6 * size), 0.85) / s.p_high}


def draw_friction(s: Sizes, rng: Generator, size: float) -> dict[str, float]:
    """Dry friction with a narrow turn.

    Parameters
    ----------
    s, rng, size
        As `Hidden.draw`.
    """
    return {"Fc": about(rng, 0.05 * size * s.force), "vs": between(rng, 0.01, 0.05) * s.v_max}


MOTIONS: tuple[Hidden, ...] = (
    entry(
        "static_curve", "state",
        "x - s(u) in place of x in the spring; s a cubic spline through 6 knots, the first 0",
        ", ".join(f"{name} {{x}}" for name in HEIGHTS), _draw_curve, _static_curve,
    ),
    entry("stiffening", "state", "+ k3 x^3", "k3 {f}/{x}³", _draw_stiffening, _stiffening),
    entry(
        "contact", "state", "+ kw max(x - xw, 0), corner rounded over 1 % of the range or less",
        "kw {f}/{x}, xw {x}",
        lambda s, rng, size: {
            "kw": about(rng, size * s.force / s.x_span),
            "xw": s.x_low + rng.uniform(0.5, 0.8) * s.x_span,
        }, _contact,
    ),
    entry(
        "contact.lower", "state", "- kw max(xw - x, 0), corner as of contact", "kw {f}/{x}, xw {x}",
        lambda s, rng, size: {
            "kw": about(rng, size * s.force / s.x_span),
            "xw": s.x_low + rng.uniform(0.2, 0.5) * s.x_span,
        }, _contact_below,
    ),
    entry(
        "quadratic_damping", "state", "+ d2 v |v|", "d2 {f}·s²/{x}²",
        lambda s, rng, size: {"d2": about(rng, 1.2 * size * s.damping / s.v_max)}, _quadratic,
    ),
    entry(
        "quadratic_damping.power", "state", "+ d2 vm^2 |v/vm|^n sign(v), vm the largest speed",
        "d2 {f}·s²/{x}², n 1",
        lambda s, rng, size: {
            "d2": about(rng, 1.2 * size * s.damping / s.v_max), "n": rng.uniform(2.6, 4.0),
        }, _power_damping,
    ),
    entry(
        "asymmetric_damping", "state", "N (1 + eps tanh(v/v0)) in place of N", "eps 1, v0 {x}/s",
        lambda s, rng, size: {
            "eps": either(rng) * min(about(rng, 0.35 * size), 0.9),
            "v0": between(rng, 0.03, 0.15) * s.v_max,
        }, _asymmetric,
    ),
    entry(
        "coulomb_friction", "state", "+ Fc tanh(v/vs)", "Fc {f}, vs {x}/s",
        draw_friction, _friction,
    ),
    entry(
        "coulomb_friction.stribeck", "state", "+ Fc tanh(v/vs) (1 + beta exp(-(v/vb)^2))",
        "Fc {f}, vs {x}/s, beta 1, vb {x}/s",
        lambda s, rng, size: {
            **draw_friction(s, rng, 0.7 * size), "beta": rng.uniform(0.4, 1.2),
            "vb": between(rng, 0.06, 0.2) * s.v_max,
        }, _friction,
    ),
    entry(
        "coulomb_friction.pressure", "state", "+ Fc tanh(v/vs) (1 + k |u|)",
        "Fc {f}, vs {x}/s, k 1/kPa",
        lambda s, rng, size: {
            **draw_friction(s, rng, 0.5 * size), "k": rng.uniform(1.0, 4.0) / s.p_high,
        }, _friction,
    ),
    entry(
        "hysteresis", "state", "+ alpha z, z' = (v - |v| z)/zs", "alpha {f}, zs {x}",
        lambda s, rng, size: {
            "alpha": about(rng, 0.06 * size * s.force), "zs": between(rng, 0.04, 0.2) * s.x_span,
        }, _hysteresis,
    ),
    entry(
        "hysteresis.branch", "state", "+ alpha z, z' = (v - |v| z)/zs, z = z0 as a log begins",
        "alpha {f}, zs {x}, z0 1",
        lambda s, rng, size: {
            "alpha": about(rng, 0.06 * size * s.force), "zs": between(rng, 0.04, 0.2) * s.x_span,
            "z0": either(rng) * rng.uniform(0.5, 1.0),
        }, _hysteresis,
    ),
    entry(
        "hysteresis.pressure", "state", "+ alpha z (1 + k |u|), z' = (v - |v| z)/zs",
        "alpha {f}, zs {x}, k 1/kPa",
        lambda s, rng, size: {
            "alpha": about(rng, 0.03 * size * s.force), "zs": between(rng, 0.04, 0.2) * s.x_span,
            "k": rng.uniform(1.0, 4.0) / s.p_high,
        }, _hysteresis,
    ),
    entry(
        "creep", "state", "+ k (x - z), tau z' = x - z", "k {f}/{x}, tau s",
        lambda s, rng, size: {
            "k": about(rng, 0.25 * size * s.force / s.x_span), "tau": between(rng, 2.0, 10.0),
        }, _creep,
    ),
    entry(
        "softening", "state", "Q (1 - s (1 - exp(-W/W0))) in place of Q, W' = |v|",
        "s 1, W0 {x}",
        lambda s, rng, size: {
            "s": min(about(rng, 0.18 * size), 0.8), "W0": between(rng, 0.1, 0.4) * s.travel,
        }, _softening,
    ),
    entry(
        "ageing", "state", "Q (1 + r t) in place of Q", "r 1/s",
        lambda s, rng, size: {
            "r": either(rng) * min(about(rng, 0.2 * size), 0.8) / s.duration_s,
        }, _ageing,
    ),
    entry(
        "pressure_mass", "state", "M (1 + m u) in place of M", "m 1/kPa", _draw_mass, _mass,
    ),
)  # fmt: skip
