"""Whether the size of a cause is the same throughout, on logs of which that is known."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import (
    RATE_HZ,
    SIGMA,
    TRUTH,
    Bow,
    Gain,
    linear_angle,
    linear_log,
    linear_problem,
    pressure_course,
    standing,
)
from noise import ar1

from softid.diagnosis.refit.candidates import Candidate, advance, prior_about
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.residual import parameter_constancy
from softid.diagnosis.residual.input_noise import unknown_input
from softid.diagnosis.residual.parameter_constancy import FALSE_ALARM_RATE, _judged, variations
from softid.diagnosis_results import Variation
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.identification.gauge_errors import gauge_errors
from softid.identification.input_denoising import without_input_noise
from softid.log import Log

Array = npt.NDArray[np.float64]

N = 1000
TIME_S = np.arange(N) / RATE_HZ
PRESSURE = pressure_course(TIME_S)
ANGLE = linear_angle(TIME_S, PRESSURE)
NOISE = 0.01
SIZE = 0.2
"""1/rad; the angle reaches more than a radian, so that is twenty times the noise and more."""


def slow_noise(seed: int) -> Array:
    """Noise whose neighbours are alike."""
    return NOISE * ar1(np.random.default_rng(seed), N, 0.9)


def fitted(logs: list[Log], effect: Effect) -> Candidate:
    """The oscillator with an effect, at its optimum."""
    base = linear_problem(logs)
    z = base.unknowns(TRUTH)
    scale = scale_of(base, z)
    problem = extend(base, [effect], scale)
    start = start_unknowns(problem, base, z, {f"{effect.name}_c": SIZE})
    begun = standing(problem, start)
    variance = begun.squares / problem.n_samples
    begun = Candidate(
        (effect,), problem, begun.minimum, prior_about(problem, start, base.free, variance)
    )
    return advance(begun, SIGMA, 60, tolerance=1e-4)


@dataclass(frozen=True)
class Curved(Bow):
    """A nonlinear reading, + c y²: no linear motion can mimic it."""

    name: ClassVar[str] = "curved"

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Bend the line."""
        del time_s, scale
        curved: Array = y + eta[0] * y**2
        return curved


def log_of(size: Array | float, seed: int, noise: Array | None = None) -> Log:
    """A log of a nonlinear reading, whose size may vary with the time."""
    own = NOISE * np.random.default_rng(seed).normal(size=N) if noise is None else noise
    return linear_log(added=size * ANGLE**2 + own, seed=seed)


def found_in(*logs: Log) -> Variation | None:
    (told,) = variations(fitted(list(logs), Curved()), [Curved()], SIGMA)
    return told


@pytest.mark.parametrize("slow", [False, True])
def test_a_constant_size_does_not_vary(slow: bool) -> None:
    """Sixty logs; chance explains a finding with odds of four in ten thousand each."""
    for seed in range(60):
        assert found_in(log_of(SIZE, seed, slow_noise(seed) if slow else None)) is None


