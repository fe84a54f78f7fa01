"""The verb `diagnose` on linear logs whose truth is known, with few effects, so that it is fast."""

from __future__ import annotations

import sys
from dataclasses import astuple, replace
from typing import Any

import numpy as np
import pytest
from linear_motion import RATE_HZ, TRUTH, linear_angle, linear_log

from softid.diagnosis import diagnose
from softid.diagnosis.base.base_fit import Request
from softid.diagnosis.workflow import _rising
from softid.diagnosis_results import Diagnosis, Verdict
from softid.errors import IdentificationError, UsageError
from softid.log import Log, LogSet
from softid.models import Oscillator
from softid.parallel import sharing
from softid.parallel.team import Team

RATE = 0.01
"""rad/s: 0.2 rad over the log of 20 s, under noise of 0.01."""

TWO = ("sensor_drift", "delay")


def drifting(seed: int = 0, rate: float = RATE) -> Log:
    return linear_log(noise=0.01, seed=seed, added=rate * linear_log().time_s)


@pytest.mark.parametrize("judge", ["blocks", "log"])
def test_a_drift_is_named_with_its_rate(judge: str) -> None:
    """Known truth: the rate and the parameters within their intervals, the error down to the noise.

    The interval of the gain covers 1 − 0.01/rms of the base, as the noise cannot be gained.
    """
    hold_out = [drifting(seed=1)] if judge == "log" else []
    found = diagnose(drifting(), hold_out=hold_out, model="oscillator", effects=TWO)
    assert found.verdict is Verdict.NAMED
    (cause,) = found.causes
    assert (cause.key, found.descriptive, found.alternatives) == ("sensor_drift", (), ())
    (rate,) = cause.parameters
    assert rate.ci95 is not None
    assert rate.ci95[0] <= RATE <= rate.ci95[1]
    assert cause.delta_bic > 100.0
    assert cause.holdout_rmse_after == pytest.approx(0.01, rel=0.2)
    assert found.extended is not None
    for name, true in TRUTH.items():
        interval = found.extended.parameter(name).ci95
        assert interval is not None
        assert interval[0] <= true <= interval[1], name
    if cause.gain_ci95 is not None:
        low, high = cause.gain_ci95
        assert low <= 1.0 - 0.01 / cause.holdout_rmse_before <= high
    assert [gain.held_out for gain in found.gains] == [False, True]
    assert found.remainder.explained_share > 0.95


def test_a_clipped_reading_is_named_wherever_its_zero_lies() -> None:
    """A length in mm without geometry has a zero of its own, ten times its range away.

    The limit counts from there: 1.1 rad of 1.5, recorded as 191.1.
    """
    log = linear_log(noise=0.005, samples=1500)
    clipped = np.minimum(log.channels["angle"].values, 1.1) + 190.0
    angle = replace(log.channels["angle"], values=clipped)
    found = diagnose(
        replace(log, channels=dict(log.channels) | {"angle": angle}),
        model="oscillator",
        effects=("sensor_clipping", "sensor_clipping.lower", "delay", "creep"),
    )
    assert [cause.key for cause in found.causes] == ["sensor_clipping"]
    (limit,) = found.causes[0].parameters
    assert limit.value == pytest.approx(1.1, abs=0.02)


def test_a_log_that_is_too_short_is_refused() -> None:
    """One sentence with the number, not a search that divides by nothing left."""
    short = linear_log(noise=0.01).between(0.0, 0.5)
    with pytest.raises(IdentificationError, match=r"too few samples.*softid fit"):
        diagnose(short, model="oscillator", effects=TWO)
    with pytest.raises(IdentificationError, match=r"to judge a cause by.*or none"):
        diagnose(linear_log(seed=1), hold_out=[short], model="oscillator", effects=TWO)


def test_a_hold_out_at_rest_is_refused() -> None:
    """A log in which nothing happens cannot judge a cause, however many samples it has."""
    whole = linear_log(noise=0.01, seed=1, samples=4000)
    resting = np.zeros(len(whole))
    log = Log.from_arrays(
        whole.time_s, {"pressure": resting, "angle": whole.channels["angle"].values}, name="still"
    )
    with pytest.raises(IdentificationError, match=r"still: the input .* hardly moves.*or none"):
        diagnose(linear_log(noise=0.01), hold_out=[log], model="oscillator", effects=TWO)


