"""Logs of a bending muscle that an integrator of its own moves, with a load that is put on."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

from softid.log import Log
from softid.models import Muscle

Array = npt.NDArray[np.float64]

MODEL = Muscle(x_unit="rad")
TRUTH = dict(zip(MODEL.parameters(), (0.05, 0.5, 2.8, 2.5, 0.1, 1.8, 0.7), strict=True))


def muscle_angle(
    time_s: Array,
    kpa: Array,
    theta: Mapping[str, float] = TRUTH,
    *,
    load: float = 0.0,
    put_on_s: float = -1.0,
) -> Array:
    """M·ẍ + N(p)·ẋ + Q(p)·x = P(p) − load by scipy, from rest."""

    def law(t: float, state: Array) -> tuple[float, float]:
        bar = np.interp(t, time_s, kpa) / 100.0
        rise = np.exp(theta["b1"] * bar)
        damping = theta["a2"] * np.exp(theta["b2"] * bar) + theta["c2"]
        spring = (theta["a1"] * rise + theta["c1"]) * state[0]
        resists = load if t > put_on_s else 0.0
        return state[1], (rise - resists - damping * state[1] - spring) / theta["M"]

    at_start = load if put_on_s < 0.0 else 0.0
    rest = (1.0 - at_start) / (theta["a1"] + theta["c1"])
    span = (0.0, float(time_s[-1]))
    found = solve_ivp(law, span, (rest, 0.0), t_eval=time_s, max_step=0.02, rtol=1e-7, atol=1e-9)
    angle: Array = found.y[0]
    return angle


def muscle_log(name: str, time_s: Array, kpa: Array, angle: Array) -> Log:
    """What is recorded of it."""
    channels = {"pressure": kpa, "angle": angle}
    return Log.from_arrays(time_s, channels, units={"angle": "rad"}, name=name)
