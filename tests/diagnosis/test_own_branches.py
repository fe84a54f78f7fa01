"""Logs of a hysteresis of which one begins where another motion has left the actuator."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp

from softid.diagnosis import diagnose
from softid.log import Log

Array = npt.NDArray[np.float64]

RATE_HZ, HELD_S = 100.0, 1.5
MASS, DAMPING, STIFFNESS = 0.4, 10.0, 50.0
"""kPa·s²/rad, kPa·s/rad, kPa/rad: a time constant of 0.2 s."""

ALPHA, ZS = 14.0, 0.08
"""kPa; rad, in a range of 2 rad: nearly dry friction, but for how it gives way at a turn."""


def moved(levels: Array, branch: float, seed: int) -> Log:
    """Held levels behind a valve of 50 ms, from rest without pressure with z = branch."""
    time_s = np.arange(round(RATE_HZ * HELD_S * levels.size)) / RATE_HZ
    wanted = np.repeat(levels, round(RATE_HZ * HELD_S))
    pressure = np.zeros(time_s.size)
    for k in range(1, time_s.size):
        pressure[k] = pressure[k - 1] + (wanted[k] - pressure[k - 1]) / (0.05 * RATE_HZ)

    def rates(t: float, state: Array) -> list[float]:
        x, v, z = state
        force = np.interp(t, time_s, pressure) - DAMPING * v - STIFFNESS * x - ALPHA * z
        return [v, force / MASS, (v - abs(v) * z) / ZS]

    start = [-ALPHA * branch / STIFFNESS, 0.0, branch]
    found = solve_ivp(
        rates, time_s[[0, -1]], start, t_eval=time_s, max_step=0.01, rtol=1e-6, atol=1e-8
    )
    noise = 0.03 * np.random.default_rng(seed).standard_normal(time_s.size)
    channels = {"pressure": pressure, "angle": found.y[0] + noise}
    return Log.from_arrays(time_s, channels, name=f"log-{seed}")


def levels(seed: int) -> Array:
    """A rest, and levels over the range."""
    return np.concatenate([[0.0], np.random.default_rng(seed).uniform(5.0, 100.0, 15), [0.0]])


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_no_dry_friction_is_named_alone_where_logs_begin_on_other_branches(seed: int) -> None:
    """Stands on the law that scipy solves. The first log begins as made, the second after a move.

    Friction lets each log begin where it is held; a hysteresis that begins all logs alike does not.
    """
    first, second = moved(levels(seed), 0.0, seed), moved(levels(seed + 10), -1.0, seed + 10)
    judge = moved(levels(seed + 20), 0.0, seed + 20)
    found = diagnose([first, second], hold_out=[judge], model="oscillator")
    tied = {name for tie in found.alternatives for name in tie.effects}
    named = {cause.effect for cause in found.causes}
    assert named <= {"hysteresis"} or "own_branches" in tied
    assert "a hysteresis that each log begins on a branch of its own" in found.summary
