"""A sensor that slips in the middle of a log, and what the slip hides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from recovery import all_recovered

from softid.diagnosis import diagnose
from softid.diagnosis.base.base_fit import Recordings, Request
from softid.diagnosis.cause_search import CauseSearch
from softid.diagnosis.changes.zero_jumps import ZERO_JUMP
from softid.diagnosis.report.changes import CHANGE_POINT
from softid.diagnosis.slip_search import search_without_zero_jumps
from softid.diagnosis_results import Diagnosis, Verdict
from softid.effects import effects_of
from softid.log import Log, LogSet
from softid.synthesis import HiddenPair, hidden_pair


def slipped(log: Log, size: float) -> Log:
    """The log with a zero that is another one in its second half, by a share of its spread."""
    (name,) = log.outputs
    channel = log.channels[name]
    after = log.time_s > 0.55 * log.time_s[-1]
    values = channel.values + size * np.nanstd(channel.values) * after
    return replace(log, channels={**log.channels, name: replace(channel, values=values)})


def answer_to(pair: HiddenPair, size: float) -> Diagnosis:
    train, hold_out = pair.logs
    return diagnose(slipped(train, size), hold_out=[hold_out], model="muscle")


@pytest.mark.parametrize(
    ("effect", "seed"),
    [
        ("coulomb_friction", 2),
        *(
            pytest.param(effect, seed, marks=pytest.mark.slow)
            for effect in ("coulomb_friction", "creep", "hysteresis", "contact", "delay")
            for seed in (3, 4)
        ),
    ],
)
def test_a_cause_is_named_beside_a_slip(effect: str, seed: int) -> None:
    """Stands on the truth of the generator: the cause, its size, and the moment of the slip."""
    pair = hidden_pair([effect], seed=seed)
    found = answer_to(pair, 0.3)
    assert effect in {name for tie in found.alternatives for name in tie.effects} | {
        cause.effect for cause in found.causes
    }
    (issue,) = [issue for issue in found.issues if issue.code == ZERO_JUMP]
    moment = 0.55 * pair.logs[0].time_s[-1]
    assert f"at {moment:.4g} s" in issue.message
    assert "the zero of contraction jumps by" in found.summary
    assert all_recovered(found, pair)


def test_a_slip_alone_is_an_event() -> None:
    """Nothing is named beside it."""
    found = answer_to(hidden_pair([], seed=5), 0.3)
    assert found.verdict is Verdict.UNKNOWN
    assert CHANGE_POINT in {issue.code for issue in found.issues}


@pytest.mark.parametrize("effect", ["coulomb_friction", "creep"])
def test_no_jump_is_taken_out_of_a_steady_log(effect: str) -> None:
    """Where the cause is not among those considered, a jump does not stand in for it."""
    train, hold_out = hidden_pair([effect], seed=6).logs
    request = Request("muscle", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((train,)), (hold_out,), thorough=False)
    search = CauseSearch(base, effects_of(["quadratic_damping"]), 0, lambda *report: None)
    known = search.search()
    recordings = Recordings(LogSet((train,)), (hold_out,))
    assert search_without_zero_jumps(recordings, request, search, known) is None