def test_a_static_model_is_refused_and_never_chosen() -> None:
    """A curve has no motion: it is refused by name, and a log of a curve gets a model with one."""
    with pytest.raises(UsageError, match=r"static.*polynomial.*muscle or oscillator"):
        diagnose(linear_log(noise=0.01), model="polynomial", effects=TWO)
    log = linear_log(noise=0.01)
    pressure = log.channels["pressure"].values
    curve = 1e-2 * pressure + 5e-5 * pressure**2
    still = Log.from_arrays(log.time_s, {"pressure": pressure, "angle": curve}, name="still")
    assert diagnose(still, effects=TWO).base.model.name in ("muscle", "oscillator")


def test_noise_alone_is_adequate() -> None:
    """Nothing is wrong, so nothing is named, and the judge's error is the noise."""
    found = diagnose(linear_log(noise=0.01), model="oscillator", effects=TWO)
    assert found.verdict is Verdict.ADEQUATE
    assert (found.causes, found.extended) == ((), None)
    (held,) = [gain for gain in found.gains if gain.held_out]
    assert held.rmse_after == held.rmse_before == pytest.approx(0.01, rel=0.2)


@pytest.mark.parametrize(
    ("hertz", "height", "verdict"),
    [
        (0.73, 0.04, Verdict.UNKNOWN),
        (0.73, 0.004, Verdict.ADEQUATE),
        (13.1, 0.04, Verdict.ADEQUATE),
    ],
)
def test_a_steady_force_is_unknown(hertz: float, height: float, verdict: Verdict) -> None:
    """A swinging load of four times the noise, which goes on in rests as well as in motions.

    What holds less than the noise, and what is too quick for the actuator, leaves it adequate.
    """
    rng = np.random.default_rng(1)
    time_s = np.arange(2000) / RATE_HZ
    levels = np.interp(time_s, np.arange(2000) / 2.0, 100.0 * rng.random(2000))
    levels = np.where(time_s < 10.0, 0.0, levels)
    swing = height * np.sin(2.0 * np.pi * hertz * time_s)
    angle = linear_angle(time_s, levels) + swing + 0.01 * rng.standard_normal(2000)
    log = Log.from_arrays(time_s, {"pressure": levels, "angle": angle}, name="swinging")
    found = diagnose(log, model="oscillator", effects=TWO)
    assert (found.verdict, found.causes) == (verdict, ())
    assert ("one steady line" in found.summary) == (verdict is Verdict.UNKNOWN)
    assert (found.remainder.line_share > 0.5) == (verdict is Verdict.UNKNOWN)


def test_a_cause_that_gains_nothing_is_chance() -> None:
    """A faint drift of the fitted log that the judge has not: its error would rise by a hundredth.

    Found among the evidence, but neither named nor described, and what is left looks like noise.
    """
    fitted = drifting(rate=0.04 * RATE)
    found = diagnose(
        fitted, hold_out=[linear_log(noise=0.01, seed=1)], model="oscillator", effects=TWO
    )
    assert (found.causes, found.descriptive, found.extended) == ((), (), None)
    assert found.verdict is Verdict.ADEQUATE
    rises = [e.delta_bic for e in found.evidence if e.effect == "sensor_drift" and e.delta_bic]
    assert max(rises) > 18.0


def test_the_same_seed_gives_the_same_answer() -> None:
    """No clock and no shared generator decide anything."""
    one, two = (
        diagnose(drifting(), model="oscillator", effects=["sensor_drift"], seed=3) for _ in range(2)
    )
    assert one.causes == two.causes
    assert one.remainder == two.remainder
    assert one.gains == two.gains


