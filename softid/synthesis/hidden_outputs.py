"""Hidden effects between the motion and its reading."""

from __future__ import annotations

from collections.abc import Callable
from math import exp, inf, pi

import numpy as np
import numpy.typing as npt

from softid.synthesis.actuators import Sizes
from softid.synthesis.hidden_base import (
    JUMP_S,
    Hidden,
    Occasion,
    OutputLaw,
    Rates,
    States,
    Values,
    about,
    between,
    either,
    entry,
)

SHORTEST_S = 0.05
"""Nobody smooths over less: a cut-off of 20 Hz."""

Array = npt.NDArray[np.float64]
Generator = np.random.Generator


def _drift(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    return OutputLaw(lambda t, y: y + values["rate"] * t)


def _gain_drift(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    return OutputLaw(lambda t, y: y * (1.0 + values["g"] * t))


def _warmup(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    return OutputLaw(lambda t, y: y - values["size"] * np.expm1(-t / values["time"]))


def _lag(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    tau = values["tau"]

    def follow(y: float, z: States) -> tuple[float, Rates]:
        return z[0], ((y - z[0]) / tau,)

    return OutputLaw(follow=follow, start=lambda y: (y,))


def _series_creep(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    return _settling(values["c"], values["tau"])


def _relaxation(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    return _settling(-values["c"], values["tau"])


def _settling(share: float, tau: float) -> OutputLaw:
    """What goes on by a share of every change, in a time; it returns where that is negative."""

    def read(times: Array, y: Array) -> Array:
        """With what a lag of straight pieces leaves of every sample at the next one."""
        h = np.diff(times)
        kept = np.exp(-h / tau)
        mean = (1.0 - kept) * tau / h  # share of the piece's own begin and end that has arrived
        arrived = y[1:] * (1.0 - mean) + y[:-1] * (mean - kept)
        crept = [y[0]]
        for left, new in zip(kept.tolist(), arrived.tolist(), strict=True):
            crept.append(left * crept[-1] + new)
        return y + share * np.array(crept)

    return OutputLaw(read=read)


def _second_order(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    omega, zeta = 2.0 * pi / values["period"], values["zeta"]

    def follow(y: float, z: States) -> tuple[float, Rates]:
        return z[0], (z[1], omega * (omega * (y - z[0]) - 2.0 * zeta * z[1]))

    return OutputLaw(follow=follow, start=lambda y: (y, 0.0))


def _moving_average(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion

    def read(t: Array, y: Array) -> Array:
        area: Array = np.append(0.0, np.cumsum(0.5 * np.diff(t) * (y[1:] + y[:-1])))
        before = t - values["width"]
        inside = np.interp(before, t, area) + np.minimum(before - t[0], 0.0) * y[0]
        averaged: Array = (area - inside) / values["width"]
        return averaged

    return OutputLaw(read)


def _filtered(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion

    def there_and_back(t: Array, y: Array) -> Array:
        from scipy.signal import butter, filtfilt

        cut_off = 2.0 * float(np.median(np.diff(t))) / values["period"]  # as a share of half a rate
        smooth: Array = filtfilt(*butter(round(values["order"]), cut_off), y)
        return smooth

    return OutputLaw(afterwards=there_and_back)


def _centred_mean(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion

    def averaged(t: Array, y: Array) -> Array:
        area = np.append(0.0, np.cumsum(0.5 * np.diff(t) * (y[1:] + y[:-1])))
        ends = np.clip(t + 0.5 * values["width"], t[0], t[-1])
        begins = np.clip(t - 0.5 * values["width"], t[0], t[-1])
        found: Array = (np.interp(ends, t, area) - np.interp(begins, t, area)) / (ends - begins)
        return found

    return OutputLaw(afterwards=averaged)


def _clipping(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    lower, upper = values.get("lower", -inf), values.get("upper", inf)
    return OutputLaw(lambda t, y: np.clip(y, lower, upper))


def _soft_clipping(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    upper, width = values["upper"], values["width"]
    return OutputLaw(lambda t, y: upper - width * np.logaddexp(0.0, (upper - y) / width))


def _clock(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    return OutputLaw(clock_rate=values["rate"])


def played(y: Array, width: float) -> Array:
    """The follower in a slot of half width ``width``, z_k = min(max(z_{k−1}, y_k − w), y_k + w).

    Parameters
    ----------
    y
        Position of the slot, dense in time, shape (n,).
    width
        Half the play.

    Source: Tao & Kokotović, *Adaptive Control of Systems with Nonlinearities*, 1996 (backlash).

    Examples
    --------
    >>> played(np.array([0.0, 2.0, 1.5, -2.0]), 1.0).tolist()
    [0.0, 1.0, 1.0, -1.0]
    """
    found = []
    z = float(y[0])
    for value in y.tolist():
        z = min(max(z, value - width), value + width)
        found.append(z)
    return np.array(found)


def _backlash(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    return OutputLaw(lambda t, y: played(y, values["width"]))


def _s_shape(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del occasion
    amplitude = values["amplitude"]
    low, span = sizes.x_low, sizes.x_span
    return OutputLaw(lambda t, y: y + amplitude * np.sin(2.0 * pi * (y - low) / span))


def _saturating(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del occasion
    low, full = sizes.x_low, values["full"]
    return OutputLaw(lambda t, y: low + full * np.tanh((y - low) / full))


def _slip(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes
    if occasion.later:
        return OutputLaw(lambda t, y: y + values["slip"])
    share = np.array([0.0, JUMP_S])
    return OutputLaw(
        lambda t, y: y + np.interp(t - values["at"], share, np.array([0.0, values["slip"]]))
    )


def _clock_slip(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion

    def read(t: Array, y: Array) -> Array:
        late = np.where(t > values["at"], values["slip"], 0.0)
        slipped: Array = np.interp(t - late, t, y)
        return slipped

    return OutputLaw(read)


def _gain_jump(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes, occasion
    return OutputLaw(lambda t, y: y * np.where(t > values["at"], 1.0 + values["change"], 1.0))


def _spikes(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes
    rng = np.random.default_rng(occasion.seed)
    count = max(1, round(values["rate"] * occasion.duration_s))
    times = rng.uniform(0.0, occasion.duration_s, count)
    heights = values["height"] * rng.choice([-1.0, 1.0], count)

    def read(t: Array, y: Array) -> Array:
        bumps = [h * np.exp(-(((t - at) / 0.1) ** 2)) for at, h in zip(times, heights, strict=True)]
        total: Array = y + np.sum(bumps, axis=0)
        return total

    return OutputLaw(read)


def _zero_wander(values: Values, sizes: Sizes, occasion: Occasion) -> OutputLaw:
    del sizes
    period_s = values["time"] / 50.0
    times = np.arange(0.0, 1.1 * occasion.duration_s + 2.0 * period_s, period_s)
    kept = exp(-period_s / values["time"])
    kicks = np.random.default_rng(occasion.seed).standard_normal(times.size)
    levels = [float(kicks[0])]
    for kick in kicks[1:].tolist():
        levels.append(kept * levels[-1] + (1.0 - kept * kept) ** 0.5 * kick)
    return OutputLaw(lambda t, y: y + values["size"] * np.interp(t, times, levels))


def _clip_draw(*ends: str) -> Callable[[Sizes, Generator, float], dict[str, float]]:
    def draw(s: Sizes, rng: Generator, size: float) -> dict[str, float]:
        depths = {end: min(about(rng, 0.15 * size), 0.65) * s.x_span for end in ends}
        places = {"upper": s.x_high, "lower": s.x_low}
        signs = {"upper": -1.0, "lower": 1.0}
        return {end: places[end] + signs[end] * depth for end, depth in depths.items()}

    return draw


OUTPUTS: tuple[Hidden, ...] = (
    entry(
        "sensor_drift", "output", "recorded y = x + rate t", "rate {x}/s",
        lambda s, rng, size: {
            "rate": either(rng) * about(rng, 0.12 * size * s.x_span / s.duration_s),
        }, _drift,
    ),
    entry(
        "sensor_gain_drift", "output", "recorded y = x (1 + g t)", "g 1/s",
        lambda s, rng, size: {"g": either(rng) * about(rng, 0.12 * size / s.duration_s)},
        _gain_drift,
    ),
    entry(
        "sensor_warmup", "output", "recorded y = x + size (1 - exp(-t/time))", "size {x}, time s",
        lambda s, rng, size: {
            "size": either(rng) * about(rng, 0.12 * size * s.x_span),
            "time": rng.uniform(0.1, 0.3) * s.duration_s,
        }, _warmup,
    ),
    entry(
        "creep.series", "output", "recorded y = x + c z, tau z' + z = x", "c 1, tau s",
        lambda s, rng, size: {
            "c": about(rng, 0.12 * size), "tau": between(rng, 0.04, 0.15) * s.duration_s,
        }, _series_creep,
    ),
    entry(
        "relaxation", "output", "recorded y = x - c z, tau z' + z = x", "c 1, tau s",
        lambda s, rng, size: {
            "c": about(rng, 0.12 * size), "tau": between(rng, 0.04, 0.15) * s.duration_s,
        }, _relaxation,
    ),
    entry(
        "sensor_lag", "output", "recorded y: tau y' + y = x", "tau s",
        lambda s, rng, size: {"tau": about(rng, 0.5 * size * s.motion_s)}, _lag,
    ),
    entry(
        "sensor_resonance", "output", "recorded y: y''/w^2 + 2 zeta y'/w + y = x, w = 2 pi/period",
        "period s, zeta 1",
        lambda s, rng, size: {
            "period": about(rng, size * (0.1 + 1.2 * s.motion_s)), "zeta": rng.uniform(0.15, 0.8),
        }, _second_order,
    ),
    entry(
        "smoothing", "output", "the record filtered there and back, a Butterworth filter",
        "period s, order 1",
        lambda s, rng, size: {
            "period": max(about(rng, size * s.motion_s), SHORTEST_S), "order": 2.0,
        }, _filtered,
    ),
    entry(
        "smoothing.mean", "output", "the mean of what was recorded from t - width/2 to t + width/2",
        "width s",
        lambda s, rng, size: {"width": max(about(rng, size * s.motion_s), SHORTEST_S)},
        _centred_mean,
    ),
    entry(
        "smoothing.past", "output", "recorded y = mean of x over the last width s", "width s",
        lambda s, rng, size: {"width": max(about(rng, 1.2 * size * s.motion_s), SHORTEST_S)},
        _moving_average,
    ),
    entry(
        "sensor_clipping", "output", "recorded y = min(x, upper)", "upper {x}",
        _clip_draw("upper"), _clipping,
    ),
    entry(
        "sensor_clipping.lower", "output", "recorded y = max(x, lower)", "lower {x}",
        _clip_draw("lower"), _clipping,
    ),
    entry(
        "sensor_clipping.both", "output", "recorded y = max(min(x, upper), lower)",
        "upper {x}, lower {x}", _clip_draw("upper", "lower"), _clipping,
    ),
    entry(
        "clock_rate", "output", "recorded y(t) = x((1 + rate) t)", "rate 1",
        lambda s, rng, size: {
            "rate": either(rng) * min(about(rng, 0.8 * size * s.motion_s / s.duration_s), 0.045),
        }, _clock,
    ),
    entry(
        "soft_clipping", "output", "recorded y = upper - width ln(1 + exp((upper - x)/width))",
        "upper {x}, width {x}",
        lambda s, rng, size: {
            "upper": s.x_high - about(rng, 0.12 * size * s.x_span), "width": 0.03 * s.x_span,
        }, _soft_clipping, relation="other_form", names=("sensor_clipping", "contact"),
    ),
    entry(
        "output_backlash", "output", "the reading follows the motion with play, half width w",
        "width {x}", lambda s, rng, size: {"width": about(rng, 0.04 * size * s.x_span)},
        _backlash, relation="outside",
    ),
    entry(
        "s_shaped_sensor", "output", "recorded y = x + amplitude sin(2 pi (x - x_low)/x_span)",
        "amplitude {x}",
        lambda s, rng, size: {"amplitude": either(rng) * about(rng, 0.05 * size * s.x_span)},
        _s_shape, relation="outside",
    ),
    entry(
        "saturating_sensor", "output", "recorded y = x_low + full tanh((x - x_low)/full)",
        "full {x}", lambda s, rng, size: {"full": 1.6 * s.x_span / about(rng, size)},
        _saturating, relation="outside",
    ),
    entry(
        "zero_slip", "output", "the sensor's zero slips once", "slip {x}, at s",
        lambda s, rng, size: {
            "slip": either(rng) * about(rng, 0.08 * size * s.x_span),
            "at": rng.uniform(0.3, 0.7) * s.duration_s,
        }, _slip, relation="outside",
    ),
    entry(
        "clock_slip", "output", "recorded y(t) = x(t - slip) from one moment on", "slip s, at s",
        lambda s, rng, size: {
            "slip": about(rng, 0.5 * size * s.motion_s),
            "at": rng.uniform(0.3, 0.7) * s.duration_s,
        }, _clock_slip, relation="outside",
    ),
    entry(
        "gain_jump", "output", "recorded y = x (1 + change) from one moment on", "change 1, at s",
        lambda s, rng, size: {
            "change": either(rng) * about(rng, 0.08 * size),
            "at": rng.uniform(0.3, 0.7) * s.duration_s,
        }, _gain_jump, relation="outside",
    ),
    entry(
        "knocks", "output", "short bumps of the reading at random times", "rate 1/s, height {x}",
        lambda s, rng, size: {
            "rate": rng.uniform(0.1, 0.3), "height": about(rng, 0.12 * size * s.x_span),
        }, _spikes, relation="outside",
    ),
    entry(
        "zero_wander", "output", "the sensor's zero wanders, its covariance size^2 e^{-|t|/time}",
        "size {x}, time s",
        lambda s, rng, size: {
            "size": about(rng, 0.04 * size * s.x_span), "time": between(rng, 15.0, 40.0),
        }, _zero_wander, relation="outside",
    ),
)  # fmt: skip
