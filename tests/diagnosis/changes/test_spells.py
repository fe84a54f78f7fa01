"""Spells to which a misfit is confined, on logs in which something happened at known times."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import RATE_HZ, TRUTH, linear_angle, linear_log, linear_problem, standing

from softid.diagnosis import diagnose
from softid.diagnosis.base.base_fit import Request
from softid.diagnosis.changes.clock_jumps import is_clock_jump
from softid.diagnosis.changes.events import is_parted
from softid.diagnosis.changes.log_differences import LogDifferences
from softid.diagnosis.changes.spells import (
    is_of_a_jump,
    loudest,
    spells_elsewhere,
    spells_of,
)
from softid.diagnosis.refit.candidates import Candidate, advance
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.report.changes import CHANGE_POINT, change_issues, spell_issues
from softid.diagnosis.residual.assessment import excess_of
from softid.diagnosis_results import Verdict
from softid.errors import InputError, Issue
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]

N, NOISE = 2000, 0.01
TIME_S = np.arange(N) / RATE_HZ
SOFT = {**TRUTH, "Q": 0.8 * TRUTH["Q"]}
RINGING = {**TRUTH, "M": 2.0, "N": 4.0}


def pressure() -> Array:
    levels = np.random.default_rng(9).uniform(10.0, 100.0, N // 50)
    smooth = np.convolve(np.repeat(levels, 50), np.ones(10) / 10.0, mode="same")
    return np.where(TIME_S < 1.0, 0.0, smooth)


def between(*spans: tuple[float, float]) -> npt.NDArray[np.bool_]:
    return np.any([(begin < TIME_S) & (end > TIME_S) for begin, end in spans], axis=0)


def log_of(angle: Array, seed: int = 0) -> Log:
    noise = NOISE * np.random.default_rng(seed).standard_normal(N)
    channels = {"pressure": pressure(), "angle": angle + noise}
    return Log.from_arrays(TIME_S, channels, name=f"log-{seed}")


def changed(*spans: tuple[float, float]) -> Array:
    """A fifth less stiff in some spells, as if the actuator had settled there at once."""
    whole, soft = (linear_angle(TIME_S, pressure(), truth) for truth in (TRUTH, SOFT))
    return np.where(between(*spans), soft, whole)


def fit(log: Log) -> Candidate:
    problem = linear_problem([log])
    return advance(standing(problem, problem.unknowns(TRUTH)), {"angle": NOISE}, 40)


@pytest.mark.parametrize(
    "spans",
    [((12.0, 17.0),), ((25.0, 41.0),), ((8.0, 11.0), (27.0, 31.0))],
    ids=str,
)
def test_the_spells_are_found(spans: tuple[tuple[float, float], ...]) -> None:
    """Known truth, to a second, for a soft spring shows where the pressure is high."""
    found = spells_of(log_of(changed(*spans)), fit, NOISE**2)
    assert found is not None
    assert len(found.spans_s) == len(spans)
    for told, (begin, end) in zip(found.spans_s, spans, strict=True):
        assert told == pytest.approx((max(begin, 0.0), min(end, TIME_S[-1])), abs=1.5)
    assert found.reference.parameters["Q"] == pytest.approx(TRUTH["Q"], rel=0.01)


THROUGHOUT = {
    "noise": np.zeros(N),
    "drift": 0.01 * TIME_S,
    "swing": 0.1 * np.sin(0.8 * TIME_S),
    "a law of the position": 0.05 * linear_angle(TIME_S, pressure()) ** 2,
}


@pytest.mark.parametrize("name", THROUGHOUT)
def test_what_goes_on_throughout_is_in_no_spell(name: str) -> None:
    log = log_of(linear_angle(TIME_S, pressure()) + THROUGHOUT[name])
    assert spells_of(log, fit, NOISE**2) is None


def test_a_model_that_follows_nothing_has_no_spells() -> None:
    """What is loud everywhere, and a third that nothing was measured in."""
    far = linear_angle(TIME_S, pressure()) + 5.0 * np.sin(7.0 * TIME_S) * np.exp(TIME_S / 20.0)
    assert spells_of(log_of(far), fit, NOISE**2) is None
    far[: N // 3 + 1] = np.nan

    def refusing(log: Log) -> Candidate:
        if not any(segment.used["angle"].any() for segment in log.segments()):
            raise InputError("the output has 0 usable samples")
        return fit(log)

    assert spells_of(log_of(far), refusing, NOISE**2) is None


def test_what_judges_is_followed_but_in_its_own_spells() -> None:
    """A model that lacks what fast motion does is wrong throughout a log that moves fast."""
    model = fit(log_of(linear_angle(TIME_S, pressure())))
    usual = log_of(linear_angle(TIME_S, pressure()), seed=1)
    assert spells_elsewhere(usual, model, NOISE**2) == 0
    assert spells_elsewhere(log_of(changed((12.0, 17.0)), seed=1), model, NOISE**2) == 1
    late = linear_angle(TIME_S, np.interp(TIME_S - 0.05, TIME_S, pressure()))
    assert spells_elsewhere(log_of(late, seed=1), model, NOISE**2) is None


@pytest.mark.parametrize(
    ("judge", "is_told", "recurs"),
    [("usual", True, False), ("late", False, False), ("changed", True, True)],
)
def test_a_spell_is_told_where_the_rest_predicts_what_judges(
    judge: str, is_told: bool, recurs: bool
) -> None:
    """One that comes again in what judges may be a law."""
    late = np.interp(TIME_S - 0.05 * (judge == "late"), TIME_S, pressure())
    angle = changed((24.0, 29.0)) if judge == "changed" else linear_angle(TIME_S, late)
    hold_out = log_of(angle, seed=1)
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    train = LogSet((log_of(changed((12.0, 17.0))),))
    base = request.fit_base(train, (hold_out,), thorough=False)
    issues = spell_issues(base)
    assert bool(issues) is is_told
    assert any("snap" in issue.message for issue in issues) is recurs


def issues_beside(train: Array, *judges: Array) -> tuple[Issue, ...]:
    """What is told of spells in a log when others judge."""
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    hold_out = tuple(log_of(judge, seed=1 + k) for k, judge in enumerate(judges))
    return spell_issues(request.fit_base(LogSet((log_of(train),)), hold_out, thorough=False))


ALWAYS, NEVER = (-1.0, 41.0), (50.0, 51.0)


def test_what_goes_on_in_what_judges_is_told_of_the_moment_it_began() -> None:
    """A stiffness changes at 25 s for good; not told where what judges misses something else, or
    where what changes in the log is over in it."""
    train = changed((25.0, 41.0))
    (issue,) = issues_beside(train, changed(ALWAYS))
    assert re.search(r"confined to 2[45]\.\d s to the end of log-0: there ", issue.message)
    assert issue.message.endswith("; log-1 has it throughout")
    assert "throughout" not in issues_beside(train, changed(NEVER))[0].message
    late = np.interp(TIME_S - 0.05, TIME_S, pressure())
    assert issues_beside(train, linear_angle(TIME_S, late)) == ()
    assert issues_beside(changed((12.0, 17.0)), changed(ALWAYS)) == ()


@pytest.mark.parametrize(("within_s", "is_told"), [(None, True), (3.0, False)])
def test_a_slip_soon_after_the_start_is_an_event(within_s: float | None, is_told: bool) -> None:
    """From 3.5 to 12 s, with what judges as it is later; what settles may be a sensor's warm-up."""
    size = 0.2 if within_s is None else 0.2 * np.exp(-(TIME_S - 3.5) / within_s)
    slipped = linear_angle(TIME_S, pressure()) + size * between((3.5, 12.0))
    told = issues_beside(slipped, linear_angle(TIME_S, pressure()))
    assert bool(told) is is_told
    if is_told:
        assert "confined to 3.5 to 12.0 s of log-0: there the zero of" in told[0].message


