"""What the input does between its samples, looked at again with a cause in the model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import (
    RATE_HZ,
    SIGMA,
    TRUTH,
    linear_angle,
    linear_log,
    linear_problem,
    standing,
    swinging_log,
)
from scipy.signal import lsim

import softid
from softid.diagnosis.base import intersample_selection
from softid.diagnosis.base.intersample_selection import (
    better_intersample,
    hold_out_as_explained,
    intersample_after_all_causes,
    intersample_after_first_cause,
    is_measured,
    is_open,
    with_intersample,
)
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.search.forward_selection import converged
from softid.diagnosis_results import Verdict
from softid.effects import effect_of
from softid.identification.intersample_choice import choice_unless_held, choices_of
from softid.intersample import Intersample
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]

LOG = linear_log(noise=0.01)
"""Its pressure jumps every 5 s, and its answer is exact for straight lines between samples."""


def test_a_wrong_intersample_behaviour_is_left_for_the_true_one() -> None:
    """Stands on the truth of the log, at the true parameters."""
    held = linear_problem(with_intersample([LOG], "held"))
    z = held.unknowns(TRUTH)
    assert better_intersample(standing(held, z), SIGMA) == "straight"
    straight = linear_problem(with_intersample([LOG], "straight"))
    assert better_intersample(standing(straight, z), SIGMA) is None


def test_a_measured_input_is_straight_where_that_does_as_well() -> None:
    """Two of them explain alike: noise of the size of the motion hides what lies between."""
    log = linear_log(noise=1.0)
    held = linear_problem(with_intersample([log], "held"))
    z = held.unknowns(TRUTH)
    sigma = {"angle": 1.0}
    assert better_intersample(standing(held, z, sigma), sigma) is None
    assert intersample_after_all_causes(standing(held, z, sigma), sigma) == "straight"
    command = replace(log, channels={
        "pressure_command": log.channels["pressure"], "angle": log.channels["angle"]
    }, input="pressure_command")  # fmt: skip
    commanded = linear_problem(with_intersample([command], "held"))
    assert intersample_after_all_causes(standing(commanded, z, sigma), sigma) is None


@pytest.mark.parametrize(
    ("swing", "fall", "counts"), [(0, 12, 1), (0, 8, 0), (0.3, 12, 0), (0.3, 5e3, 1)]
)
def test_what_is_left_for_long_counts_for_few_samples(
    swing: float, fall: float, counts: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A zero that swings by so many rad in ten seconds, which no cause explains, is a few numbers.

    Of white noise every sample counts, so a fall of n ln(S) by more than 10 does.
    """
    monkeypatch.setattr(intersample_selection, "_fall", lambda model, other: fall)
    log = linear_log(noise=0.01, added=swing * np.sin(0.6 * LOG.time_s))
    straight = linear_problem(with_intersample([log], "straight"))
    candidate = standing(straight, straight.unknowns(TRUTH))
    first = better_intersample(candidate, SIGMA)
    last = intersample_after_all_causes(candidate, SIGMA)
    assert (first is not None) == (last is not None) == bool(counts)


@pytest.mark.parametrize(("excess", "counts"), [(0.0, True), (0.05, True), (20.0, False)])
def test_a_behaviour_that_takes_little_of_what_is_left_is_not_what_is_missing(
    excess: float, counts: bool
) -> None:
    """Straight lines take away 10 to 20 % of what a held input leaves: all of what is 5 % above the
    noise, and little of what is 20 times the noise."""
    log = linear_log(noise=0.02)
    command = replace(log, channels={
        "pressure_command": log.channels["pressure"], "angle": log.channels["angle"]
    }, input="pressure_command")  # fmt: skip
    held, straight = (
        converged(standing(problem, problem.unknowns(TRUTH)), SIGMA)
        for problem in (
            linear_problem(with_intersample([command], intersample))
            for intersample in ("held", "straight")
        )
    )
    assert 0.1 < 1.0 - straight.squares / held.squares < 0.2
    assert (intersample_after_all_causes(held, SIGMA, excess) == "straight") is counts


