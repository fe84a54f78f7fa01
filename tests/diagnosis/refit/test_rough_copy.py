"""A fit over averages of a few samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import (
    RATE_HZ,
    SIGMA,
    TRUTH,
    Bow,
    linear_angle,
    linear_log,
    linear_problem,
    pressure_course,
    standing,
)

from softid.diagnosis.refit import rough_copy as module
from softid.diagnosis.refit.candidates import advance
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, extend_in_order, start_unknowns
from softid.diagnosis.refit.rough_copy import over_samples_of, rough_copy
from softid.diagnosis.search.racing import race
from softid.diagnosis.verdict.unlisted_laws import InputPlay
from softid.effects import effect_of
from softid.effects.base import Effect
from softid.fitters.problem import Problem
from softid.log import Log
from softid.models.oscillator import Oscillator

SAMPLES = 3000
DRIFT, CLIPPING = effect_of("sensor_drift"), effect_of("sensor_clipping")


@pytest.fixture(autouse=True)
def halves(monkeypatch: pytest.MonkeyPatch) -> None:
    """Five averages in a time constant, so that they are of two samples: by hand that is easy."""
    monkeypatch.setattr(module, "SAMPLES_PER_MOTION", 5.0)


def holds_no_jump(samples: int, count: int) -> npt.NDArray[np.bool_]:
    """Which means of ``linear_log`` hold no jump of its pressure."""
    at = np.flatnonzero(np.abs(np.diff(pressure_course(np.arange(samples) / RATE_HZ))) > 20.0)
    return ~np.isin(np.arange(samples // count), np.concatenate((at, at + 1)) // count)


def means_without_jump(samples: int, count: int) -> int:
    """How many do."""
    return int(holds_no_jump(samples, count).sum())


def slow_misfit(size: float) -> np.ndarray:
    """A sine of 10 s that no linear actuator has."""
    return size * np.sin(2.0 * np.pi * np.arange(SAMPLES) / (10.0 * RATE_HZ))


def test_a_misfit_weighs_as_much_over_averages_and_noise_half_as_much() -> None:
    """Σ of a sine over half the samples, each for two, is the same; the noise of a mean is σ/√2.

    A time constant of 0.2 s at 50 Hz has ten samples, of which five stay. The sine is that of the
    samples whose means hold no jump, to 1 %. Noise alone leaves 1 for each mean, times
    (13/12)² + 2/24² for means at their centres, y − Δ²y/24, within four times √(2 n/2).
    """
    of_centres, kept = (13.0 / 12.0) ** 2 + 2.0 / 24.0**2, means_without_jump(SAMPLES, 2)
    sine = slow_misfit(0.1)
    squares = float(np.sum((sine[np.repeat(holds_no_jump(SAMPLES, 2), 2)] / 0.01) ** 2))
    for added, noise, expected, tolerance in (
        (sine, 0.0, squares, 0.01 * squares),
        (0.0, 0.01, kept * of_centres, 4.0 * np.sqrt(2.0 * kept)),
    ):
        problem = linear_problem([linear_log(samples=SAMPLES, noise=noise, added=added)])
        z = problem.unknowns(TRUTH)
        rough, weights = rough_copy(standing(problem, z), scale_of(problem, z), SIGMA)
        assert rough.problem.n_samples == kept
        assert weights["angle"] == pytest.approx(SIGMA["angle"] / np.sqrt(2.0))
        assert rough.squares == pytest.approx(expected, abs=tolerance)
        assert {name: rough.parameters[name] for name in TRUTH} == pytest.approx(TRUTH)


def test_averages_of_an_edge_leave_nothing_of_their_own() -> None:
    """Known truth: the model leaves nothing over the samples, so it leaves nothing over averages
    beside edges either; and a stiffness 1 % off weighs as much over both but for the means that
    hold an edge."""
    problem = linear_problem([linear_log(samples=SAMPLES)])
    z = problem.unknowns(TRUTH)
    whole = standing(problem, z)
    rough, _ = rough_copy(whole, scale_of(problem, z), SIGMA)
    assert rough.problem.n_samples == means_without_jump(SAMPLES, 2)
    assert rough.squares == pytest.approx(whole.squares, abs=1e-3)
    off = problem.unknowns(TRUTH | {"Q": 1.01 * TRUTH["Q"]})
    over_samples, over_averages = (
        advance(standing(one, off), sigma, 1).squares
        for one, sigma in ((problem, SIGMA), (rough.problem, {"angle": SIGMA["angle"] / 2.0**0.5}))
    )
    assert over_averages == pytest.approx(over_samples, rel=0.05)


def test_a_play_follows_no_further_than_the_levels() -> None:
    """Known truth: levels of a second each, and a valve with a play of 20 kPa, which the model with
    it explains over averages, too: it moves to half of the play before each level.

    Nodes of an averaged input go beyond the levels beside a jump, and the play would follow them.
    """
    fine, width = 20, 20.0
    levels = np.random.default_rng(3).uniform(0.0, 100.0, SAMPLES // 50)
    command, arriving = np.repeat(levels, 50), np.empty(SAMPLES)
    at = command[0]
    for k, wanted in enumerate(command):
        at = min(max(at, wanted - 0.5 * width), wanted + 0.5 * width)
        arriving[k] = at
    fine_s = np.arange(SAMPLES * fine) / (RATE_HZ * fine)
    angle = linear_angle(fine_s, np.repeat(arriving, fine))[::fine]
    channels = {"pressure": command, "angle": angle}
    log = Log.from_arrays(fine_s[::fine], channels, outputs=("angle",)).with_intersample("held")
    problem = linear_problem([log])
    z = problem.unknowns(TRUTH)
    whole, scale = standing(problem, z), scale_of(problem, z)
    rough, _ = rough_copy(whole, scale, SIGMA)
    size = {"input_play_w": width / np.ptp(command), "input_play_side": 0.0}
    with_play = extend(rough.problem, (InputPlay(),), scale)
    at_truth = start_unknowns(with_play, rough.problem, rough.minimum.point, size)
    assert standing(with_play, at_truth).squares < 0.015 * standing(rough.problem, z).squares


def test_what_is_read_at_other_times_is_averaged_as_it_is_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Uneven samples are read at even times, which may be fewer: no residual is known there."""
    log = linear_log(samples=SAMPLES, noise=0.01)
    values = {name: channel.values[:-2] for name, channel in log.channels.items()}
    shorter = Log.from_arrays(log.time_s[:-2], values, outputs=log.outputs)
    monkeypatch.setattr(module, "evenly_sampled", lambda log: shorter)
    problem = linear_problem([log])
    z = problem.unknowns(TRUTH)
    rough, _ = rough_copy(standing(problem, z), scale_of(problem, z), SIGMA)
    assert rough.problem.n_samples == means_without_jump(SAMPLES - 2, 2)
    assert np.isfinite(rough.squares)