def test_what_was_left_aside_is_told() -> None:
    """A catalogue of one effect, and a log of which means were taken, are no secrets."""
    few = diagnose(drifting(), model="oscillator", effects=["sensor_drift"])
    assert "few-effects" in {issue.code for issue in few.issues}
    long_s = np.arange(13000) / 500.0
    pressure = np.where(long_s % 10.0 < 5.0, 0.0, 50.0 + 20.0 * np.sin(long_s))
    slow = TRUTH | {"N": 100.0}
    angle = linear_angle(long_s, pressure, slow) + RATE * long_s
    angle += 0.01 * np.random.default_rng(0).standard_normal(long_s.size)
    log = Log.from_arrays(long_s, {"pressure": pressure, "angle": angle})
    found = diagnose(log, model="oscillator", effects=["sensor_drift"])
    assert "averaged" in {issue.code for issue in found.issues}
    jumps = np.arange(2500, 13000, 2500)  # what holds one is left out
    holding = np.unique(np.concatenate((jumps - 1, jumps)) // 3)
    assert sum(gain.n for gain in found.gains) == 3 * (13000 // 3 - holding.size)
    (rate,) = found.causes[0].parameters
    assert rate.ci95 is not None
    assert rate.ci95[0] <= RATE <= rate.ci95[1]
    assert found.extended is not None
    (row,) = found.extended.statistics
    for error in (*(gain.rmse_after for gain in found.gains), found.remainder.rms, row.rmse):
        assert error == pytest.approx(0.01, rel=0.05)  # 0.006 in the means


def test_drop_outs_do_not_judge() -> None:
    """Samples that the fit leaves out as drop-outs are left out where blocks are held out, too.

    A wrong number of 3 rad among the 200 held-out samples alone would be an rms of 0.2 rad.
    """
    log = drifting()
    angle = np.array(log.channels["angle"].values)
    for at in (194, 205, 560, 925):
        angle[at] = -3.0
    channel = replace(log.channels["angle"], values=angle)
    faulty = replace(log, channels=dict(log.channels) | {"angle": channel})
    found = diagnose(faulty, model="oscillator", effects=["sensor_drift"])
    (issue,) = [issue for issue in found.issues if issue.code == "drop-out"]
    assert "4 samples" in issue.message
    assert found.verdict is Verdict.NAMED
    assert found.causes[0].holdout_rmse_after == pytest.approx(0.01, rel=0.2)


@pytest.mark.parametrize(
    ("asked", "order"), [("oscillator", "second"), (Oscillator(order="first"), "first")]
)
def test_a_term_that_the_limit_dropped_is_restored(asked: str | Oscillator, order: str) -> None:
    """Slow ramps show no inertia, so the fit is of first order; the search has the inertia back.

    It is still too small to be seen, a few sampling intervals of M/N at most, and the fit is as
    good. An order that was asked for stays.
    """
    time_s = np.arange(1000) / RATE_HZ
    pressure = np.interp(time_s, [2, 4, 8, 9, 12, 15, 20], [0, 60, 30, 50, 10, 40, 0])
    angle = linear_angle(time_s, pressure, {"M": 1e-6, "N": 50.0, "Q": 50.0})
    angle += 0.01 * np.random.default_rng(0).standard_normal(1000)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})
    wish = Request(asked, None, 0, lambda message, fraction: None)
    start = wish.fit_base(LogSet((log,)), (), thorough=True)
    identified, base = start.identified, start.candidate
    assert identified.found.problem.model.spec().options["order"] == "first"
    assert base.problem.model.spec().options["order"] == order
    assert base.problem.free == (("M",) if order == "second" else ()) + ("N", "Q")
    assert base.squares <= 2.0 * identified.found.optimum.cost * 1.001
    if order == "second":
        assert 0.0 < base.parameters["M"] / base.parameters["N"] < 3.0 / RATE_HZ


def test_progress_never_falls() -> None:
    """What is searched a second time begins again, which a bar may not show."""
    told: list[tuple[str, float]] = []
    report = _rising(lambda message, fraction: told.append((message, fraction)))
    for message, fraction in (("a", 0.1), ("b", 0.6), ("c", 0.3), ("d", 0.7)):
        report(message, fraction)
    assert told == [("a", 0.1), ("b", 0.6), ("c", 0.6), ("d", 0.7)]
    _rising(None)("nobody listens", 0.5)


def test_copies_of_the_process_find_what_it_finds_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """To the last digit, in the order of the causes too: who works on what is chance.

    They go on in step from the beginning to the end, and none is lost on the way.
    """
    log = drifting()
    found: list[Diagnosis] = []
    teams: set[object] = set()
    lost, share = Team._go_astray, Team.share

    def sharing_by(team: Team, *args: Any, **options: Any) -> Any:
        teams.add(team)
        return share(team, *args, **options)

    monkeypatch.setattr(Team, "share", sharing_by)
    monkeypatch.setattr(Team, "_go_astray", lambda team: (teams.add(None), lost(team)))
    for cores in (1, 3):
        monkeypatch.setattr(sharing, "usable_cores", lambda cores=cores: cores)
        found.append(diagnose(log, model="oscillator", effects=(*TWO, "creep", "sensor_lag")))
    alone, together = found
    assert alone.evidence
    assert [astuple(e) for e in alone.evidence] == [astuple(e) for e in together.evidence]
    assert alone.summary == together.summary
    assert len(teams) == (1 if sys.platform == "linux" else 0)