@pytest.mark.parametrize("within_s", [1.0, 1.5, 3.0, 6.0])
def test_what_settles_is_no_event(within_s: float) -> None:
    """A softening in time, behind which what judges is soft: no moment, though one takes most."""
    whole, soft = (linear_angle(TIME_S, pressure(), truth) for truth in (TRUTH, SOFT))
    train = log_of(soft + (whole - soft) * np.exp(-TIME_S / within_s))
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((train,)), (log_of(soft, seed=1),), thorough=False)
    excess = excess_of(base.candidate, base.scale)
    assert change_issues(base.candidate, base.scale, excess) == ()
    assert spell_issues(base) == ()
    assert not is_parted(base, excess)


@pytest.mark.parametrize(
    ("spans", "swing", "parted"),
    [
        ((25.0, 41.0), 0.0, True),
        ((25.0, 41.0), 0.03, False),
        ((12.0, 17.0), 0.0, False),
        ((50.0, 51.0), 0.0, False),
    ],
)
def test_one_number_may_leave_nothing_else_to_look_for(
    spans: tuple[float, float], swing: float, parted: bool
) -> None:
    """A stiffness that changes for good; a swing beside it, one spell or nothing is no such log."""
    log = log_of(changed(spans) + swing * np.sin(0.9 * TIME_S))
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((log,)), (log_of(changed(ALWAYS), seed=1),), thorough=False)
    assert is_parted(base, excess_of(base.candidate, base.scale)) is parted