def late(seconds: float, *, held: bool, intersample: Intersample) -> tuple[Candidate, Candidate]:
    """Base and delayed model of a log whose input goes on so late, straight or held, at the truth.

    The pressure jumps once, and changes at every sample.
    """
    rng = np.random.default_rng(2)
    fine, period_s = 20, 1.0 / RATE_HZ
    pressure = 50.0 + 30.0 * np.sin(2.0 * np.pi * 0.7 * LOG.time_s) + rng.normal(0.0, 4.0, len(LOG))
    pressure[:50], pressure[50:60] = 0.0, 50.0
    fine_s = period_s / fine * np.arange(fine * len(LOG))
    arriving = np.interp(fine_s - seconds, LOG.time_s, pressure)
    if held:
        at = np.clip(np.floor((fine_s - seconds) / period_s + 1e-9), 0, len(LOG) - 1)
        arriving = pressure[at.astype(int)]
    angle = linear_angle(fine_s, arriving)[::fine] + 1e-4 * rng.standard_normal(len(LOG))
    channels = {
        "pressure": replace(LOG.channels["pressure"], values=pressure),
        "angle": replace(LOG.channels["angle"], values=angle),
    }
    log = replace(LOG, channels=channels)
    base = linear_problem(with_intersample([log], intersample))
    z = base.unknowns(TRUTH)
    effect = effect_of("delay")
    problem = extend(base, (effect,), scale_of(base, z))
    tau = max(seconds + (0.5 * period_s if held else 0.0), 1e-3)
    begun = start_unknowns(problem, base, z, {"delay_tau": tau})
    delayed = replace(standing(problem, begun, SIGMA), effects=(effect,))
    return converged(standing(base, z), SIGMA), converged(delayed, SIGMA)


def test_half_an_interval_late_is_held() -> None:
    """The base alone explains the log then; beside a cause that takes time it is not held."""
    base, delayed = late(0.0, held=True, intersample="straight")
    assert better_intersample(delayed, SIGMA) == "zoh"
    scale = scale_of(base.problem, base.minimum.point)
    assert intersample_after_first_cause(base, delayed, scale, SIGMA) == "zoh"
    assert intersample_after_first_cause(base, base, scale, SIGMA) == "zoh"
    assert intersample_after_all_causes(delayed, SIGMA) is None


def test_a_cause_that_takes_time_keeps_its_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """A measured input that is late by more is not held, however much better that is beside it.

    Nor is it before the delay is known: one explains more than half an interval.
    """
    base, delayed = late(0.05, held=False, intersample="straight")
    scale = scale_of(base.problem, base.minimum.point)
    monkeypatch.setattr(intersample_selection, "better_intersample", lambda candidate, sigma: "zoh")
    assert intersample_after_first_cause(base, delayed, scale, SIGMA) is None
    assert intersample_after_first_cause(base, base, scale, SIGMA) is None


