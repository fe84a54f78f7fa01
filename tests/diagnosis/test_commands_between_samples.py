"""A command whose jumps a recorder sees as they come, or up to a sampling interval later.

A regulator follows a commanded pressure; one log is recorded in step with the controller, another
one by a recorder that runs beside it.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
import pytest

import softid
from softid.diagnosis_results import Diagnosis, Verdict
from softid.log import Log

Array = npt.NDArray[np.float64]

FINE_S = 5e-4
EACH = 20
"""Fine steps in a sampling interval of 10 ms."""

DURATION_S = 40.0
ATMOSPHERE_KPA = 101.325
NOISE_KPA = 0.5


def commanded(seed: int, *, in_step: bool) -> Array:
    """A command in kPa on the fine grid: levels, and now and then a sine."""
    rng = np.random.default_rng(seed)
    u = np.zeros(round(DURATION_S / FINE_S))
    at = round(2.0 / FINE_S)
    while at < u.size:
        u[at:] = rng.uniform(0.0, 180.0)
        at += round(rng.uniform(0.8, 2.5) / FINE_S)
        if rng.random() < 0.25:
            since_s = FINE_S * np.arange(min(round(4.0 / FINE_S), max(u.size - at, 0)))
            sine = np.sin(2.0 * np.pi * rng.uniform(0.3, 1.5) * since_s)
            u[at : at + since_s.size] = 90.0 + rng.uniform(20.0, 60.0) * sine
            at += since_s.size
    return np.repeat(u[::EACH], EACH) if in_step else u


def first_order(u: Array) -> Array:
    """τ ṗ = u − p with τ = 0.12 s."""
    return followed(u, lambda u, p: (u - p) / 0.12)


def late(u: Array) -> Array:
    """The same, 60 ms later and with τ = 0.1 s."""
    since = np.maximum(np.arange(u.size) - round(0.06 / FINE_S), 0)
    return followed(u[since], lambda u, p: (u - p) / 0.1)


def by_direction(u: Array) -> Array:
    """Filling with τ = 0.08 s, venting with 0.24 s."""
    return followed(u, lambda u, p: (u - p) / (0.08 if u > p else 0.24))


def by_level(u: Array) -> Array:
    """τ = 0.25 s exp(0.006/kPa (p − 75 kPa)): slower the fuller it is."""
    return followed(u, lambda u, p: (u - p) / (0.25 * float(np.exp(0.006 * (p - 75.0)))))


def through_a_valve(u: Array) -> Array:
    """ISO 6358 with τ = 0.35 s and b = 0.3."""

    def rate(u: float, p: float) -> float:
        high, low = max(u, p) + ATMOSPHERE_KPA, min(u, p) + ATMOSPHERE_KPA
        subsonic = max(low / high - 0.3, 0.0) / 0.7
        return float(np.sign(u - p)) * high * (1.0 - subsonic**2) ** 0.5 / 0.35

    return followed(u, rate)


def followed(u: Array, rate: object) -> Array:
    """The pressure on the fine grid, by Heun's rule."""
    assert callable(rate)
    p, found = float(u[0]), np.empty(u.size)
    for k, command in enumerate(u.tolist()):
        found[k] = p
        slope = rate(command, p)
        p += 0.5 * FINE_S * (slope + rate(command, p + FINE_S * slope))
    return found


LAWS = {f.__name__: f for f in (first_order, late, by_direction, by_level, through_a_valve)}


@cache
def recorded(law: str, seed: int, *, in_step: bool) -> Log:
    """A log of a law at 100 Hz."""
    u = commanded(seed, in_step=in_step)
    p = LAWS[law](u)[::EACH]
    p += NOISE_KPA * np.random.default_rng(seed + 1).standard_normal(p.size)
    channels = {"pressure_command": u[::EACH], "pressure": p}
    name, time_s = f"log{seed}", EACH * FINE_S * np.arange(p.size)
    return Log.from_arrays(
        time_s, channels, input="pressure_command", outputs=("pressure",), name=name
    )