def test_what_begins_with_the_log_may_relax() -> None:
    """A stiffness changes at 14 s, which tells where what judges follows what comes later."""
    train = changed((-1.0, 14.0))
    assert issues_beside(train) == ()
    assert issues_beside(train, train) == ()
    (issue,) = issues_beside(train, changed(NEVER))
    assert re.search(r"confined to [01]\.\d to 1[34]\.\d s of log-0: there ", issue.message)


def test_what_is_over_when_a_jump_has_settled_is_of_the_jump() -> None:
    """By hand: the input jumps between 3.98 and 4 s, and the motion settles in five times 0.2 s."""
    pressure = np.where(TIME_S < 3.99, 10.0, 60.0)
    log = Log.from_arrays(TIME_S, {"pressure": pressure, "angle": np.zeros(N)}, name="log")
    spans = ((4.0, 4.9), (4.0, 5.1), (3.9, 4.2), (12.0, 12.2))
    assert [is_of_a_jump(log, span, 0.2) for span in spans] == [True, False, False, False]


def test_the_loudest_stretch_of_nothing_is_empty() -> None:
    begin, end, total = loudest(np.full(5, -1.0))
    assert begin == end
    assert total == 0.0


def issues_of(log: Log) -> str:
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((log,)), (), thorough=False)
    (issue,) = spell_issues(base)
    assert issue.code == CHANGE_POINT
    return issue.message


def test_what_changes_there_is_told() -> None:
    """The stiffness by −20 %, from 25 s to the end; gain and pressure are nearly the same."""
    message = issues_of(log_of(changed((25.0, 41.0))))
    assert "s to the end of log-0: there " in message
    assert "the stiffness" in message


def test_a_shift_is_of_the_zero_or_of_a_load() -> None:
    """Known truth: the reading jumps, or the actuator moves as far under a load."""
    there = between((12.0, 17.0))
    jumps = linear_angle(TIME_S, pressure()) + 0.2 * there
    moves = linear_angle(TIME_S, pressure() + 0.2 * TRUTH["Q"] * there)
    for angle, what in ((jumps, "the zero of the reading"), (moves, "a constant load")):
        told = re.search(
            rf": there {what} changes, which shifts angle by \+([0-9.]+) rad and takes away",
            issues_of(log_of(angle)),
        )
        assert told is not None
        assert float(told[1]) == pytest.approx(0.2, abs=0.01)


def test_a_payload_is_inertia_and_load() -> None:
    """Known truth: half as much inertia again, and a weight."""
    heavy, there = {**RINGING, "M": 1.5 * RINGING["M"]}, between((12.0, 17.0))
    light = linear_angle(TIME_S, pressure(), RINGING)
    loaded = linear_angle(TIME_S, pressure() - 5.0, heavy)
    message = issues_of(log_of(np.where(there, loaded, light)))
    assert "there the inertia M changes by +" in message
    assert "and a constant load changes, as with another payload, which shifts" in message


CHIRP = 55.0 + 45.0 * np.sin(0.5 * (TIME_S - 20.0) ** 2)
FASTER = np.where(TIME_S < 20.0, pressure(), CHIRP)
"""A pressure that moves faster from 20 s on than before."""


