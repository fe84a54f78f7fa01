"""Logs drawn at random but fault-free, and the means to put one fault into them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.log import Log

Array = npt.NDArray[np.float64]
KINDS = ("step", "staircase", "sine", "triangle", "chirp", "random")


@dataclass(frozen=True)
class Drawn:
    """A fault-free log and what it was drawn from; sizes in kPa and degrees."""

    log: Log
    kind: str
    rate_hz: float
    pressure_noise: float
    angle_noise: float
    pressure_step: float
    angle_step: float


def follow(time_s: Array, given: Array, lag_s: float) -> Array:
    """First-order response to a held input: exact between samples."""
    kept = np.exp(-np.diff(time_s) / lag_s)
    out = np.empty_like(given)
    out[0] = state = given[0]
    for k in range(1, given.size):
        state = given[k] + (state - given[k]) * kept[k - 1]
        out[k] = state
    return out


def command(kind: str, time_s: Array, top: float, rng: np.random.Generator) -> Array:
    """One of the usual excitations between 0 and ``top``."""
    span_s, frequency = time_s[-1], rng.uniform(0.1, 0.5)
    if kind == "step":
        return top * ((time_s * frequency) % 1.0 < 0.5)
    if kind == "staircase":
        count = int(rng.integers(4, 10))
        rung = np.minimum((2 * count * time_s / span_s).astype(int), 2 * count - 1)
        return top / count * np.where(rung < count, rung, 2 * count - rung)
    if kind == "sine":
        return 0.5 * top * (1.0 - np.cos(2 * np.pi * frequency * time_s))
    if kind == "triangle":
        return top * (1.0 - np.abs(2.0 * ((time_s * frequency) % 1.0) - 1.0))
    if kind == "chirp":
        phase = 0.1 * time_s + 0.75 / span_s * time_s**2
        return 0.5 * top * (1.0 - np.cos(2 * np.pi * phase))
    hold_s = rng.uniform(0.5, 3.0)
    levels = rng.uniform(0.0, top, int(span_s / hold_s) + 2)
    return levels[np.maximum((time_s / hold_s).astype(int), 0)]


def draw(seed: int) -> Drawn:
    """A pressure that follows a command and an angle that follows the pressure, both measured."""
    rng = np.random.default_rng(seed)
    rate_hz = float(rng.choice([20.0, 33.0, 50.0, 100.0, 200.0]))
    n = int(rng.uniform(20.0, 40.0) * rate_hz)
    time_s = (np.arange(n) + rng.choice([0.0, 0.3]) * rng.uniform(-1, 1, n)) / rate_hz
    time_s -= time_s[0]
    kind, top = str(rng.choice(KINDS)), rng.uniform(20.0, 150.0)
    wanted = command(kind, time_s, top, rng)
    pressure = follow(time_s, wanted, rng.uniform(0.02, 0.6))
    angle = 40.0 * (follow(time_s, pressure, rng.uniform(0.05, 1.0)) / top) ** rng.uniform(0.6, 1.5)
    pressure_noise = top * rng.choice([0.0, 0.001, 0.003, 0.01])
    angle_noise = 40.0 * rng.choice([0.0, 0.0005, 0.002, 0.01])
    pressure = pressure + pressure_noise * rng.standard_normal(n)
    angle = angle + angle_noise * rng.standard_normal(n)
    pressure_step = top * rng.choice([0.0, 0.0005, 0.004, 0.02])
    angle_step = 40.0 * rng.choice([0.0, 1e-5, 0.001, 0.01])
    log = Log.from_arrays(
        time_s,
        {
            "pressure": quantised(pressure, pressure_step),
            "pressure_command": wanted,
            "angle": quantised(angle, angle_step),
        },
        units={"angle": "deg"},
        name=f"drawn-{seed}",
    )
    return Drawn(
        log, kind, rate_hz, pressure_noise, angle_noise, float(pressure_step), float(angle_step)
    )


def quantised(values: Array, step: float) -> Array:
    """Values on a grid; unchanged for a step of 0."""
    return np.round(values / step) * step if step > 0.0 else values


def with_fault(log: Log, name: str, fault: Callable[[Array], Array]) -> Log:
    """The same log with one channel changed; values in the display unit."""
    channel = log.channels[name]
    shown = fault(np.array(channel.displayed))
    changed = replace(channel, values=shown / channel.display_factor)
    return replace(log, channels={**log.channels, name: changed})


def staircase_log(*, noise_deg: float = 0.02, rate_hz: float = 100.0, seed: int = 0) -> Log:
    """Up and down over six levels of 4 s, with a noisy pressure and an overdamped angle."""
    rng = np.random.default_rng(seed)
    rungs = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 80.0, 60.0, 40.0, 20.0, 0.0]
    wanted = np.repeat(rungs, int(4.0 * rate_hz))
    time_s = np.arange(wanted.size) / rate_hz
    pressure = follow(time_s, wanted, 0.1)
    angle = 0.4 * follow(time_s, pressure, 0.4)
    return Log.from_arrays(
        time_s,
        {
            "pressure": pressure + 0.2 * rng.standard_normal(wanted.size),
            "pressure_command": wanted,
            "angle": angle + noise_deg * rng.standard_normal(wanted.size),
        },
        units={"angle": "deg"},
        name="staircase",
    )
