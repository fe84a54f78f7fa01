"""Terms that no sample shows are dropped, and what that leaves unknown of the others is told."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import RATE_HZ, linear_angle
from scipy.signal import chirp, lsim

from softid import Log, fit
from softid.models import Oscillator

MASS, DAMPING = 0.4, 10.0

TRUTH = {"M": 1.3, "N": 6.4, "Q": 170.0}
NOISE = 0.005
SLOW_HZ = 0.1
TIME_S = np.arange(40 * RATE_HZ) / RATE_HZ
PRESSURE = 40.0 - 40.0 * np.cos(2.0 * np.pi * SLOW_HZ * TIME_S)


def drive_log(stiffness: float) -> Log:
    """Half a minute of a mass that a force pushes about, on a spring, with 0.2 % of noise."""
    time_s = 0.02 * np.arange(1500)
    force = np.repeat(np.random.default_rng(1).uniform(-50.0, 50.0, 30), 50) - 3.0
    system = ([1.0], [MASS, DAMPING, stiffness])
    _, position, _ = lsim(system, force, time_s, interp=False)
    noise = 0.002 * np.ptp(position) * np.random.default_rng(2).standard_normal(time_s.size)
    channels = {"force": force, "position": position + noise}
    log = Log.from_arrays(time_s, channels, input="force", outputs=["position"])
    return log.with_intersample("zoh")


def test_a_spring_that_comes_too_late_for_the_log_is_none() -> None:
    """Known truth without a spring: it is dropped from the model that has one, and told; the mean
    force, which a spring would have to hold, is an offset then."""
    found = fit(drive_log(0.0), model="oscillator")
    assert found.model.options["spring"] == "none"
    stiffness = found.parameter("Q")
    assert (stiffness.value, stiffness.verdict) == (0.0, "not identified")
    assert "the motion would come back in" in stiffness.reason
    assert found.parameter("N").value == pytest.approx(DAMPING, rel=0.02)
    assert abs(found.parameter("offset").value) < 0.2


def test_a_spring_that_shows_stays() -> None:
    """It would bring the motion back in five lengths of the log, and is found to a tenth."""
    truth = DAMPING / 150.0
    found = fit(drive_log(truth), model="oscillator")
    assert found.model.options["spring"] == "linear"
    assert found.parameter("Q").value == pytest.approx(truth, rel=0.1)


def test_a_spring_that_the_user_holds_stays() -> None:
    """A fixed stiffness is no free term that could be dropped."""
    model = Oscillator(x_unit="mm", u_unit="N")
    held = model.parameters().with_values({"Q": 1e-3}).with_fixed({"Q": 1e-3})
    found = fit(drive_log(0.0), model="oscillator", parameters=held)
    assert found.parameter("Q").value == 1e-3
    assert found.model.options["spring"] == "linear"


def test_an_inertia_shows_between_slow_readings_where_the_input_moves_there() -> None:
    """Known truth: it swings at 4.1 Hz, and a gauge takes five readings a second of what a chirp of
    0.2 to 6 Hz makes it do. Without the inertia four times as much would be left."""
    time_s = 0.01 * np.arange(4800)
    pressure = 100.0 + 80.0 * chirp(time_s, 0.2, time_s[-1], 6.0)
    stiffness, damping, mass = 4.7, 0.23, 0.0072
    _, moved, _ = lsim(([1.0], [mass, damping, stiffness]), pressure, time_s)
    noise = 0.28 * np.random.default_rng(3).standard_normal(240)
    channels = {"pressure": pressure, "contraction": np.repeat(moved[::20] + noise, 20)}
    found = fit(Log.from_arrays(time_s, channels), model="oscillator")
    for name, truth in {"M": mass, "N": damping, "Q": stiffness}.items():
        assert found.parameter(name).value == pytest.approx(truth, rel=0.1)
    assert found.parameter("M").verdict == "identified"


def slow_log(seed: int) -> Log:
    """Four periods of a sine that begins at rest, far below the natural frequency of 1.8 Hz."""
    angle = linear_angle(TIME_S, PRESSURE, TRUTH)
    angle += NOISE * np.random.default_rng(seed).standard_normal(TIME_S.size)
    return Log.from_arrays(TIME_S, {"pressure": PRESSURE, "angle": angle}, name=f"slow-{seed}")


def stiffness_error(names: tuple[str, ...]) -> float:
    """Standard deviation of Q in least squares of some parameters and a zero, at a small inertia.

    By the columns of a linear model that scipy solves, which are differences of two motions.
    """
    columns = [np.ones_like(TIME_S)]
    for name in names:
        motions = [
            linear_angle(TIME_S, PRESSURE, small | {name: small[name] + change})
            for small in [TRUTH | {"M": 0.01}]
            for change in (1e-4, -1e-4)
        ]
        columns.append((motions[0] - motions[1]) / 2e-4)
    rows = np.column_stack(columns)
    return NOISE * float(np.linalg.inv(rows.T @ rows)[-1, -1] ** 0.5)


def test_the_stiffness_is_as_sure_as_it_is_with_an_inertia() -> None:
    """A slow sine follows Q − Mω²: with M left out Q is off by that, and its interval holds it."""
    drawn = [fit(slow_log(seed), model="oscillator") for seed in range(12)]
    without = [found for found in drawn if "M" not in found.free]
    assert len(without) >= 3
    alone, beside = stiffness_error(("N", "Q")), stiffness_error(("M", "N", "Q"))
    assert beside > 10.0 * alone
    for stiffness in (found.parameter("Q") for found in without):
        assert stiffness.stderr == pytest.approx(beside, rel=0.1)
        low, high = stiffness.ci95
        assert low < TRUTH["Q"] < high
        assert abs(stiffness.value - TRUTH["Q"]) > 1.96 * alone


def test_a_model_that_was_named_without_a_term_has_none() -> None:
    """Who says that there is no inertia knows the stiffness to what the sine tells of it."""
    found = fit(slow_log(0), model=Oscillator(order="first"))
    assert found.parameter("Q").stderr == pytest.approx(stiffness_error(("N", "Q")), rel=0.1)


def light_log(seed: int) -> Log:
    """72 s of an arm without a visible inertia under noise of 1 s, which hides where it begins."""
    rng, time_s = np.random.default_rng(seed), np.arange(0.0, 72.0, 0.02)
    levels = np.random.default_rng(7).uniform(0.0, 100.0, 21)
    pressure = np.concatenate((np.repeat(levels, 100), np.zeros(1500)))
    angle = lsim(([1.0], [31.0, 145.0]), pressure, time_s, interp=False)[1]
    noise, kept = np.empty(time_s.size), float(np.exp(-0.02))
    noise[0] = rng.standard_normal()
    for k in range(1, noise.size):
        noise[k] = kept * noise[k - 1] + np.sqrt(1.0 - kept**2) * rng.standard_normal()
    return Log.from_arrays(
        time_s,
        {"pressure": pressure, "angle": angle + 0.006 * noise},
        outputs=("angle",),
        units={"angle": "rad"},
    ).with_intersample("held")


def test_a_start_that_is_lost_at_once_says_nothing_of_the_others() -> None:
    """Errors beside an inertia that no sample shows are those of repeated logs, within a factor of
    two: an initial velocity that its inertia loses at once stays lost."""
    fits = [fit(light_log(seed), model="oscillator") for seed in range(12)]
    for name in ("N", "Q"):
        values = [found.parameter(name).value for found in fits]
        told = [found.parameter(name).stderr for found in fits]
        assert 0.5 < np.median(told) / np.std(values, ddof=1) < 2.0
    assert all(found.parameter("M").value == 0.0 for found in fits)
