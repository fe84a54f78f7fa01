"""Jumps of the input between two samples, against a motion that is known in closed form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import RATE_HZ, TRUTH, linear_angle, linear_log, linear_problem, standing

import softid
from softid.diagnosis.base.base_fit import Request
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.whitening import Whitener, whitener_of
from softid.diagnosis.residual import jump_timing, noise_model
from softid.diagnosis.residual.assessment import assess
from softid.diagnosis.residual.jump_timing import part_of_jumps, untimed_jumps
from softid.diagnosis.search import bic_ranking
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis_results import Diagnosis, Verdict
from softid.log import Log, LogSet
from softid.models.oscillator import Oscillator
from softid.parallel import sharing

Array = npt.NDArray[np.float64]

TAU_S = 0.3
PERIOD_S = 0.02
NOISE = 0.003
DURATION_S = 40.0


def switched(
    seed: int,
    *,
    rises_s: float = 0.0,
    delay_s: float = 0.0,
    period_s: float = PERIOD_S,
    noise: float = NOISE,
) -> Log:
    """τ ẏ + y = u sampled at 50 Hz, while a valve switches u between levels when it likes to.

    With ``rises_s`` the valve takes so long for it, and what it does is on record.
    """
    rng = np.random.default_rng(seed)
    moments = np.cumsum(rng.uniform(1.0, 3.0, 40))
    heights = np.diff(rng.uniform(0.0, 100.0, 41))
    time_s = np.arange(0.0, DURATION_S, period_s)

    def response(since_s: Array) -> Array:
        """To a step, or to a ramp of ``rises_s``, in closed form."""
        after = np.maximum(since_s, 0.0)
        if rises_s == 0.0:
            return np.where(since_s > 0.0, 1.0 - np.exp(-after / TAU_S), 0.0)
        end = np.maximum(since_s - rises_s, 0.0)
        ramp = after - end - TAU_S * (np.exp(-end / TAU_S) - np.exp(-after / TAU_S))
        return ramp / rises_s

    def course(since_s: Array) -> Array:
        if rises_s == 0.0:
            return (since_s > 0.0).astype(np.float64)
        return np.clip(since_s / rises_s, 0.0, 1.0)

    jumps = list(zip(moments.tolist(), heights.tolist(), strict=True))
    u = 50.0 + np.sum([h * course(time_s - at) for at, h in jumps], axis=0)
    y = 5.0 + 0.1 * np.sum([h * response(time_s - delay_s - at) for at, h in jumps], axis=0)
    y += noise * np.ptp(y) * rng.standard_normal(time_s.size)
    channels = {"pressure": u, "angle": y}
    return Log.from_arrays(time_s, channels, outputs=("angle",), name=f"switched-{seed}")


def diagnosed(**options: float) -> Diagnosis:
    return softid.diagnose(
        switched(1, **options), hold_out=[switched(2, **options)], model="oscillator"
    )


def test_jumps_within_an_interval_are_found() -> None:
    """All 20 that the valve makes in 40 s, but those of a twentieth of the span."""
    log = switched(1)
    (segment,) = log.segments()
    found = untimed_jumps(segment)
    heights = np.abs(np.diff(segment.input))
    before = np.flatnonzero(heights > 0.05 * np.ptp(segment.input))
    assert found.tolist() == segment.time_s[np.column_stack((before, before + 1))].tolist()
    assert len(found) > 12


def test_what_takes_several_samples_is_no_jump() -> None:
    """A valve that opens for 0.3 s is seen in fifteen samples."""
    (segment,) = switched(1, rises_s=0.3).segments()
    assert untimed_jumps(segment).size == 0


@pytest.mark.parametrize("share", [0.105, 0.505, 0.805])
def test_columns_are_what_a_jump_at_a_share_of_the_interval_does(share: float) -> None:
    """Closed form: the motion with the jump where it is, less the one with a straight line.

    That is (½ − f) √12 of the first column and (f (1 − f)/2 − 1/12) √720 of the second, but for
    the next moment of the input, a hundredth of them for an interval of a tenth of N/Q.
    """
    problem = linear_problem([linear_log()])
    (segment,) = problem.segments
    spans_s = untimed_jumps(segment)
    place = int(np.searchsorted(segment.time_s, spans_s[0, 0]))
    columns = part_of_jumps(standing(problem, problem.unknowns(TRUTH)), 0, noise=0.0)[
        :, :: len(spans_s)
    ]
    fine_s = np.arange(100 * (segment.time_s.size - 1) + 1) / (100 * RATE_HZ)
    straight = np.interp(fine_s, segment.time_s, segment.input)
    inside = np.arange(100 * place, 100 * place + 101)
    jumping = straight.copy()
    before, after = segment.input[place], segment.input[place + 1]
    jumping[inside] = np.where(inside - 100 * place <= 100 * share, before, after)
    apart = (linear_angle(fine_s, jumping) - linear_angle(fine_s, straight))[::100]
    first = (0.5 - share) * 12.0**0.5
    second = (share * (1.0 - share) / 2.0 - 1.0 / 12.0) * 720.0**0.5
    later = slice(place + 2, None)
    expected = (columns @ (first, second))[later]
    assert expected == pytest.approx(apart[later], abs=0.02 * np.abs(columns[later]).max())


def by_slower_gauge(log: Log, factor: int) -> Log:
    """The same recording with a pressure that is read at every so many samples, with noise."""
    channel = log.channels["pressure"]
    noisy = channel.values + 0.02 * np.random.default_rng(len(log)).standard_normal(len(log))
    read = noisy[np.arange(len(log)) // factor * factor]
    return replace(log, channels={**log.channels, "pressure": replace(channel, values=read)})


def test_a_moment_between_two_readings_of_a_slower_gauge_is_open() -> None:
    """Output at 100 Hz, pressure at 20: clean data are called clean, and the reading is told."""
    logs = [by_slower_gauge(switched(seed, period_s=0.01), 5) for seed in (1, 2)]
    found = softid.diagnose(logs[0], hold_out=logs[1:], model="oscillator")
    assert found.verdict is Verdict.ADEQUATE
    assert found.remainder.open_jumps > 12
    (remark,) = (issue for issue in found.issues if issue.code == "untimed-jumps")
    assert "jumps between the readings at" in remark.message


def test_an_open_moment_is_no_misfit() -> None:
    """The answer is that nothing is wrong, and why; the jumps are counted and the first is told."""
    found = diagnosed()
    assert found.verdict is Verdict.ADEQUATE
    assert found.remainder.open_jumps > 12
    assert "jumps of the input between two samples are left open" in found.summary
    (remark,) = (issue for issue in found.issues if issue.code == "untimed-jumps")
    assert "jumps between the samples at" in remark.message


def ringing(seed: int, *, delay_s: float = 0.0) -> Log:
    """ÿ + 2ζω ẏ + ω² y = ω² u at 50 Hz, ω = 15/s, ζ = 0.15: a motion too quick to forgive moments.

    One of the first order in the wrong place is another time constant.
    """
    rng = np.random.default_rng(seed)
    moments = np.cumsum(rng.uniform(0.8, 2.5, 25))
    levels = np.where(np.arange(26) % 2, 90.0, 10.0)
    time_s = np.arange(0.0, DURATION_S, PERIOD_S)
    omega, zeta = 15.0, 0.15
    damped = omega * np.sqrt(1.0 - zeta**2)

    def response(since_s: Array) -> Array:
        after = np.maximum(since_s, 0.0)
        swing = np.cos(damped * after) + zeta * omega / damped * np.sin(damped * after)
        return np.where(since_s > 0.0, 1.0 - np.exp(-zeta * omega * after) * swing, 0.0)

    jumps = list(zip(moments.tolist(), np.diff(levels).tolist(), strict=True))
    u = 10.0 + np.sum([h * (time_s > at) for at, h in jumps], axis=0)
    y = 1.0 + 0.1 * np.sum([h * response(time_s - delay_s - at) for at, h in jumps], axis=0)
    y += NOISE * np.ptp(y) * rng.standard_normal(time_s.size)
    return Log.from_arrays(
        time_s, {"pressure": u, "angle": y}, outputs=("angle",), name=f"ringing-{seed}"
    )


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_moments_are_estimated_beside_the_parameters(seed: int) -> None:
    """Known truth: nothing is hidden; parameters fitted to wrong moments left structure, too."""
    found = softid.diagnose(ringing(seed), hold_out=[ringing(seed + 50)], model="oscillator")
    assert found.verdict is Verdict.ADEQUATE
    assert found.remainder.open_jumps > 12
    assert found.remainder.open_jumps_scatter


@pytest.mark.parametrize(("delay_s", "scatter"), [(0.0, True), (0.008, False)])
def test_moments_that_a_cause_asks_for_do_not_scatter(delay_s: float, scatter: bool) -> None:
    """A delay of four tenths of an interval asks for moments that are nearly all late.

    What is left is noise all the same, so that alone would hide the delay.
    """
    log, judge = (ringing(seed, delay_s=delay_s).with_intersample("straight") for seed in (1, 51))
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((log,)), (judge,), thorough=False)
    rng = np.random.default_rng(0)
    left = assess(base.candidate, base.candidate, base.scale, rng=rng)
    assert not left.structured
    assert left.open_jumps > 12
    assert left.open_jumps_scatter is scatter


@pytest.mark.slow
def test_nothing_is_left_open_where_the_course_is_on_record() -> None:
    """The same valve: what it did is known, and noise is left."""
    found = diagnosed(rises_s=0.3)
    assert found.verdict is Verdict.ADEQUATE
    assert found.remainder.open_jumps == 0


@pytest.mark.parametrize(
    ("delay_s", "misses"), [(0.0, False), pytest.param(0.03, True, marks=pytest.mark.slow)]
)
def test_moments_in_what_is_held_out_are_open_too(delay_s: float, misses: bool) -> None:
    """The fitted valve takes its time, so nothing is open there; that of the judge does not.

    An interval and a half that only the judge is late by is no matter of moments.
    """
    fitted = switched(1, rises_s=0.3, noise=0.001)
    judge = switched(2, noise=0.001, delay_s=delay_s)
    left = softid.diagnose(fitted, hold_out=[judge], model="oscillator").remainder
    assert left.open_jumps == 0
    assert left.misses_held_out is misses
    assert (left.open_jumps_held_out > 12) is not misses


@pytest.mark.slow
@pytest.mark.parametrize("delay_s", [0.05, 0.12])
def test_a_delay_is_found_beside_open_moments(delay_s: float) -> None:
    """One of two intervals and a half, in every jump alike, is no matter of their moments."""
    found = diagnosed(delay_s=delay_s)
    assert found.verdict is not Verdict.ADEQUATE
    named = {cause.effect for cause in found.causes}
    tied = {effect for tie in found.alternatives for effect in tie.effects}
    assert "delay" in named | tied


@pytest.mark.parametrize("noise", [0.006, 0.015])
def test_a_delay_does_not_vary_by_what_is_not_known_of_the_moments(noise: float) -> None:
    """Known truth: 0.05 s, which noise hides the moments behind, so that none is left open.

    The model has no inertia, as the truth has none: one would be late by as much as a delay.
    """
    logs = [switched(seed, delay_s=0.05, noise=noise) for seed in (1, 2)]
    model = Oscillator(order="first")
    found = softid.diagnose(logs[0], hold_out=[logs[1]], model=model, effects=["delay"])
    assert found.remainder.open_jumps == 0
    assert [cause.effect for cause in found.causes] == ["delay"]
    assert found.causes[0].variation is None
    (delay,) = found.causes[0].parameters
    assert delay.ci95 is not None
    assert delay.ci95[0] < 0.05 < delay.ci95[1]


def test_a_model_that_runs_away_has_no_moments(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a jump does to it is no number."""
    problem = linear_problem([switched(3)])
    model = standing(problem, problem.unknowns(TRUTH))
    columns = part_of_jumps(model, 0, noise=1.0)
    assert columns.size
    monkeypatch.setattr(
        jump_timing, "part_of_jumps", lambda *a, **k: np.full(columns.shape, np.nan)
    )
    assert noise_model.moments_of(model) is None


