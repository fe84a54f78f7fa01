"""Whether the error on what is held out is one that noise and unsure parameters make."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from handmade_diagnosis import remainder
from linear_motion import (
    RATE_HZ,
    SIGMA,
    TRUTH,
    linear_angle,
    linear_log,
    linear_problem,
    standing,
)
from scipy.signal import sawtooth

from softid.diagnosis.refit.candidates import BASE_SD, Candidate
from softid.diagnosis.refit.held_out import HeldOut, HeldOutLogs, hold_out_blocks
from softid.diagnosis.search.forward_selection import converged
from softid.diagnosis.verdict.held_out_error import (
    held_out_responses,
    parametric_power,
    with_held_out,
)
from softid.diagnosis_results import Remainder
from softid.effects import effect_of
from softid.fitters.problem import Problem
from softid.identification.gauge_errors import GaugeErrors
from softid.identification.input_denoising import without_input_noise
from softid.log import Log, LogSet
from softid.models import Oscillator

NOISE = 0.02
GAUGE = 6.0
"""Noise of a gauge, kPa."""

SLOW_GAUGE = 2.0
"""That of a slow log, kPa."""

LEFT = replace(remainder(structured=False, explained=1.0), rms=NOISE, excess=0.0)


def fitted(seed: int, samples: int = 400) -> Candidate:
    """The linear actuator fitted to a short log, so that its parameters are unsure."""
    problem = linear_problem([linear_log(noise=NOISE, seed=seed, samples=samples)])
    return converged(standing(problem, problem.unknowns(TRUTH)), SIGMA)


def fast_log(*, noise: float = 0.0, gain: float = 1.0, seed: int = 100) -> Log:
    """A chirp from 0.2 to 5 Hz, which asks for the inertia as the fitted logs do not."""
    time_s = np.arange(1000) / RATE_HZ
    pressure = 50.0 + 40.0 * np.sin(2.0 * np.pi * (0.2 + 0.12 * time_s) * time_s)
    pressure[:25] = 50.0
    trembling = noise * np.random.default_rng(seed).standard_normal(time_s.size)
    angle = gain * linear_angle(time_s, pressure - 50.0) + trembling
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}, name="fast")


def test_the_errors_of_the_parameters_are_foretold() -> None:
    """Known truth: over 40 noises, what fits miss of a log without noise is what is expected.

    About four parameters make each error, so the mean over 40 is known to a sixth.
    """
    judge = HeldOutLogs((fast_log(),))
    models = [fitted(seed) for seed in range(40)]
    reached = float(np.mean([judge.rms(model) ** 2 for model in models]))
    foretold = float(np.mean([parametric_power(model, judge, SIGMA) for model in models]))
    assert foretold == pytest.approx(reached, rel=0.5)
    assert foretold > 0.0


def slow_log(seed: int, truth: Mapping[str, float]) -> Log:
    """Two periods of a triangle of 15 s, with noise on both channels."""
    time_s, rng = np.arange(1500) / RATE_HZ, np.random.default_rng(seed)
    pressure = 40.0 + 40.0 * sawtooth(2.0 * np.pi * time_s / 15.0, 0.5)
    angle = linear_angle(time_s, pressure, truth) + NOISE * rng.standard_normal(time_s.size)
    gauge = pressure + SLOW_GAUGE * rng.standard_normal(time_s.size)
    return Log.from_arrays(time_s, {"pressure": gauge, "angle": angle}, name="slow")


def test_noise_of_a_gauge_foretells_nothing_of_a_fast_log() -> None:
    """Known truth: over 16 noises, what slow logs miss of a chirp is many times what is expected if
    all counts that the model does with the noise of the gauge, and of the size that is expected
    without; the latter is known to a factor, for the noise moves the inertia by far."""
    truth = {"M": 0.4, "N": 3.0, "Q": 50.0}
    time_s = np.arange(1000) / RATE_HZ
    pressure = 40.0 - 40.0 * np.cos(2.0 * np.pi * (0.1 + 0.04 * time_s) * time_s)
    channels = {"pressure": pressure, "angle": linear_angle(time_s, pressure, truth)}
    log = Log.from_arrays(time_s, channels, name="fast")
    plain = HeldOutLogs((log,))
    judge = HeldOutLogs((log,), {"slow": GaugeErrors(SLOW_GAUGE)})
    reached, counted, foretold = [], [], []
    for seed in range(16):
        problem = linear_problem([without_input_noise(slow_log(seed, truth))])
        model = converged(standing(problem, problem.unknowns(truth)), SIGMA)
        reached.append(plain.rms(model) ** 2)
        counted.append(parametric_power(model, plain, SIGMA))
        foretold.append(parametric_power(model, judge, SIGMA))
    assert np.mean(counted) < 0.2 * np.mean(reached)
    assert 0.2 * np.mean(reached) < np.mean(foretold) < 5.0 * np.mean(reached)


def test_what_the_logs_do_not_hold_is_known_to_a_factor() -> None:
    """Closed form: pressure at rest holds no inertia, which a chirp asks for: P = 1.5² in log M."""
    time_s = np.arange(600) / RATE_HZ
    still = {"pressure": np.full(600, 50.0), "angle": np.full(600, 1.0)}
    problem = linear_problem([Log.from_arrays(time_s, still, name="still")])
    model = standing(problem, problem.unknowns(TRUTH))
    judge = HeldOutLogs((fast_log(),))
    found = parametric_power(model, judge, SIGMA)
    slopes = judge.slopes(model)
    most = BASE_SD**2 * float(np.mean(np.sum(slopes**2, axis=1)))
    assert np.isfinite(found)
    assert 0.0 < found <= 3.0 * most


def told_of(left: Remainder, model: Candidate, held_out: HeldOut) -> Remainder:
    """What is told where the first model is the last one."""
    return with_held_out(left, held_out.rms(model), model, held_out, SIGMA)


@pytest.mark.parametrize(
    ("judge", "misses"),
    [
        (fast_log(noise=NOISE), False),
        (fast_log(noise=2.0 * NOISE), False),
        (fast_log(noise=5.0 * NOISE), False),
        (fast_log(noise=NOISE, gain=1.3), True),
    ],
)
def test_what_is_missed(judge: Log, misses: bool) -> None:
    """Known truth: the same actuator, the same with a noisier sensor, and a sensor that is off."""
    model = fitted(seed=3)
    told = told_of(LEFT, model, HeldOutLogs((judge,)))
    assert told.misses_held_out is misses
    assert told.leaves_something is misses


def test_a_noisy_gauge_of_what_is_held_out_is_no_miss() -> None:
    """Known truth: the actuator follows the pressure that was there, the simulation the recorded
    one; that the gauge has noise must be known."""
    model, log = fitted(seed=3), fast_log(noise=NOISE)
    gauge = replace(log.channels["pressure"], values=log.pressure_kpa + GAUGE * trembling(1000))
    noisy = without_input_noise(replace(log, channels={**log.channels, "pressure": gauge}))
    assert told_of(LEFT, model, HeldOutLogs((noisy,))).misses_held_out
    errors = {"fast": GaugeErrors(GAUGE)}
    assert not told_of(LEFT, model, HeldOutLogs((noisy,), errors)).misses_held_out
    off = fast_log(noise=NOISE, gain=1.6)
    off = replace(off, channels={**off.channels, "pressure": noisy.channels["pressure"]})
    assert told_of(LEFT, model, HeldOutLogs((off,), errors)).misses_held_out


def trembling(samples: int) -> np.ndarray:
    return np.random.default_rng(5).standard_normal(samples)


def test_noise_that_is_hardly_known_misses_later() -> None:
    """Slow noise knows its variance to a third: four times its power may be chance."""
    model = fitted(seed=3)
    judge = HeldOutLogs((linear_log(noise=NOISE, seed=50),))
    rms = judge.rms(model) / 1.9

    def told(noise_sd: float) -> Remainder:
        left = replace(LEFT, rms=rms, excess=0.0, noise_sd=noise_sd)
        return told_of(left, model, Smooth(judge.logs))

    assert told(0.02).misses_held_out
    assert not told(0.5).misses_held_out


class Smooth(HeldOutLogs):
    """Logs whose error has no fast part, and whose parameters are known."""

    def runs(self, candidate: Candidate) -> list[np.ndarray]:
        """The error that there is, without trembling."""
        return [np.full(100, self.rms(candidate))]

    def slopes(self, candidate: Candidate) -> np.ndarray:
        """Nothing that follows a parameter."""
        return np.zeros((100, len(candidate.problem.free)))


def test_blocks_between_fitted_samples_ask_little_of_the_parameters() -> None:
    """They move as what is around them does: of white noise P/n, three or four thousandths."""
    trained, held = hold_out_blocks(LogSet((linear_log(noise=NOISE),)))
    problem = linear_problem(trained.logs)
    model = converged(standing(problem, problem.unknowns(TRUTH)), SIGMA)
    assert 0.0 < parametric_power(model, held, SIGMA) < 0.01 * NOISE**2
    assert not told_of(LEFT, model, held).misses_held_out


class RunningAway(HeldOutLogs):
    """Logs on which every model diverges."""

    def runs(self, candidate: Candidate) -> list[np.ndarray]:
        """The residuals, of which the last is beyond all numbers."""
        runs = super().runs(candidate)
        runs[-1][-1] = 1e200
        return runs


def test_what_runs_away_on_what_is_held_out_misses_it() -> None:
    """A share of nothing, rather than of all."""
    told = with_held_out(LEFT, 1.0, fitted(seed=3), RunningAway((fast_log(noise=NOISE),)), SIGMA)
    assert told.misses_held_out
    assert told.held_out_share == 0.0


class Unsure(HeldOutLogs):
    """Logs that ask for what the fitted ones hardly know."""

    def slopes(self, candidate: Candidate) -> np.ndarray:
        """A hundred times those that there are."""
        return 100.0 * super().slopes(candidate)


@pytest.mark.parametrize(
    ("colour_s", "has_cause", "misses"),
    [(None, True, False), (3.0, True, True), (None, False, True)],
    ids=["a cause", "slow noise", "no cause"],
)
def test_unsure_parameters_are_no_excuse_for_all(
    colour_s: float | None, has_cause: bool, misses: bool
) -> None:
    """A sensor that is off by 30 % may be the errors of parameters, which are that unsure.

    Not so where what is left of the fitted samples is itself said to be slow noise that no rest
    shows, nor where a model without causes would be called adequate.
    """
    judge = Unsure((fast_log(noise=NOISE, gain=1.3),))
    model = replace(fitted(seed=3), effects=(effect_of("delay"),) if has_cause else ())
    told = told_of(replace(LEFT, colour_s=colour_s), model, judge)
    assert told.misses_held_out is misses


class Grounded(Oscillator):
    """The linear actuator, whose sensor has no zero of its own."""

    own_zero: ClassVar[bool] = True


def stepped_log(name: str) -> Log:
    """A command from rest that jumps by 0.3 of an interval after a sample, and the exact answer."""
    fine, time_s = 10, np.arange(600) / RATE_HZ
    fine_s = np.arange(6000) / (fine * RATE_HZ)
    levels = np.array([0.0, 60.0, 20.0, 80.0, 40.0, 70.0])
    pressure = np.repeat(levels, 1000)
    late = np.concatenate((np.zeros(3), pressure[:-3]))
    angle = linear_angle(fine_s, late)[::fine]
    channels = {"pressure": late[::fine], "angle": angle}
    return Log.from_arrays(time_s, channels, name=name)


def test_moments_of_jumps_are_opened_without_zeros_and_initial_states() -> None:
    """Known truth: a model that has no unknown of a log but the moments, which explain what is
    left; a jump that is drawn over an interval is off by a part of it."""
    model = Grounded(x_unit="rad", u_unit="kPa")
    declared = model.parameters().with_values(TRUTH)
    problem = Problem(model, declared, [stepped_log("fitted")])
    fit = standing(problem, problem.unknowns(TRUTH))
    judge = HeldOutLogs((stepped_log("other"),))
    judged = judge.standing(fit)
    assert judged.problem.size == len(judged.problem.free)
    assert np.isfinite(parametric_power(fit, judge, SIGMA))
    responses = held_out_responses(fit, judged, 1e-6)
    assert responses is not None
    opened = responses.opened(1e-6)
    assert opened.count == 5
    left = np.concatenate([part.residual for part in opened.parts])
    assert float(np.nanmean(left**2)) < 0.01 * judge.rms(fit) ** 2
