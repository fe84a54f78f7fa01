"""Jumps of the input between two samples that hide what else there is."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import softid
from softid.diagnosis.base.base_fit import Recordings, Request
from softid.diagnosis.logs.timed_jumps import with_jumps_at
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.searches import strategy, with_jump_moments
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.with_jump_moments import search_with_jump_moments, timed_recordings
from softid.diagnosis_results import Verdict
from softid.effects import effects_of
from softid.log import Log, LogSet
from softid.synthesis import HiddenPair, hidden_pair
from softid.synthesis.rig import Rig

Array = npt.NDArray[np.float64]

FINE_HZ = 1000.0
RATE_HZ = 80.0


def seldom(log: Log, rng: np.random.Generator) -> Log:
    """The rows nearest to stamps that come half an interval early or late."""
    count = int(RATE_HZ * log.time_s[-1]) + 50
    stamps = np.cumsum(rng.uniform(0.5, 1.5, count) / RATE_HZ)
    rows = np.unique(np.searchsorted(log.time_s, stamps[stamps < log.time_s[-1]]))
    return Log.from_arrays(
        log.time_s[rows],
        {name: channel.values[rows] for name, channel in log.channels.items()},
        units={name: channel.unit for name, channel in log.channels.items()},
        input=log.input,
        outputs=log.outputs,
        name=log.name,
    )


def held(
    seed: int, names: tuple[str, ...] = (), *, model: str = "muscle", noise: float = 0.003
) -> tuple[HiddenPair, tuple[Log, Log]]:
    """Random levels behind a valve that switches at once, seen by a clock that trembles."""
    rig = Rig(rate_hz=FINE_HZ, valve_s=1e-4, pressure_noise_kpa=0.0, noise=noise)
    whole = hidden_pair(names, seed=seed, model=model, protocol="levels", rig=rig)
    rng = np.random.default_rng(seed)
    log, judge = (seldom(log, rng) for log in whole.logs)
    return whole, (log, judge)


def search_over(
    logs: tuple[Log, Log], effects: tuple[str, ...], model: str = "muscle"
) -> CauseSearch:
    request = Request(model, None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet(logs[:1]), logs[1:], thorough=False)
    return CauseSearch(base, effects_of(effects), 0, lambda message, fraction: None)


def moments_of(whole: Log, begin_s: Array, end_s: Array) -> Array:
    """When within its interval the fine log has half of each jump behind it."""
    u = whole.channels[whole.input].values
    moments = []
    for begin, end in zip(begin_s, end_s, strict=True):
        inside = (whole.time_s >= begin) & (whole.time_s <= end)
        course = u[inside]
        half = 0.5 * (course[0] + course[-1])
        after = np.argmax((course > half) != (course[0] > half))
        moments.append(whole.time_s[inside][after])
    return np.array(moments)


def test_jumps_are_drawn_at_the_moments_that_the_motion_tells() -> None:
    """Nothing is hidden; in the middle of their intervals they would be off by 0.29 of it."""
    whole, logs = held(8, model="oscillator", noise=0.001)
    log, judge = (log.with_intersample("smooth") for log in logs)
    search = search_over((log, judge), ("softening",), "oscillator")
    plain = Recordings(search.base.identified.logs, search.base.identified.hold_out)
    timed = timed_recordings(plain, search, search.base.candidate)
    assert timed is not None
    for one, fine in zip((*timed.logs, *timed.hold_out), whole.logs, strict=True):
        (segment,) = one.segments()
        assert segment.is_sample is not None
        jumped_s = segment.time_s[~segment.is_sample][1::2]
        end = np.searchsorted(one.time_s, jumped_s)
        begin_s, end_s = one.time_s[end - 1], one.time_s[end]
        off = (jumped_s - moments_of(fine, begin_s, end_s)) / (end_s - begin_s)
        assert jumped_s.size > 5
        assert np.median(np.abs(off)) < 0.1
        assert np.mean(np.abs(off) < 0.15) > 0.8


@pytest.mark.slow
def test_a_cause_behind_jumps_is_named() -> None:
    """A rubber softens, and no other clock is named beside it; the moments explain the rest."""
    whole, (log, judge) = held(8, ("softening",))
    effects = ("softening", "clock_rate", "delay")
    found = softid.diagnose(log, hold_out=[judge], model="muscle", effects=effects)
    assert [cause.effect for cause in found.causes] == ["softening"]
    assert found.verdict is Verdict.NAMED
    (share, work) = found.causes[0].parameters
    truth = whole.hidden["softening"]
    assert share.ci95 is not None
    assert share.ci95[0] < truth["s"] < share.ci95[1]
    assert work.value == pytest.approx(truth["W0"], rel=0.2)
    assert found.remainder.open_jumps > 0


@pytest.mark.slow
def test_a_declared_intersample_behaviour_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever says that the input is held until the next sample knows when it jumped."""
    asked: list[Any] = []
    monkeypatch.setattr(strategy, "search_with_jump_moments", lambda *args: asked.append(args))
    _, logs = held(8, ("softening",))
    log, judge = (replace(log, intersample="held") for log in logs)
    softid.diagnose(log, hold_out=[judge], model="muscle", effects=["softening"])
    assert not asked


def test_what_is_known_among_the_named_effects_is_not_searched_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Stands on a search among those effects alone, which ends at the same model."""
    whole = hidden_pair(["delay"], seed=3, model="oscillator", protocol="multisine")
    search = search_over(whole.logs, ("delay", "pneumatic_lag", "hysteresis"), "oscillator")
    named = ("delay", "hysteresis")
    among = search_over(whole.logs, named, "oscillator").search()
    known = search.search().chain
    monkeypatch.setattr(with_jump_moments, "_chains", lambda *args: iter([known.among(set(named))]))
    monkeypatch.setattr(CauseSearch, "search", lambda *args: pytest.fail("searched again"))
    recordings = Recordings(search.base.identified.logs, search.base.identified.hold_out)
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    answered = search_with_jump_moments(recordings, request, search, known)
    assert answered is not None
    found, _ = answered
    assert found.chain.final.keys == among.chain.final.keys == ("delay",)
    assert found.is_named == among.is_named
    assert found.chain.final.squares == pytest.approx(among.chain.final.squares, rel=1e-6)
    assert "pneumatic_lag" in raced(known)
    assert raced(found.chain) == raced(among.chain)


def raced(chain: Chain) -> set[str]:
    return {link.added_by(row).name for link in chain.links for row in link.extending}


def test_where_nothing_jumps_nothing_is_searched() -> None:
    """A measured course, whatever it leaves."""
    whole = hidden_pair(["creep"], seed=3, model="muscle", protocol="multisine")
    request = Request("muscle", None, 0, lambda message, fraction: None)
    search = search_over(whole.logs, ("delay",))
    recordings = Recordings(LogSet(whole.logs[:1]), whole.logs[1:])
    assert search_with_jump_moments(recordings, request, search, search.first_cause()) is None


def test_a_log_without_jumps_stays_as_it_is() -> None:
    """Also where one of several segments has none."""
    log = hidden_pair(seed=3).logs[0]
    assert with_jumps_at(log, [np.empty((0, 2))], [np.empty(0)]) is log
