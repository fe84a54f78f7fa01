"""Friction that holds the actuator still, by a simulator of its own: off its equilibrium at rest.

The speed of a time step is what the other forces would give it, less what friction can take away;
where that is more, the actuator stands (Moreau's projection for set-valued friction).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import softid
from softid.diagnosis_results import Verdict
from softid.log import Log

Array = npt.NDArray[np.float64]

MASS, DAMPING, SPRING = 0.3, 9.0, 50.0
"""kPa·s²/rad, kPa·s/rad, kPa/rad."""

FRICTION_KPA, NOISE_RAD = 4.0, 0.005
PERIOD_S, FINE, BEFORE_S = 0.02, 40, 6.0


def held_motion(pressure: Array, step_s: float, friction: float) -> Array:
    """Position from rest at zero."""
    x = v = 0.0
    found = np.empty(pressure.size)
    most = step_s * friction / MASS
    for k, push in enumerate(pressure.tolist()):
        found[k] = x
        v = (v + step_s * (push - SPRING * x) / MASS) / (1.0 + step_s * DAMPING / MASS)
        v = max(abs(v) - most, 0.0) * (1.0 if v > 0.0 else -1.0)
        x += step_s * v
    return found


def dry_log(course: str, seed: int, *, friction: float = FRICTION_KPA) -> Log:
    """A log that begins with a rest at which an earlier pressure has left it stuck."""
    rng = np.random.default_rng(seed)
    knots_s = PERIOD_S * np.cumsum(rng.integers(30, 125, 40))
    levels = rng.uniform(10.0, 100.0, 40)
    first = levels[0] = 40.0

    def pressure(at_s: Array) -> Array:
        if course == "steps":
            return levels[np.searchsorted(knots_s, at_s + 1e-9)]
        return np.interp(at_s, np.concatenate(([0.0], knots_s)), np.append(levels[0], levels))

    samples, before = 2000, round(BEFORE_S / PERIOD_S)
    fine_s = PERIOD_S / FINE * np.arange((samples + before) * FINE) - BEFORE_S
    earlier = np.where(fine_s < -0.5 * BEFORE_S, 80.0 if seed % 2 else 5.0, first)
    driven = np.where(fine_s < 0.0, earlier, pressure(fine_s))
    angle = held_motion(driven, PERIOD_S / FINE, friction)[before * FINE :: FINE]
    time_s = PERIOD_S * np.arange(samples)
    angle += NOISE_RAD * rng.standard_normal(samples)
    channels = {"pressure": pressure(time_s), "angle": angle}
    return Log.from_arrays(time_s, channels, name=f"{course}-{seed}")


@pytest.mark.parametrize(
    ("course", "seed"),
    [
        ("steps", 1),
        ("ramps", 1),
        pytest.param("ramps", 2, marks=pytest.mark.slow),
        pytest.param("steps", 2, marks=pytest.mark.slow),
    ],
)
def test_it_is_found_where_it_rests_off_its_equilibrium(course: str, seed: int) -> None:
    """Fc within 3 %, and noise alone is left, of the rest at the beginning, too."""
    judge = dry_log(course, seed + 21)
    found = softid.diagnose(dry_log(course, seed), hold_out=[judge], model="oscillator")
    assert found.verdict is Verdict.NAMED, found.summary
    assert [cause.effect for cause in found.causes] == ["coulomb_friction"]
    assert found.extended is not None
    Fc = found.extended.parameter("coulomb_friction_Fc")
    assert Fc.value == pytest.approx(FRICTION_KPA, rel=0.03)
    for row in found.extended.statistics:
        assert row.rmse == pytest.approx(NOISE_RAD, rel=0.08)


@pytest.mark.parametrize("seed", [1, 2])
def test_without_friction_it_begins_at_its_equilibrium(seed: int) -> None:
    log, judge = (dry_log("steps", at, friction=0.0) for at in (seed, seed + 21))
    found = softid.diagnose(log, hold_out=[judge], model="oscillator")
    assert found.verdict is Verdict.ADEQUATE, found.summary
