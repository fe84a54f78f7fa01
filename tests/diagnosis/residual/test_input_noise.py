"""What the noise of a pressure gauge leaves of a true model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import TRUTH, linear_angle, linear_problem, pressure_course, standing

from softid.diagnosis import diagnose
from softid.diagnosis.refit.candidates import BASE_SD, Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.report.issues import FAST_INPUT
from softid.diagnosis.report.timing import UNCERTAIN_TIMES
from softid.diagnosis.residual.assessment import assess
from softid.diagnosis.residual.input_noise import (
    InputNoise,
    input_noise,
    moved_parameters,
    takes_input_noise_at_most,
    unknown_input,
)
from softid.diagnosis.residual.noise_floor import NoiseFloor
from softid.diagnosis.search.forward_selection import converged
from softid.diagnosis_results import Verdict
from softid.identification.gauge_errors import GaugeErrors, gauge_errors
from softid.identification.input_denoising import without_input_noise
from softid.log import Log
from softid.synthesis import hidden_pair
from softid.synthesis.rig import Rig

SD_KPA = 3.0


def gauged(seed: int) -> Log:
    """A log of the linear actuator whose pressure is read with noise, and whose angle is exact."""
    time_s = np.arange(3000) / 50.0
    pressure = pressure_course(time_s)
    noisy = pressure + SD_KPA * np.random.default_rng(seed).standard_normal(time_s.size)
    angle = linear_angle(time_s, pressure)
    return Log.from_arrays(time_s, {"pressure": noisy, "angle": angle}, name="gauged")


def at_the_truth(log: Log) -> Candidate:
    problem = linear_problem((without_input_noise(log),))
    return standing(problem, problem.unknowns(TRUTH))


def test_an_exact_input_leaves_nothing() -> None:
    assert input_noise(at_the_truth(gauged(0)), {"gauged": GaugeErrors()}, 1.0) is None
    assert input_noise(at_the_truth(gauged(0)), {}, 1.0) is None


def test_it_is_as_large_as_what_noise_leaves() -> None:
    """Known truth: the angle is exact, so what its own model leaves is the noise of the pressure.

    Five logs hold some 5 × 60 s / 0.4 s independent values: their mean square is known to 5 %.
    """
    left, drawn = [], []
    for seed in range(5):
        log = gauged(seed)
        model = at_the_truth(log)
        (block,) = model.problem.blocks(model.minimum.point, derivatives=False)
        found = input_noise(model, {"gauged": gauge_errors(log)}, 1.0)
        assert found is not None
        left.append(float(np.mean((block.residual - block.residual.mean()) ** 2)))
        drawn.append(found.variance)
    assert np.mean(drawn) == pytest.approx(np.mean(left), rel=0.3)


def test_parameters_scatter_as_far_as_it_is_told() -> None:
    """Known truth: fits to twelve noises of a gauge, with an exact angle, err as is foretold.

    Twelve fits tell the mean square error of a parameter to four tenths, and so do the draws about
    one log; a foretold error may be too large rather than too small.
    """
    reached, foretold = [], []
    for seed in range(12):
        log = gauged(seed)
        model = converged(at_the_truth(log), {"angle": 0.01})
        draws = unknown_input(model, {"gauged": gauge_errors(log)}, 1.0)
        told = moved_parameters(model, draws, 1.0)
        off = [np.log(model.parameters[name] / TRUTH[name]) for name in model.problem.free]
        foretold.append(list(told.values()))
        reached.append(off)
    ratio = np.mean(np.square(foretold), axis=0) / np.mean(np.square(reached), axis=0)
    assert np.all((ratio > 0.5) & (ratio < 3.0))


def test_what_is_not_shown_moves_no_farther_than_is_known() -> None:
    """Invariant: a prior knows each parameter to a factor of 4.5. A pressure that hardly moves
    holds next to nothing of an inertia, which would have to be anything to make up for a gauge."""
    time_s = np.arange(1500) / 50.0
    still = 50.0 + 1e-3 * SD_KPA * np.random.default_rng(0).standard_normal(time_s.size)
    angle = linear_angle(time_s, np.full(time_s.size, 50.0))
    log = Log.from_arrays(time_s, {"pressure": still, "angle": angle}, name="gauged")
    model = at_the_truth(log)
    draws = unknown_input(model, {"gauged": GaugeErrors(SD_KPA)}, 1e-4)
    moved = moved_parameters(model, draws, 1e-4)
    assert 0.0 < max(moved.values()) <= BASE_SD


def test_an_exact_input_moves_no_parameter() -> None:
    model = at_the_truth(gauged(0))
    assert unknown_input(model, {}, 1.0) is None
    assert moved_parameters(model, None, 1.0) == {}


def test_a_cause_that_muffles_the_gauge_takes_no_more_than_its_noise() -> None:
    """A motion that is held still feels half of the gauge's noise, and three quarters of its power
    go; a misfit of the motion itself that goes is more. An exact input has no noise to muffle."""
    log = gauged(0)
    exact = pressure_course(log.time_s)
    channel = log.channels["pressure"]
    calmer = replace(channel, values=0.5 * (channel.values + exact))
    half = replace(log, channels={**log.channels, "pressure": calmer})
    drifts = replace(log.channels["angle"], values=linear_angle(log.time_s, exact) + log.time_s)
    drifting = replace(log, channels={**log.channels, "angle": drifts})
    before, after, misfit = (at_the_truth(one) for one in (log, half, drifting))
    gauges = {"gauged": gauge_errors(log)}
    assert takes_input_noise_at_most(before, after, gauges)
    assert not takes_input_noise_at_most(misfit, after, gauges)
    assert not takes_input_noise_at_most(before, after, {})


def test_what_passes_for_slow_noise_is_held_against_the_gauge() -> None:
    """No rest shows the noise, and what the gauge makes is slow: its share is told beside it."""
    time_s = np.arange(6000) / 50.0
    pressure = 50.0 + 40.0 * np.sin(0.9 * time_s) * np.sin(0.31 * time_s)
    rng = np.random.default_rng(1)
    angle = linear_angle(time_s, pressure) + 0.002 * rng.standard_normal(time_s.size)
    noisy = pressure + SD_KPA * rng.standard_normal(time_s.size)
    log = Log.from_arrays(time_s, {"pressure": noisy, "angle": angle}, name="gauged")
    model = at_the_truth(log)
    scale = scale_of(model.problem, model.minimum.point)
    exact, gauge = (
        assess(model, model, scale, rng=np.random.default_rng(0), gauges=gauges)
        for gauges in ({}, {"gauged": gauge_errors(log)})
    )
    assert exact.colour_s is not None
    assert exact.input_noise < 0.01
    assert not gauge.structured
    assert gauge.input_noise > 0.1


def test_both_noises_add_up() -> None:
    """By hand: 4 + 1, and the deviations 0.4 and 0.5 (of 0.5 and 1.5 about 1) at right angles."""
    noise = InputNoise(np.array([[0.5**0.5] * 8, [1.5**0.5] * 8]))
    whole = noise.beside(NoiseFloor(4.0, 0.1, from_rest=True))
    assert whole.variance == pytest.approx(5.0)
    assert whole.relative_sd == pytest.approx(np.hypot(0.4, 0.5) / 5.0)
    assert whole.from_rest
    white = noise.with_white(4.0, rng=np.random.default_rng(0))
    assert white.shape == (8, 2)


@pytest.mark.parametrize(
    ("hidden", "seed"),
    [
        pytest.param("", 3101),
        pytest.param("delay", 3102),
        pytest.param("", 3103, marks=pytest.mark.slow),
        pytest.param("softening", 3104, marks=pytest.mark.slow),
        pytest.param("coulomb_friction", 3105, marks=pytest.mark.slow),
        pytest.param("creep", 3106, marks=pytest.mark.slow),
    ],
)
def test_a_noisy_gauge_is_no_misfit(hidden: str, seed: int) -> None:
    """Noise of 1 % of the range: what it makes of the motion is left by a true model, too, and is
    noise. Another law may still do as well as the hidden one."""
    rng = np.random.default_rng(seed)
    fitted, held_out = (
        _with_noise(log, rng) for log in hidden_pair([hidden] if hidden else [], seed=seed).logs
    )
    found = diagnose(fitted, hold_out=held_out, model="muscle")
    settled = (Verdict.NAMED, Verdict.AMBIGUOUS) if hidden else (Verdict.ADEQUATE,)
    assert found.verdict in settled
    assert [cause.effect for cause in found.causes] == ([hidden] if hidden else [])


def _with_noise(log: Log, rng: np.random.Generator) -> Log:
    channel = log.channels["pressure"]
    sd = 0.01 * float(np.ptp(channel.values))
    noisy = replace(channel, values=channel.values + sd * rng.standard_normal(len(log)))
    return replace(log, channels={**log.channels, "pressure": noisy})


def test_a_course_that_is_sampled_well_is_not_drawn() -> None:
    """The same actuator without a corner: nothing is unknown of its input."""
    log = gauged(0)
    smooth = 50.0 - 40.0 * np.cos(0.5 * log.time_s)
    channel = replace(log.channels["pressure"], values=smooth)
    log = replace(log, channels={**log.channels, "pressure": channel}, intersample="smooth")
    problem = linear_problem((log,))
    assert input_noise(standing(problem, problem.unknowns(TRUTH)), {}, 1e-4) is None


@pytest.mark.parametrize(
    ("hidden", "seed"), [("", 3), pytest.param("dead_zone", 1, marks=pytest.mark.slow)]
)
def test_what_the_input_did_between_its_samples_is_no_misfit(hidden: str, seed: int) -> None:
    """At 50 Hz behind a valve of 20 ms the input bends between two samples, and nobody sees how."""
    rig = Rig(rate_hz=50.0, valve_s=0.02, pressure_noise_kpa=0.0, noise=0.001)
    names = [hidden] if hidden else []
    (log, judge) = hidden_pair(names, seed=seed, model="muscle", protocol="levels", rig=rig).logs
    effects = ["dead_zone", "delay", "stiffening"]
    found = diagnose(log, hold_out=[judge], model="muscle", effects=effects)
    assert found.verdict is (Verdict.NAMED if hidden else Verdict.ADEQUATE)
    assert [cause.effect for cause in found.causes] == names
    assert found.remainder.input_noise > 0.3
    assert found.remainder.input_course == 1.0
    told = {issue.code: issue.message for issue in found.issues}
    assert "noisy-input" not in told
    assert "moves fast beside its samples" in told[FAST_INPUT]
    assert UNCERTAIN_TIMES not in told
    assert ("nothing to mend" in found.summary) is not bool(hidden)
