"""Hidden effects in the equation of motion whose laws the catalogue of effects does not have."""

from __future__ import annotations

from math import cos, exp, pi

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
    passed,
)

Generator = np.random.Generator
SLIP_DISTANCES = (0.25, 0.6, 1.3, 2.5)
SLIP_POWER = 9
"""The element yields the more suddenly the higher the power; 9 slips within a few per cent."""

LEAST_SHARE = 0.05
"""Share of a damping or an inertia that stays whatever takes it away."""

FRACTIONAL_TIMES_S = (0.05, 0.2, 0.8, 3.2, 12.8)
"""Times of the creeps that together stand for a power law, a factor of four apart, from faster than
the motion to a good part of a hold."""


def _maxwell_slip(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    share = values["alpha"] / len(SLIP_DISTANCES)
    distances = [values["distance"] * factor for factor in SLIP_DISTANCES]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        speed = abs(v)
        rates = []
        for element, distance in zip(z, distances, strict=True):
            parts.force += share * element
            rates.append((v - speed * element**SLIP_POWER) / distance)
        return tuple(rates)

    return MotionLaw(act, lambda x: (0.0,) * len(SLIP_DISTANCES))


def _lugre(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    dry, beta, vb = values["Fc"], values["beta"], values["vb"]
    stiffness, bristle_damping = values["sigma0"], values["sigma1"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        level = dry * (1.0 + beta * exp(-((v / vb) ** 2)))
        rate = v - abs(v) * stiffness * z[0] / level
        parts.force += stiffness * z[0] + bristle_damping * rate
        return (rate,)

    return MotionLaw(act, lambda x: (0.0,))


def _many_creeps(stiffness: list[float], times_s: list[float]) -> MotionLaw:
    pairs = list(zip(stiffness, times_s, strict=True))

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        rates = []
        for own, (k, tau) in zip(z, pairs, strict=True):
            parts.force += k * (x - own)
            rates.append((x - own) / tau)
        return tuple(rates)

    return MotionLaw(act, lambda x: (x,) * len(pairs))


def _two_creeps(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    return _many_creeps([values["k1"], values["k2"]], [values["tau1"], values["tau2"]])


def _fractional(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    stiffness = [values["k"] * tau ** -values["order"] for tau in FRACTIONAL_TIMES_S]
    return _many_creeps(stiffness, list(FRACTIONAL_TIMES_S))


def _quintic(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    k5 = values["k5"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.force += k5 * x**5
        return NO_RATES

    return MotionLaw(act)


def _hertz(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del occasion
    kh, xw, span = values["kh"], values["xw"], sizes.x_span

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        if x > xw:
            parts.force += kh * span * ((x - xw) / span) ** 1.5
        return NO_RATES

    return MotionLaw(act)


def _settling(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    change, time_s = values["change"], values["time"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.spring *= 1.0 + change * (1.0 - exp(-t / time_s))
        return NO_RATES

    return MotionLaw(act)


def _position_damping(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    excess, place, width = values["excess"], values["place"], values["width"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.damping *= 1.0 + excess * exp(-(((x - place) / width) ** 2))
        return NO_RATES

    return MotionLaw(act)


def _damping_slope(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del occasion
    slope, low = values["slope"] / sizes.x_span, sizes.x_low

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.damping *= max(1.0 + slope * (x - low), LEAST_SHARE)
        return NO_RATES

    return MotionLaw(act)


def _inertia_slope(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del occasion
    slope, low = values["slope"] / sizes.x_span, sizes.x_low

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.inertia *= max(1.0 + slope * (x - low), LEAST_SHARE)
        return NO_RATES

    return MotionLaw(act)


def _damping_drift(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del occasion
    rate = values["change"] / sizes.duration_s

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.damping *= max(1.0 + rate * t, LEAST_SHARE)
        return NO_RATES

    return MotionLaw(act)


def _load_drift(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del occasion
    rate = values["force"] / sizes.duration_s

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.force += rate * t
        return NO_RATES

    return MotionLaw(act)


def _load_jump(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes
    force = values["force"]
    at = -1.0 if occasion.later else values["at"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.force += force * passed(t, at)
        return NO_RATES

    return MotionLaw(act)


def _stiffness_jump(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes
    change = values["change"]
    at = -1.0 if occasion.later else values["at"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.spring *= 1.0 + change * passed(t, at)
        return NO_RATES

    return MotionLaw(act)


def _cross_talk(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes
    rng = np.random.default_rng(occasion.seed)
    force, fills_s = values["force"], 0.3
    count = max(2, round(occasion.duration_s / values["every"]))
    times = np.sort(rng.uniform(0.0, occasion.duration_s, count)).tolist()
    steps = np.diff(rng.random(count), prepend=0.0).tolist()

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        wanted = 0.0
        for at, step in zip(times, steps, strict=True):
            if t <= at:
                break
            wanted += step * passed(t, at)
        parts.force += force * z[0]
        return ((wanted - z[0]) / fills_s,)

    return MotionLaw(act, lambda x: (0.0,))


def _wander(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes
    period_s = 0.2
    rng = np.random.default_rng(occasion.seed)
    count = int(1.1 * occasion.duration_s / period_s) + 3
    walk = values["force"] * np.cumsum(rng.uniform(-1.0, 1.0, count)) * np.sqrt(3.0 * period_s)
    levels = [0.0, *walk.tolist()]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        place = max(t, 0.0) / period_s
        left = min(int(place), count - 1)
        turn = 0.5 - 0.5 * cos(pi * (place - left))
        parts.force += levels[left] + (levels[left + 1] - levels[left]) * turn
        return NO_RATES

    return MotionLaw(act)


def _swinging_load(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    k, omega, zeta = values["k"], 2.0 * pi / values["period"], values["zeta"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        stretch, relative = x - z[0], v - z[1]
        pull = stretch + 2.0 * zeta * relative / omega
        parts.force += k * pull
        return (z[1], omega * omega * pull)

    return MotionLaw(act, lambda x: (x, 0.0))


def _pleats(values: Values, sizes: Sizes, occasion: Occasion) -> MotionLaw:
    del sizes, occasion
    force, wave = values["force"], 2.0 * pi / values["length"]

    def act(t: float, p: float, x: float, v: float, z: States, parts: Parts) -> Rates:
        parts.force += force * cos(wave * x)
        return NO_RATES

    return MotionLaw(act)


def _knots_of_force(s: Sizes, rng: Generator, size: float) -> dict[str, float]:
    return {"force": about(rng, 0.06 * size * s.force), "length": rng.uniform(0.15, 0.3) * s.x_span}


OTHER_FORMS: tuple[Hidden, ...] = (
    entry(
        "maxwell_slip", "state", "+ alpha times the mean of 4 elements that stretch and then slip",
        "alpha {f}, distance {x}",
        lambda s, rng, size: {
            "alpha": about(rng, 0.06 * size * s.force),
            "distance": between(rng, 0.03, 0.12) * s.x_span,
        }, _maxwell_slip, relation="other_form", names=("hysteresis", "coulomb_friction"),
    ),
    entry(
        "lugre", "state",
        "+ sigma0 z + sigma1 z', z' = v - |v| sigma0 z/(Fc (1 + beta e^{-(v/vb)^2}))",
        "Fc {f}, beta 1, vb {x}/s, sigma0 {f}/{x}, sigma1 {f}·s/{x}",
        lambda s, rng, size: {
            "Fc": (dry := about(rng, 0.05 * size * s.force)), "beta": rng.uniform(0.2, 0.6),
            "vb": between(rng, 0.05, 0.2) * s.v_max,
            "sigma0": dry / (between(rng, 0.02, 0.06) * s.x_span), "sigma1": 0.05 * s.damping,
        }, _lugre, relation="other_form", names=("coulomb_friction", "hysteresis"),
    ),
    entry(
        "two_time_creep", "state", "+ k1 (x - z1) + k2 (x - z2), tau_i z_i' = x - z_i",
        "k1 {f}/{x}, tau1 s, k2 {f}/{x}, tau2 s",
        lambda s, rng, size: {
            "k1": about(rng, 0.15 * size * s.force / s.x_span), "tau1": between(rng, 0.8, 2.0),
            "k2": about(rng, 0.15 * size * s.force / s.x_span), "tau2": between(rng, 8.0, 20.0),
        }, _two_creeps, relation="other_form", names=("creep",),
    ),
    entry(
        "fractional_damping", "state",
        "+ sum k tau_i^-order (x - z_i), tau_i from 0.05 s to 12.8 s",
        "k {f}/{x}, order 1",
        lambda s, rng, size: {
            "k": about(rng, 0.08 * size * s.force / s.x_span), "order": rng.uniform(0.2, 0.4),
        }, _fractional, relation="other_form", names=("creep",),
    ),
    entry(
        "quintic_stiffening", "state", "+ k5 x^5", "k5 {f}/{x}^5",
        lambda s, rng, size: {
            "k5": about(rng, 0.3 * size) * s.force / s.x_span / max(abs(s.x_low), s.x_high) ** 4,
        }, _quintic, relation="other_form", names=("stiffening", "static_curve", "contact"),
    ),
    entry(
        "hertz_contact", "state", "+ kh x_span ((x - xw)/x_span)^1.5 beyond xw",
        "kh {f}/{x}, xw {x}",
        lambda s, rng, size: {
            "kh": about(rng, 2.0 * size * s.force / s.x_span),
            "xw": s.x_low + rng.uniform(0.4, 0.7) * s.x_span,
        }, _hertz, relation="other_form", names=("contact", "stiffening", "static_curve"),
    ),
    entry(
        "settling_stiffness", "state", "Q (1 + change (1 - exp(-t/time))) in place of Q",
        "change 1, time s",
        lambda s, rng, size: {
            "change": either(rng) * min(about(rng, 0.18 * size), 0.8),
            "time": rng.uniform(0.2, 0.6) * s.duration_s,
        }, _settling, relation="other_form", names=("ageing", "softening"),
    ),
)  # fmt: skip

OUTSIDE: tuple[Hidden, ...] = (
    entry(
        "position_damping", "state", "N (1 + excess exp(-((x - place)/width)^2)) in place of N",
        "excess 1, place {x}, width {x}",
        lambda s, rng, size: {
            "excess": about(rng, 2.0 * size), "place": s.x_low + rng.uniform(0.3, 0.7) * s.x_span,
            "width": rng.uniform(0.08, 0.15) * s.x_span,
        }, _position_damping, relation="outside",
    ),
    entry(
        "damping_slope", "state", "N (1 + slope (x - x_low)/x_span) in place of N", "slope 1",
        lambda s, rng, size: {"slope": max(either(rng) * about(rng, 0.8 * size), -0.8)},
        _damping_slope, relation="outside",
    ),
    entry(
        "inertia_slope", "state", "M (1 + slope (x - x_low)/x_span) in place of M", "slope 1",
        lambda s, rng, size: {"slope": max(either(rng) * about(rng, 1.5 * size), -0.8)},
        _inertia_slope, relation="outside",
    ),
    entry(
        "damping_drift", "state", "N (1 + change t/T) in place of N, T that of the first log",
        "change 1",
        lambda s, rng, size: {"change": max(either(rng) * about(rng, 0.5 * size), -0.8)},
        _damping_drift, relation="outside",
    ),
    entry(
        "load_drift", "state", "+ force t/T, T the length of the first log", "force {f}",
        lambda s, rng, size: {"force": either(rng) * about(rng, 0.12 * size * s.force)},
        _load_drift, relation="outside",
    ),
    entry(
        "load_jump", "state", "+ force from one moment on", "force {f}, at s",
        lambda s, rng, size: {
            "force": either(rng) * about(rng, 0.1 * size * s.force),
            "at": rng.uniform(0.25, 0.75) * s.duration_s,
        }, _load_jump, relation="outside",
    ),
    entry(
        "stiffness_jump", "state", "Q (1 + change) in place of Q from one moment on",
        "change 1, at s",
        lambda s, rng, size: {
            "change": either(rng) * min(about(rng, 0.12 * size), 0.8),
            "at": rng.uniform(0.25, 0.75) * s.duration_s,
        }, _stiffness_jump, relation="outside",
    ),
    entry(
        "cross_talk", "state", "- force p2/p_max of a second chamber with a program of its own",
        "force {f}, every s",
        lambda s, rng, size: {
            "force": either(rng) * about(rng, 0.1 * size * s.force), "every": rng.uniform(2.0, 5.0),
        }, _cross_talk, relation="outside",
    ),
    entry(
        "random_force", "state", "+ a random walk that grows by force in 1 s", "force {f}",
        lambda s, rng, size: {"force": about(rng, 0.02 * size * s.force)},
        _wander, relation="outside",
    ),
    entry(
        "swinging_load", "state", "a load that swings on a spring k fixed to the actuator",
        "k {f}/{x}, period s, zeta 1",
        lambda s, rng, size: {
            "k": about(rng, 0.15 * size * s.force / s.x_span),
            "period": about(rng, 0.5 + 1.5 * s.motion_s), "zeta": rng.uniform(0.03, 0.1),
        }, _swinging_load, relation="outside",
    ),
    entry(
        "pleats", "state", "+ force cos(2 pi x/length)", "force {f}, length {x}",
        _knots_of_force, _pleats, relation="outside",
    ),
)  # fmt: skip
