"""A muscle that effects are added to: its sizes, what drives it, and a check of derivatives."""

from __future__ import annotations

import numpy as np

from softid.effects import EFFECTS, Effect, ExtendedModel, Scale
from softid.log import Log
from softid.models.muscle import Muscle
from softid.segment import Segment

SCALE = Scale(
    u_low=0.0,
    u_high=150.0,
    x_low=0.3,
    x_high=1.8,
    v_max=5.0,
    force=3.0,
    y_low=0.3,
    y_high=1.8,
    period_s=0.01,
    duration_s=12.0,
    motion_s=0.2,
    travel=10.0,
    x_unit="rad",
    y_unit="rad",
)
CORNERS_S = (0.0, 0.5, 0.52, 3.0, 3.02, 5.0, 8.0, 8.5, 10.0, 12.0)
LEVELS_KPA = (0.0, 0.0, 140.0, 140.0, 60.0, 60.0, 120.0, 10.0, 10.0, 80.0)
THETA = np.array([0.02, 0.5, 2.8, 2.5, 0.1, 1.8, 0.7])
"""A muscle with a time constant of about 0.2 s and a motion from 0.3 to 1.8 rad."""


def pressure(time_s: np.ndarray) -> np.ndarray:
    """Steps up and down, ramps and holds."""
    return np.interp(time_s, CORNERS_S, LEVELS_KPA)


def times(sampling: str) -> np.ndarray:
    """100 Hz, 50 Hz, or intervals that vary between 4 and 16 ms."""
    if sampling == "irregular":
        steps = np.random.default_rng(5).uniform(0.004, 0.016, 1200)
        inner = np.cumsum(steps)
        return np.concatenate(([0.0], inner[inner < 12.0]))
    return np.arange(0.0, 12.0, 0.01 if sampling == "100 Hz" else 0.02)


def segment(sampling: str = "100 Hz") -> Segment:
    """A log's only segment."""
    time_s = times(sampling)
    channels = {"pressure": pressure(time_s), "angle": np.zeros(time_s.size)}
    (found,) = Log.from_arrays(time_s, channels, units={"angle": "rad"}, name="rig").segments()
    return found


def extended(*keys: str) -> tuple[ExtendedModel, np.ndarray]:
    """The muscle with effects at their moderate values, and its parameter vector."""
    effects: tuple[Effect, ...] = tuple(EFFECTS[key]() for key in keys)
    model = ExtendedModel(Muscle(), effects, SCALE)
    theta = np.array([p.value for p in model.parameters().values()])
    theta[: THETA.size] = THETA
    theta[THETA.size :] *= 1.037  # off any multiple of the sampling interval
    return model, theta


def fine_times() -> np.ndarray:
    """Irregular times, as fine as those that an input effect is given."""
    steps = np.random.default_rng(6).uniform(1e-4, 2e-3, 12_000)
    inner = np.cumsum(steps)
    return np.concatenate(([0.0], inner[inner < 12.0]))


def response(model: ExtendedModel, theta: np.ndarray, s: Segment) -> np.ndarray:
    """The simulated angle."""
    found = model.response(theta, s, ("angle",), start=None, derivatives=False)
    return found.outputs["angle"]


def jacobian_error(
    model: ExtendedModel, theta: np.ndarray, s: Segment, *, step: float = 1e-5
) -> float:
    """Largest difference between the model's derivatives and central ones.

    The plan is held still, as an optimiser does. Each column counts in its own largest entry, but
    one that moves the angle by less than 1e-6 rad over its parameter's whole size is rounding. A
    parameter that is zero counts as a tenth of its unit.
    """
    plan = model.plan(theta, s)
    found = model.response(theta, s, ("angle",), start=None, derivatives=True, plan=plan)
    assert found.by_parameter is not None
    worst = 0.0
    for k in range(theta.size):
        own = abs(theta[k]) or 0.1
        h = step * own
        sides = []
        for sign in (1.0, -1.0):
            moved = theta.copy()
            moved[k] += sign * h
            told = model.response(moved, s, ("angle",), start=None, derivatives=False, plan=plan)
            sides.append(told.outputs["angle"])
        central = (sides[0] - sides[1]) / (2.0 * h)
        size = max(np.max(np.abs(central)), 1e-6 / own)
        worst = max(
            worst, float(np.max(np.abs(found.by_parameter["angle"][:, k] - central)) / size)
        )
    return worst