@pytest.mark.parametrize(("seconds", "is_held", "found"), [(0.0, True, "zoh"), (0.05, False, None)])
def test_an_input_that_may_be_held_needs_no_delay_of_half_an_interval(
    seconds: float, is_held: bool, found: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Though the delayed model is no better with a held input: the base alone is as good with one.

    More than half an interval is no holding.
    """
    base, delayed = late(seconds, held=is_held, intersample="straight")
    scale = scale_of(base.problem, base.minimum.point)
    monkeypatch.setattr(intersample_selection, "better_intersample", lambda candidate, sigma: None)
    assert intersample_after_first_cause(base, delayed, scale, SIGMA) == found


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_steps_that_were_held_are_no_lag(seed: int) -> None:
    """The pressure jumps every 3 s, at a sample; the same log with a lag of 60 ms has one."""
    time_s = np.arange(0.0, 36.0, 1.0 / RATE_HZ)
    fine_s = np.arange(time_s.size * 20) / (20 * RATE_HZ)

    def log(at: int, lag_s: float) -> Log:
        held = 50.0 + 30.0 * ((fine_s + 1e-6) // 3.0 % 2.0)
        if lag_s > 0.0:
            held = lsim(([1.0], [lag_s, 1.0]), held - held[0], fine_s)[1] + held[0]
        pressure = 50.0 + 30.0 * ((time_s + 1e-6) // 3.0 % 2.0)
        noise = 0.004 * np.random.default_rng(at).standard_normal(time_s.size)
        angle = linear_angle(fine_s, held)[::20] + noise
        return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}, name=f"steps-{at}")

    clean, lagged = (
        softid.diagnose(log(seed, lag_s), hold_out=[log(seed + 10, lag_s)], model="oscillator")
        for lag_s in (0.0, 0.06)
    )
    assert clean.verdict is Verdict.ADEQUATE
    codes = [issue.code for issue in clean.issues]
    assert sorted(codes) == ["held-input", "moving-start", "moving-start", "own-lag"]
    tied = {name for tie in lagged.alternatives for name in tie.effects}
    assert "pneumatic_lag" in tied | {cause.effect for cause in lagged.causes}


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2))]
)
def test_steps_that_were_held_and_partly_lost_are_no_delay(seed: int) -> None:
    """Nobody knows when it jumped while samples were lost: held over the gap it would be late."""

    def log(at: int) -> Log:
        rng = np.random.default_rng(at)
        samples, fine = 2000, 20
        lengths = rng.integers(8, 60, 400)
        pressure = np.repeat(rng.uniform(10.0, 100.0, 400), lengths)[:samples]
        time_s = np.arange(samples) / RATE_HZ
        fine_s = np.arange(samples * fine) / (fine * RATE_HZ)
        angle = linear_angle(fine_s, np.repeat(pressure, fine) - pressure[0])[::fine]
        angle += 0.002 * rng.standard_normal(samples)
        kept = np.convolve(rng.uniform(size=samples) < 0.04, np.ones(3), "same") < 0.5
        channels = {"pressure": pressure[kept], "angle": angle[kept]}
        return Log.from_arrays(time_s[kept], channels, name=f"lost-{at}")

    found = softid.diagnose(log(seed), hold_out=[log(seed + 10)], model="oscillator")
    assert found.verdict is Verdict.ADEQUATE, found.summary


@pytest.mark.slow
def test_a_sine_that_judges_fitted_steps_tells_how_it_was_held() -> None:
    """Half an interval, which the steps do not show, is no misfit of the sine."""
    samples, fine = 1500, 20
    time_s = np.arange(samples) / RATE_HZ
    fine_s = np.arange(samples * fine) / (fine * RATE_HZ)

    def log(name: str, pressure: Array) -> Log:
        angle = linear_angle(fine_s, np.repeat(pressure, fine) - pressure[0])[::fine]
        angle += 0.002 * np.random.default_rng(5).standard_normal(samples)
        return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}, name=name)

    rng = np.random.default_rng(4)
    steps = np.repeat(rng.uniform(10.0, 100.0, 30), 50)
    sine = 50.0 - 40.0 * np.cos(2.0 * np.pi * 0.4 * time_s)
    found = softid.diagnose(log("steps", steps), hold_out=[log("sine", sine)], model="oscillator")
    assert found.verdict is Verdict.ADEQUATE, found.summary
    codes = [issue.code for issue in found.issues]
    assert codes.count("held-otherwise") == 1


def test_a_judge_is_not_held_later_for_want_of_a_delay() -> None:
    """With the delay known a sine is held as the fitted steps; the base would hold it longer."""
    base, delayed = late(0.05, held=False, intersample="held")
    late_sine = 50.0 - 40.0 * np.cos(2.0 * np.pi * 0.4 * (LOG.time_s - 0.05))
    sine = 50.0 - 40.0 * np.cos(2.0 * np.pi * 0.4 * LOG.time_s)
    channels = {"pressure": sine, "angle": linear_angle(LOG.time_s, late_sine)}
    (judge,) = with_intersample([Log.from_arrays(LOG.time_s, channels)], "held")
    for model, found in ((base, "zoh"), (delayed, "held")):
        (judged,) = hold_out_as_explained(model, "held", SIGMA, [judge])
        assert judged.intersample == found
        (judged,) = hold_out_as_explained(model, "straight", SIGMA, [LOG])
        assert judged is LOG


def test_only_what_nobody_declared_is_open() -> None:
    """What is declared stays, and an input without a jump does but one thing."""
    assert is_open(LogSet((LOG,)))
    assert not is_open(LogSet(with_intersample([LOG], "straight")))
    smooth = LOG.between(1.2, 3.4)
    assert not is_open(LogSet((smooth,)))
    assert not is_open(LogSet((LOG, replace(linear_log(seed=1), intersample="held"))))


def test_an_intersample_behaviour_takes_the_place_of_another() -> None:
    """What the first one told goes with it."""
    held = with_intersample([LOG], "zoh")
    assert [issue.code for issue in held[0].issues] == ["held-input"]
    again = with_intersample(held, "straight")
    assert again[0].intersample == "straight"
    assert not again[0].issues
    assert with_intersample(again, "held")[0].intersample == "held"


def test_a_command_is_not_measured() -> None:
    """Only a measured input goes straight from one sample to the next by its nature."""
    assert is_measured(LogSet((LOG,)))
    renamed = {"pressure_command": LOG.channels["pressure"], "angle": LOG.channels["angle"]}
    command = replace(LOG, channels=renamed, input="pressure_command")
    assert not is_measured(LogSet((command,)))


def test_a_measured_input_that_bends_is_smooth() -> None:
    """A command is not, nor is an input that is sampled many times as fast as it swings."""
    logs = [swinging_log(1)]
    assert choices_of(logs) == ("straight", "smooth")
    assert choice_unless_held(logs) == "smooth"
    assert is_open(LogSet(tuple(logs)))
    slow = [LOG.between(1.2, 3.4)]
    assert choices_of(slow) == ("straight",)
    assert choice_unless_held(slow) == "straight"
    own = logs[0].channels
    channels = {"pressure_command": own["pressure"], "angle": own["angle"]}
    command = replace(logs[0], channels=channels, input="pressure_command")
    assert "smooth" not in choices_of([command])


def test_straight_lines_are_found_where_an_input_bends() -> None:
    """What went straight is told from what was smooth, both ways, by the motion."""
    for polyline, truth in ((True, "straight"), (False, "smooth")):
        log = swinging_log(1, polyline=polyline)
        for intersample in ("straight", "smooth"):
            problem = linear_problem(with_intersample([log], intersample))
            found = converged(standing(problem, problem.unknowns(TRUTH)), SIGMA)
            assert better_intersample(found, SIGMA) == (None if intersample == truth else truth)


@pytest.mark.parametrize("delay_s", [pytest.param(0.0, marks=pytest.mark.slow), 0.02])
def test_a_bend_between_samples_is_no_effect(delay_s: float) -> None:
    """Straight lines cut a swinging input short: a delay or a lag took that for its own."""
    log, judge = swinging_log(1, delay_s), swinging_log(2, delay_s)
    found = softid.diagnose(log, hold_out=[judge], model="oscillator")
    if delay_s == 0.0:
        assert found.verdict is Verdict.ADEQUATE
        return
    assert [cause.effect for cause in found.causes] == ["delay"]
    assert found.extended is not None
    tau = found.extended.parameter("delay_tau")
    assert tau.value == pytest.approx(delay_s, rel=0.05)
    assert found.extended.intersample == "smooth"