def faster_log(angle: Array) -> Log:
    noise = NOISE * np.random.default_rng(3).standard_normal(N)
    return Log.from_arrays(TIME_S, {"pressure": FASTER, "angle": angle + noise}, name="log")


def test_a_clock_that_jumps_before_fast_motion_is_told() -> None:
    """Known truth: 0.2 s of the reading are lost at 20 s, where the fast motion begins."""
    angle = linear_angle(TIME_S, FASTER)
    early = np.interp(TIME_S + 0.2, TIME_S, angle)
    message = issues_of(faster_log(np.where(TIME_S < 20.0, angle, early)))
    told = re.search(r"the delay of the reading changes by (\S+) s", message)
    assert told is not None
    assert float(told[1]) == pytest.approx(-0.2, abs=0.01)


@pytest.mark.parametrize(("late_s", "jumps"), [(0.0, True), (0.1, False)])
def test_a_delay_that_the_rest_has_too_is_no_jump(late_s: float, jumps: bool) -> None:
    """Known truth of the slow part, to which a model is fitted; behind it 0.1 s seem to be lost."""
    late = linear_angle(TIME_S, np.interp(TIME_S - late_s, TIME_S, FASTER))
    reference = fit(faster_log(late).with_masked(TIME_S >= 20.0))
    scale = scale_of(reference.problem, reference.minimum.point)
    change = LogDifferences(("delay",), (0.1,), 1.0)
    assert is_clock_jump(change, reference, scale, {"angle": NOISE}) is jumps
    other = replace(change, kinds=("gain",))
    assert not is_clock_jump(other, reference, scale, {"angle": NOISE})


def test_what_fast_motion_shows_is_no_clock_that_jumps() -> None:
    """Known truth: the reading is late throughout, which the slow motion tells, too."""
    for late_s in (0.1, 0.3):
        late = linear_angle(TIME_S, np.interp(TIME_S - late_s, TIME_S, FASTER))
        request = Request("oscillator", None, 0, lambda message, fraction: None)
        base = request.fit_base(LogSet((faster_log(late),)), (), thorough=False)
        assert spell_issues(base) == ()


def test_a_spell_with_a_shape_of_its_own_is_told_without_a_change() -> None:
    angle = linear_angle(TIME_S, pressure())
    angle[between((12.0, 17.0))] += 0.3 * np.sin(3.0 * TIME_S[between((12.0, 17.0))])
    assert "outside of which no more than noise is left" in issues_of(log_of(angle))


def test_a_diagnosis_tells_the_spell_in_place_of_descriptions() -> None:
    found = diagnose(log_of(changed((12.0, 17.0))), model="oscillator", effects=["creep"])
    assert found.verdict is Verdict.UNKNOWN
    assert [issue.code for issue in found.issues].count(CHANGE_POINT) == 1
    assert "is confined to" in found.summary
    assert "best description" not in found.summary


def test_clean_logs_have_none() -> None:
    log = linear_log(noise=NOISE, samples=N)
    assert spells_of(log, fit, NOISE**2) is None


@pytest.mark.parametrize("swings", [False, True])
def test_what_another_log_has_throughout_is_no_event(swings: bool) -> None:
    """A spell in one log is told while the other follows the model, and not beside a swing."""
    one = log_of(changed((12.0, 17.0)))
    swing = 0.1 * np.sin(0.8 * TIME_S) if swings else np.zeros(N)
    other = log_of(linear_angle(TIME_S, pressure()) + swing, seed=1)
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((one, other)), (), thorough=False)
    assert len(spell_issues(base)) == (0 if swings else 1)


def test_a_log_with_nothing_to_fit_is_in_nobodys_way() -> None:
    """Two seconds at rest beside the log with the spell."""
    one = log_of(changed((12.0, 17.0)))
    noise = NOISE * np.random.default_rng(2).standard_normal(100)
    resting = {"pressure": np.zeros(100), "angle": noise}
    other = Log.from_arrays(TIME_S[:100], resting, name="resting")
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((one, other)), (), thorough=False)
    (issue,) = spell_issues(base)
    assert "of log-0" in issue.message