@pytest.mark.slow
def test_what_explains_a_part_of_open_moments_is_chance(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 20 Hz a law helps where jumps are taken as drawn, and may not be named; the base alone
    leaves noise. Nothing helps where moments are a part of that."""

    def diagnosis() -> Diagnosis:
        fitted, judge = (switched(seed, period_s=0.05, noise=0.002) for seed in (3, 53))
        return softid.diagnose(fitted, hold_out=[judge], model="oscillator")

    found = diagnosis()
    assert found.verdict is Verdict.ADEQUATE
    assert found.remainder.open_jumps > 12
    with monkeypatch.context() as patched:
        patched.setattr(CauseSearch, "without_causes", lambda search: None)
        assert diagnosis().verdict is Verdict.ADEQUATE
    monkeypatch.setattr(bic_ranking, "noise_model_of", as_drawn)
    assert diagnosis().verdict is Verdict.ADEQUATE
    monkeypatch.setattr(CauseSearch, "without_causes", lambda search: None)
    assert diagnosis().verdict is Verdict.UNKNOWN


def as_drawn(best: Candidate, sigma: Mapping[str, float]) -> Whitener:
    """The noise that a candidate leaves if all jumps come where they are drawn."""
    return whitener_of(best.problem, best.minimum.point, sigma)


@pytest.mark.parametrize(("damping", "fewer"), [(10.0, True), (500.0, False)])
def test_jumps_that_share_a_simulation_are_told_apart(
    monkeypatch: pytest.MonkeyPatch, damping: float, fewer: bool
) -> None:
    """The columns are those of jumps simulated alone, also where none fades before the next.

    Four simulations a jump when alone; with a time constant of 0.2 s jumps 1.5 s apart share them,
    with one of 10 s none do.
    """
    problem = linear_problem([linear_log(samples=3000)])
    model = standing(problem, problem.unknowns({**TRUTH, "N": damping}))
    jumps = len(untimed_jumps(problem.segments[0]))
    simulate, count = Oscillator.response, []

    def counted(*args: Any, **options: Any) -> Any:
        count.append(1)
        return simulate(*args, **options)

    monkeypatch.setattr(Oscillator, "response", counted)
    # What copies of the process count is lost.
    monkeypatch.setattr(sharing, "usable_cores", lambda: 1)
    shared = part_of_jumps(model, 0, noise=0.0)
    assert (len(count) < 2 * jumps) is fewer
    monkeypatch.setattr(jump_timing, "TOGETHER", jumps)
    count.clear()
    alone = part_of_jumps(model, 0, noise=0.0)
    assert len(count) == 4 * jumps
    count.clear()
    monkeypatch.setattr(jump_timing, "TOGETHER", 2)
    part_of_jumps(model, 0, noise=1e3)
    assert len(count) == 8
    largest = np.abs(alone).max(axis=0)
    assert float((np.abs(shared - alone) / largest).max()) < jump_timing.FADED