def test_a_time_constant_holds_three_averages(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.2 s at 50 Hz has ten samples; three averages of three are as many as fit in whole."""
    monkeypatch.undo()
    problem = linear_problem([linear_log(samples=2 * SAMPLES, noise=0.01)])
    z = problem.unknowns(TRUTH)
    rough, weights = rough_copy(standing(problem, z), scale_of(problem, z), SIGMA)
    assert rough.problem.n_samples == means_without_jump(2 * SAMPLES, 3)
    assert weights["angle"] == pytest.approx(SIGMA["angle"] / np.sqrt(3.0))


def test_a_bend_of_the_input_within_a_mean_counts_once() -> None:
    """The nodes of the averages hold it already; a cubic through them would put it in again.

    A sine of 2.5 Hz under means over 40 ms, once the start has died away: (2π f T)²/12 of it would
    be too much, and (π f T)⁴ is what averages leave of it at most.
    """
    fine, hertz = 20, 2.5
    fine_s = np.arange(SAMPLES * fine) / (RATE_HZ * fine)
    pressure = 40.0 * np.sin(2.0 * np.pi * hertz * fine_s)
    angle = linear_angle(fine_s, pressure)
    channels = {"pressure": pressure[::fine], "angle": angle[::fine]}
    log = Log.from_arrays(fine_s[::fine], channels, outputs=("angle",))
    problem = linear_problem([log.with_intersample("smooth")])
    z = problem.unknowns(TRUTH)
    rough, _ = rough_copy(standing(problem, z), scale_of(problem, z), SIGMA)
    assert rough.problem.n_samples == SAMPLES // 2
    (block,) = rough.problem.blocks(z, derivatives=False)
    phase = np.pi * hertz * 2.0 / RATE_HZ
    left = np.std(block.residual[SAMPLES // 20 :]) / np.std(angle)
    assert left < phase**4 < 0.5 * phase**2 / 3.0


def test_what_is_not_averaged_is_handed_back() -> None:
    """Short logs have nothing to spare."""
    problem = linear_problem([linear_log(samples=1000)])
    z = problem.unknowns(TRUTH)
    whole = standing(problem, z)
    rough, weights = rough_copy(whole, scale_of(problem, z), SIGMA)
    assert rough is whole
    assert weights is SIGMA


def test_a_motion_without_a_spring_is_left_as_it_is() -> None:
    """It adds up whatever a force is off, in averages as well, until no two races are alike.

    A time M/N of 4 s has 200 samples, of which so many could be spared.
    """
    model = Oscillator(x_unit="rad", u_unit="kPa", spring="none")
    declared = model.parameters().with_values({"M": 40.0, "N": 10.0})
    problem = Problem(model, declared, [linear_log(samples=SAMPLES)])
    z = problem.unknowns(declared.values_dict())
    whole = standing(problem, z)
    assert not whole.has_spring
    assert rough_copy(whole, scale_of(problem, z), SIGMA)[0] is whole


def test_there_and_back_is_the_same_candidate() -> None:
    """The unknowns stay, and evaluated over all samples again so does the sum of squares."""
    problem = linear_problem([linear_log(samples=SAMPLES, noise=0.01, added=slow_misfit(0.1))])
    z = problem.unknowns(TRUTH)
    whole, scale = standing(problem, z), scale_of(problem, z)
    rough, weights = rough_copy(whole, scale, SIGMA)
    added = (Bow(),)
    bowed = extend(whole.problem, added, scale)
    point = np.insert(whole.minimum.point, bowed.free.index("bow_c"), 0.05)
    candidate = standing(bowed, point)
    candidate = replace(advance(candidate, SIGMA, 1), effects=added)
    there = over_samples_of(candidate, rough, scale)
    assert there.problem.n_samples == means_without_jump(SAMPLES, 2)
    back = over_samples_of(advance(there, weights, 1), whole, scale)
    assert back.parameters == candidate.parameters
    assert advance(back, SIGMA, 1).squares == pytest.approx(candidate.squares)


@pytest.mark.parametrize("order", [(CLIPPING, DRIFT), (DRIFT, CLIPPING)])
def test_effects_keep_their_order(order: tuple[Effect, ...]) -> None:
    """A limit in front of a drift is no limit behind it, and its unknowns stand elsewhere."""
    problem = linear_problem([linear_log(samples=SAMPLES)])
    z = problem.unknowns(TRUTH)
    whole, scale = standing(problem, z), scale_of(problem, z)
    rough, _ = rough_copy(whole, scale, SIGMA)
    limited = extend_in_order(problem, order, scale)
    values = {"sensor_clipping_upper": 1.5, "sensor_drift_rate": 0.02}
    point = start_unknowns(limited, problem, z, values)
    candidate = replace(standing(limited, point), effects=(DRIFT, CLIPPING))
    there = over_samples_of(candidate, rough, scale)
    back = over_samples_of(there, whole, scale)
    assert there.acting == back.acting == order
    assert there.parameters == back.parameters == candidate.parameters


def test_a_race_over_averages_ends_where_one_over_all_samples_does(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The same order, and the same optimum to a fifth of a standard error, at which it rests."""
    time_s = np.arange(SAMPLES) / RATE_HZ
    log = linear_log(samples=SAMPLES, noise=0.01, added=0.05 * (time_s / time_s[-1]) ** 2)
    problem = linear_problem([log])
    z = problem.unknowns(TRUTH)
    base, scale = advance(standing(problem, z), SIGMA, 40), scale_of(problem, z)
    found = race(base, [DRIFT, Bow()], scale, SIGMA)
    monkeypatch.setattr(module, "COPY_SAMPLES", SAMPLES)
    whole = race(base, [DRIFT, Bow()], scale, SIGMA)
    assert [c.keys for c in found] == [c.keys for c in whole]
    assert found[0].keys == ("bow",)
    assert found[0].problem.n_samples == SAMPLES
    assert found[0].parameters["bow_c"] == pytest.approx(whole[0].parameters["bow_c"], abs=2e-4)
    assert found[0].squares == pytest.approx(whole[0].squares, rel=1e-4)