def diagnosed(law: str, seed: int, *, fitted: bool, judges: bool) -> Diagnosis:
    """With one log to fit and one that judges, each in step with the controller or not."""
    log, judge = recorded(law, seed, in_step=fitted), recorded(law, seed + 1, in_step=judges)
    return softid.diagnose(log, hold_out=[judge], model="oscillator")


@pytest.mark.parametrize(
    ("fitted", "judges", "seed"),
    [
        pytest.param(True, False, 30, marks=pytest.mark.slow),
        (False, True, 40),
        *(
            pytest.param(fitted, judges, seed, marks=pytest.mark.slow)
            for fitted, judges in ((True, False), (False, True), (False, False), (True, True))
            for seed in range(100, 180, 20)
        ),
    ],
)
def test_nothing_is_wrong_with_a_lag(fitted: bool, judges: bool, seed: int) -> None:
    """Up to 10 ms are many times the noise beside a lag of 120 ms, and nobody knows them."""
    found = diagnosed("first_order", seed, fitted=fitted, judges=judges)
    assert found.verdict is Verdict.ADEQUATE, found.summary


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fitted", "judges", "seed"),
    [
        (False, False, 50),
        *(
            (fitted, judges, seed)
            for fitted, judges in ((True, False), (False, True), (False, False), (True, True))
            for seed in (200, 220)
        ),
    ],
)
def test_a_delay_is_found_between_samples(fitted: bool, judges: bool, seed: int) -> None:
    """Held at every sample, which makes up for a half of one, the delay would be less."""
    found = diagnosed("late", seed, fitted=fitted, judges=judges)
    assert [cause.effect for cause in found.causes] == ["delay"], found.summary
    (delay,) = found.causes[0].parameters
    assert delay.ci95 is not None
    assert delay.ci95[0] < 0.06 < delay.ci95[1]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [60, 300, 320, 340])
def test_moments_do_not_tell_two_laws_apart(seed: int) -> None:
    """Without inertia both are the same law, whatever the moments do to what they leave."""
    found = diagnosed("by_direction", seed, fitted=False, judges=False)
    tie = {name for group in found.alternatives for name in group.effects}
    assert {"pneumatic_lag", "asymmetric_damping"} <= tie, found.summary


@pytest.mark.slow
@pytest.mark.parametrize(
    ("in_step", "seed"),
    [(True, 70), (False, 360), (False, 380)],
)
def test_a_lag_by_level_is_no_mere_motion(in_step: bool, seed: int) -> None:
    """It takes the place of the base's own, and says what a damping that goes with it says, too."""
    found = diagnosed("by_level", seed, fitted=in_step, judges=in_step)
    (tie,) = found.alternatives
    assert tie.keys == ("pneumatic_lag.level", "position_damping"), found.summary
    (lag,) = found.causes
    u = recorded("by_level", seed, in_step=in_step).channels["pressure_command"].values
    in_the_middle_s = 0.25 * np.exp(0.006 * (0.5 * (u.min() + u.max()) - 75.0))
    assert lag.parameters[0].value == pytest.approx(in_the_middle_s, rel=0.02)


@pytest.mark.slow
def test_moments_do_not_move_the_numbers_of_a_valve() -> None:
    """Known truth: drawn straight, jumps are early for a law that gives way at once, and a fit to
    them makes b too large."""
    ratios, held = [], 0
    for seed in range(400, 500, 20):
        found = diagnosed("through_a_valve", seed, fitted=False, judges=False)
        assert [cause.effect for cause in found.causes] == ["valve_flow"], found.summary
        ratio = found.causes[0].parameters[1]
        assert ratio.ci95 is not None
        ratios.append(ratio.value)
        held += ratio.ci95[0] < 0.3 < ratio.ci95[1]
    assert np.mean(ratios) == pytest.approx(0.3, abs=0.05)
    assert held >= 3
