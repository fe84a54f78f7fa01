"""Hidden effects between the recorded pressure and the actuator."""

from __future__ import annotations

from collections.abc import Callable
from math import exp, log, log1p, pi, sqrt

import numpy as np

from softid.synthesis.actuators import Sizes
from softid.synthesis.hidden_base import (
    NO_RATES,
    Hidden,
    InputLaw,
    Occasion,
    Rates,
    States,
    Values,
    about,
    between,
    either,
    entry,
)

Generator = np.random.Generator
ATMOSPHERE_KPA = 101.325
LAMINAR = 0.999
"""Ratio of pressures above which the flow of ISO 6358 is linear, so that its slope is finite."""

SNAP = 2.0 / (3.0 * sqrt(3.0))
"""Push at which w − w³ + push loses one of its two stable zeros."""

STEEP = 6.0
_QUICK_S = 0.02
_FOLLOWING_S = 1e-3
"""Time in which a limit or a band of play is followed: a longer one would be a lag of its own."""


def _same(p: float) -> Rates:
    return (p,)


def _delay(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del sizes, occasion

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        return p, NO_RATES

    return InputLaw(act, delay_s=values["tau"])


def _lag(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del sizes, occasion
    tau = values["tau"]
    venting = tau * values.get("ratio", 1.0)

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        missing = p - z[0]
        return z[0], (missing / (tau if missing > 0.0 else venting),)

    return InputLaw(act, _same)


def _resonance(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del sizes, occasion
    omega, zeta = 2.0 * pi / values["period"], values["zeta"]

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        return z[0], (z[1], omega * (omega * (p - z[0]) - 2.0 * zeta * z[1]))

    return InputLaw(act, lambda p: (p, 0.0))


def flow_share(ratio: float, critical: float) -> float:
    """Flow over choked flow after ISO 6358; linear to zero above a ratio of `LAMINAR`.

    Parameters
    ----------
    ratio
        Downstream over upstream absolute pressure.
    critical
        Ratio below which the flow is choked.

    Source: ISO 6358-1:2013.
    """
    if ratio <= critical:
        return 1.0
    if ratio <= LAMINAR:
        return sqrt(1.0 - ((ratio - critical) / (1.0 - critical)) ** 2)
    edge = sqrt(1.0 - ((LAMINAR - critical) / (1.0 - critical)) ** 2)
    return edge * (1.0 - ratio) / (1.0 - LAMINAR)


def _valve_flow(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del sizes, occasion
    tau, critical = values["tau"], values["b"]
    venting = tau * values.get("ratio", 1.0)

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        supply, inside = p + ATMOSPHERE_KPA, z[0] + ATMOSPHERE_KPA
        if supply >= inside:
            return z[0], (supply / tau * flow_share(inside / supply, critical),)
        return z[0], (-inside / venting * flow_share(supply / inside, critical),)

    return InputLaw(act, _same)


def _softplus(value: float, width: float) -> float:
    return max(value, 0.0) + width * log1p(exp(-abs(value) / width))


def _dead_zone(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del sizes, occasion
    p0 = values["p0"]
    width = p0 * values["softness"]

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        return _softplus(p - p0, width) - _softplus(-p - p0, width), NO_RATES

    return InputLaw(act)


def _pressure_lag(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del occasion
    tau, growth, top = values["tau"], values["growth"], sizes.p_high

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        share = min(max(z[0] / top, 0.0), 1.0)
        return z[0], ((p - z[0]) / (tau * (1.0 + growth * share)),)

    return InputLaw(act, _same)


def _level_lag(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del occasion
    tau, growth = values["tau"], log(values["ratio"]) / sizes.p_span
    middle = 0.5 * (sizes.p_low + sizes.p_high)

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        return z[0], ((p - z[0]) / (tau * exp(growth * (z[0] - middle))),)

    return InputLaw(act, _same)


def _two_lags(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del sizes, occasion
    first, second = values["tau1"], values["tau2"]

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        return z[1], ((p - z[0]) / first, (z[0] - z[1]) / second)

    return InputLaw(act, lambda p: (p, p))


def _rate_limit(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del sizes, occasion
    limit = values["limit"]

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        return z[0], (min(max((p - z[0]) / _FOLLOWING_S, -limit), limit),)

    return InputLaw(act, _same)


def _supply_limit(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del sizes, occasion
    top = values["top"]

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        return min(p, top), NO_RATES

    return InputLaw(act)


def _input_backlash(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del sizes, occasion
    band = values["band"]

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        missing = p - z[0]
        return z[0], ((max(missing - band, 0.0) + min(missing + band, 0.0)) / _FOLLOWING_S,)

    return InputLaw(act, _same)


def _relief(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    """A leak whose opening w snaps over at two pressures, ẇ = (w − w³ + push)/τ."""
    del occasion
    middle = 0.5 * (values["opens"] + values["closes"])
    half = 0.5 * (values["opens"] - values["closes"])
    lost, supply_s = values["lost"], 0.5 * sizes.motion_s

    def push(inside: float) -> float:
        return SNAP * (inside - middle) / half

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        inside, w = z
        leak = lost * inside / (1.0 + exp(-STEEP * w))
        return inside, ((p - inside - leak) / supply_s, (w - w**3 + push(inside)) / _QUICK_S)

    def start(p: float) -> Rates:
        w = -1.0
        for _ in range(60):
            w = float(np.cbrt(w + push(p)))
        return (p / (1.0 + lost / (1.0 + exp(-STEEP * w))), w)

    return InputLaw(act, start)


def _periodic_gain(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del sizes
    gain, omega = values["gain"], 2.0 * pi / values["period"]
    phase = 2.0 * pi * float(np.random.default_rng(occasion.seed).random())

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        return p * (1.0 + gain * np.sin(omega * t + phase)), NO_RATES

    return InputLaw(act)


def _pressure_gain_drift(values: Values, sizes: Sizes, occasion: Occasion) -> InputLaw:
    del occasion
    rate = values["lost"] / sizes.duration_s

    def act(t: float, p: float, z: States) -> tuple[float, Rates]:
        return p * (1.0 - rate * t), NO_RATES

    return InputLaw(act)


def _lag_draw(share: float) -> Callable[[Sizes, Generator, float], dict[str, float]]:
    return lambda s, rng, size: {"tau": about(rng, share * size * s.motion_s)}


INPUTS: tuple[Hidden, ...] = (
    entry(
        "delay", "input", "pa(t) = p(t - tau)", "tau s",
        lambda s, rng, size: {"tau": about(rng, size * (0.02 + 0.3 * s.motion_s))}, _delay,
    ),
    entry("pneumatic_lag", "input", "tau pa' + pa = p", "tau s", _lag_draw(0.6), _lag),
    entry(
        "pneumatic_lag.separate", "input",
        "tau pa' + pa = p while filling, ratio tau pa' + pa = p while venting", "tau s, ratio 1",
        lambda s, rng, size: {
            "tau": about(rng, 0.4 * size * s.motion_s), "ratio": about(rng, 2.5) ** either(rng),
        }, _lag,
    ),
    entry(
        "pneumatic_lag.level", "input",
        "tau ratio^((pa - pm)/(ph - pl)) pa' + pa = p, pl lowest, ph highest, pm middle of p",
        "tau s, ratio 1",
        lambda s, rng, size: {
            "tau": about(rng, 0.5 * size * s.motion_s), "ratio": about(rng, 3.0) ** either(rng),
        }, _level_lag,
    ),
    entry(
        "line_resonance", "input", "pa''/w^2 + 2 zeta pa'/w + pa = p, w = 2 pi/period",
        "period s, zeta 1",
        lambda s, rng, size: {
            "period": about(rng, size * (0.1 + 1.2 * s.motion_s)), "zeta": rng.uniform(0.1, 0.35),
        }, _resonance,
    ),
    entry(
        "valve_flow", "input", "pa' = C pu psi(pd/pu), C = 1/tau", "tau s, b 1",
        lambda s, rng, size: {
            "tau": about(rng, 3.0 * size * s.motion_s), "b": rng.uniform(0.2, 0.45),
        }, _valve_flow,
    ),
    entry(
        "valve_flow.separate", "input",
        "pa' = pu psi(pd/pu)/tau while filling, pu psi(pd/pu)/(ratio tau) while venting",
        "tau s, b 1, ratio 1",
        lambda s, rng, size: {
            "tau": about(rng, 2.0 * size * s.motion_s), "b": rng.uniform(0.2, 0.45),
            "ratio": about(rng, 2.5) ** either(rng),
        }, _valve_flow,
    ),
    entry(
        "dead_zone", "input",
        "pa = S(p) - S(-p), S(p) = w ln(1 + exp((p - p0)/w)), w = softness p0",
        "p0 kPa, softness 1",
        lambda s, rng, size: {
            "p0": about(rng, 0.08 * size * s.p_high), "softness": between(rng, 0.05, 0.25),
        }, _dead_zone,
    ),
    entry(
        "pressure_lag", "input", "tau (1 + growth pa/p_max) pa' + pa = p", "tau s, growth 1",
        lambda s, rng, size: {
            "tau": about(rng, 0.4 * size * s.motion_s), "growth": rng.uniform(0.5, 2.0),
        }, _pressure_lag, relation="other_form", names=("pneumatic_lag", "valve_flow"),
    ),
    entry(
        "two_lags", "input", "two first-order lags, one behind the other", "tau1 s, tau2 s",
        lambda s, rng, size: {
            "tau1": about(rng, 0.4 * size * s.motion_s),
            "tau2": about(rng, 0.2 * size * s.motion_s),
        }, _two_lags, relation="other_form", names=("pneumatic_lag", "delay", "line_resonance"),
    ),
    entry(
        "rate_limit", "input", "pa' never beyond a limit either way", "limit kPa/s",
        lambda s, rng, size: {"limit": about(rng, 0.8 * s.p_span / (size * s.motion_s))},
        _rate_limit, relation="outside",
    ),
    entry(
        "supply_limit", "input", "pa = min(p, top)", "top kPa",
        lambda s, rng, size: {"top": (1.0 - min(about(rng, 0.12 * size), 0.5)) * s.p_high},
        _supply_limit, relation="outside",
    ),
    entry(
        "input_backlash", "input", "pa follows only when p is a band away from it", "band kPa",
        lambda s, rng, size: {"band": about(rng, 0.04 * size * s.p_span)},
        _input_backlash, relation="outside",
    ),
    entry(
        "relief_leak", "input", "a leak that opens above one pressure and closes below a lower one",
        "opens kPa, closes kPa, lost 1",
        lambda s, rng, size: {
            "opens": rng.uniform(0.6, 0.75) * s.p_high, "closes": rng.uniform(0.3, 0.45) * s.p_high,
            "lost": about(rng, 0.12 * size),
        }, _relief, relation="outside",
    ),
    entry(
        "periodic_gain", "input", "pa = p (1 + gain sin(2 pi t/period + phase)), any phase",
        "gain 1, period s",
        lambda s, rng, size: {
            "gain": about(rng, 0.06 * size), "period": s.duration_s * rng.uniform(0.15, 0.4),
        }, _periodic_gain, relation="outside",
    ),
    entry(
        "pressure_gain_drift", "input", "pa = p (1 - lost t/T), T the length of the first log",
        "lost 1",
        lambda s, rng, size: {"lost": min(about(rng, 0.1 * size), 0.8)},
        _pressure_gain_drift, relation="outside",
    ),
)  # fmt: skip