@pytest.mark.parametrize("slow", [False, True])
def test_the_p_value_is_that_of_chance(slow: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """At a level of 5 % for each of four variables, 5 to 19 % of logs seem to vary.

    That is 6 to 22 of 120; fewer than 2 or more than 33 have odds below 2 % at either end.
    """
    monkeypatch.setattr(parameter_constancy, "FALSE_ALARM_RATE", 0.05)
    monkeypatch.setattr(parameter_constancy, "NOTABLE_VARIATION", -1.0)
    found = [
        found_in(log_of(SIZE, seed, slow_noise(seed) if slow else None)) for seed in range(100, 220)
    ]
    assert 2 <= sum(told is not None for told in found) <= 33


@pytest.mark.parametrize("change", [0.3, -0.6])
def test_a_size_that_jumps_is_found_with_its_spread(change: float) -> None:
    """One half at 1 + c times the mean and one at 1 − c: a standard deviation of c.

    Hat functions follow a jump over one of five pieces, so they reach about nine tenths of it. The
    base mimics most of a parabola, so what it cannot do is small beside that.
    """
    told = found_in(log_of(SIZE * np.where(TIME_S > 10.0, 1.0 + change, 1.0 - change), 1))
    assert told is not None
    assert told.by == "t"
    assert told.chance < FALSE_ALARM_RATE
    assert 0.7 * abs(change) < told.spread < 1.2 * abs(change)
    assert told.share > told.spread**2


def test_a_variation_counts_in_what_is_left() -> None:
    """Twice the residual with four times its variance is the same chance, of twice the spread."""
    rng = np.random.default_rng(0)
    asked = np.linalg.qr(rng.standard_normal((500, 3)))[0]
    left = rng.standard_normal(500) + asked @ np.array([20.0, -15.0, 8.0])
    further = float(np.sum((asked.T @ left) ** 2))
    one, other = (_judged("t", 3, (further, 0.0), of**2, 1000.0, 500.0) for of in (1.0, 2.0))
    assert one is not None
    assert other is not None
    assert other.chance == pytest.approx(one.chance)
    assert other.spread == pytest.approx(2.0 * one.spread)
    assert other.share == pytest.approx(4.0 * one.share)


def test_noise_of_a_gauge_is_no_variation() -> None:
    """The angle bends with the square of a pressure that is read with noise, and nothing varies.

    What the noise leaves is large where the motion is quick. Draws of it keep a size that doubles.
    """
    rng = np.random.default_rng(3)
    found = []
    for size in (SIZE, SIZE * np.where(TIME_S > 10.0, 1.5, 0.5)):
        whole = log_of(size, 3, 1e-3 * rng.standard_normal(N))
        values = PRESSURE + 3.0 * rng.standard_normal(N)
        read = replace(whole.channels["pressure"], values=values)
        noisy = replace(whole, channels={**whole.channels, "pressure": read})
        model = fitted([without_input_noise(noisy)], Curved())
        draws = unknown_input(model, {whole.name: gauge_errors(noisy)}, 1e-6)
        for unsure in (None, draws):
            (told,) = variations(model, [Curved()], SIGMA, unsure=unsure)
            found.append(told)
    assert found[0] is not None
    assert found[1] is None
    assert found[2] is not None
    assert found[3] is not None


def test_the_variable_is_told() -> None:
    """A cube in place of a square is a size that grows with the position."""
    told = found_in(log_of(2.0 * SIZE * ANGLE / ANGLE.max(), 2))
    assert told is not None
    assert told.by in ("x", "p")


def test_logs_that_differ_in_size_are_told() -> None:
    """Each is constant in itself: the time is looked at log by log."""
    told = found_in(log_of(0.7 * SIZE, 3), log_of(1.3 * SIZE, 4))
    assert told is not None
    assert told.by == "t"
    assert told.spread == pytest.approx(0.3, rel=0.2)


def test_a_small_variation_is_the_materials_own() -> None:
    """What it takes away is less than 0.5 % of what the cause does, however sure it is."""
    for change, is_told in ((0.002, False), (0.05, True)):
        size = 10.0 * SIZE * np.where(TIME_S > 10.0, 1.0 + change, 1.0 - change)
        assert (found_in(log_of(size, 5)) is not None) is is_told


def test_what_the_base_can_do_has_no_size() -> None:
    """A gain of the sensor is one of the stiffness: its size means nothing, nor does its course."""
    log = linear_log(added=np.where(TIME_S > 10.0, 0.4, 0.1) * ANGLE, noise=NOISE)
    assert variations(fitted([log], Gain()), [Gain()], SIGMA) == (None,)


def test_gaps_and_lost_samples() -> None:
    """Residuals are made white run by run; a log with holes has no other answer."""
    angle = log_of(SIZE, 6).channels["angle"].values.copy()
    angle[200:240] = np.nan
    angle[700:705] = np.nan
    log = Log.from_arrays(TIME_S, {"pressure": PRESSURE, "angle": angle})
    assert found_in(log) is None
    jumped = log_of(SIZE * np.where(TIME_S > 10.0, 1.5, 0.5), 6).channels["angle"].values
    angle = np.where(np.isfinite(angle), jumped, np.nan)
    log = Log.from_arrays(TIME_S, {"pressure": PRESSURE, "angle": angle})
    told = found_in(log)
    assert told is not None
    assert told.by == "t"
