"""A sensor that slips in the middle of a log, and what the slip hides."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from recovery import all_recovered
from scipy.signal import step

from softid.diagnosis import diagnose
from softid.diagnosis.base.base_fit import Recordings, Request
from softid.diagnosis.changes.zero_jumps import ZERO_JUMP
from softid.diagnosis.logs.permanent_set import RESIDUAL_SET
from softid.diagnosis.report.changes import CHANGE_POINT
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.without_zero_jumps import search_without_zero_jumps
from softid.diagnosis_results import Diagnosis, Verdict
from softid.effects import effects_of
from softid.log import Log, LogSet
from softid.synthesis import HiddenPair, hidden_pair

SLIPS_AT = 0.55
"""Share of a log after which its sensor slips."""

BESIDE = ("coulomb_friction", "creep", "hysteresis", "contact", "delay")


def slipped(log: Log, size: float) -> Log:
    """The log with a zero that is another one in its second half, by a share of its spread."""
    (name,) = log.outputs
    channel = log.channels[name]
    after = log.time_s > SLIPS_AT * log.time_s[-1]
    values = channel.values + size * np.nanstd(channel.values) * after
    return replace(log, channels={**log.channels, name: replace(channel, values=values)})


def answer_to(pair: HiddenPair, size: float) -> Diagnosis:
    train, hold_out = pair.logs
    return diagnose(slipped(train, size), hold_out=[hold_out], model="muscle")


def told_and_named(found: Diagnosis, pair: HiddenPair, effect: str) -> bool:
    """Whether the slip is told with its moment, and the cause by name and size, or in a tie."""
    slips = [issue.message for issue in found.issues if issue.code == ZERO_JUMP]
    named = {cause.effect for cause in found.causes}
    named |= {name for tie in found.alternatives for name in tie.effects}
    moment = f"at {SLIPS_AT * pair.logs[0].time_s[-1]:.4g} s"
    is_told = any(moment in message for message in slips)
    return is_told and effect in named and bool(all_recovered(found, pair))


@pytest.mark.slow
def test_a_cause_is_named_beside_a_slip() -> None:
    """Stands on the truth of the generator: the cause, its size, and the moment of the slip."""
    pair = hidden_pair(["coulomb_friction"], seed=2)
    found = answer_to(pair, 0.3)
    assert told_and_named(found, pair, "coulomb_friction")
    assert "The zero of contraction jumps by" in found.summary


@pytest.mark.slow
def test_most_causes_are_named_beside_a_slip() -> None:
    """The others are not: where a log begins in a transient, a jump there takes more."""
    draws = [(effect, seed) for effect in BESIDE for seed in (3, 4)]
    pairs = [hidden_pair([effect], seed=seed) for effect, seed in draws]
    answers = [answer_to(pair, 0.3) for pair in pairs]
    met = [
        told_and_named(found, pair, effect)
        for found, pair, (effect, _) in zip(answers, pairs, draws, strict=True)
    ]
    assert sum(met) >= 8, list(zip(draws, met, strict=True))
    assert not any(found.causes for found, is_met in zip(answers, met, strict=True) if not is_met)


@pytest.mark.slow
def test_a_slip_of_the_judge_is_told_too() -> None:
    """Both logs slip, one up and one down: what is held out may not refuse the cause for that."""
    pair = hidden_pair(["coulomb_friction"], seed=2)
    train, hold_out = pair.logs
    logs = slipped(train, 0.3), slipped(hold_out, -0.2)
    found = diagnose(logs[0], hold_out=[logs[1]], model="muscle", effects=["coulomb_friction"])
    assert [cause.effect for cause in found.causes] == ["coulomb_friction"]
    assert [issue.code for issue in found.issues].count(ZERO_JUMP) == 2


@pytest.mark.parametrize("spread", [0.15, 1.0])
def test_a_slip_of_the_judge_alone_refuses_no_cause(spread: float) -> None:
    """Known truth; the larger one leaves of the held-out error nearly all, whatever is fitted."""
    pair = hidden_pair(["delay"], seed=5, model="oscillator")
    train, hold_out = pair.logs
    effects = ["delay", "hysteresis"]
    logs = train, slipped(hold_out, spread)
    found = diagnose(logs[0], hold_out=[logs[1]], model="oscillator", effects=effects)
    (told,) = (issue.message for issue in found.issues if issue.code == ZERO_JUMP)
    moment = re.search(rf"position jumps by \+[0-9.]+ mm at ([0-9.]+) s of {hold_out.name}", told)
    assert moment is not None
    assert float(moment[1]) == pytest.approx(SLIPS_AT * hold_out.time_s[-1], abs=0.01)
    assert found.verdict is Verdict.NAMED
    assert [cause.effect for cause in found.causes] == ["delay"]
    assert all_recovered(found, pair)


@pytest.mark.slow
def test_a_load_that_the_judge_alone_bears_refuses_no_cause() -> None:
    """Known truth: two logs of one actuator, which bears a load in the second half of the other."""
    bare, loaded = hidden_pair(["creep"], seed=3), hidden_pair(["creep", "load_jump"], seed=3)
    fitted, judge = bare.logs[1], replace(loaded.logs[0], name="judge")
    found = diagnose(fitted, hold_out=[judge], model="muscle")
    (told,) = (issue.message for issue in found.issues if issue.code == ZERO_JUMP)
    moment = re.search(r"another place at ([0-9.]+) s of judge, contraction by -", told)
    assert moment is not None
    assert float(moment[1]) == pytest.approx(loaded.hidden["load_jump"]["at"], abs=0.05)
    assert [cause.effect for cause in found.causes] == ["creep"]
    assert all_recovered(found, bare)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "shares", "spread"), [(3, (0.55,), 0.3), (3, (0.55,), 1.0), (8, (0.35, 0.75), 0.3)]
)
def test_a_cause_is_named_beside_a_load(
    seed: int, shares: tuple[float, ...], spread: float
) -> None:
    """Stands on the truth of the generator, and on the closed form of what a load adds to it.

    An oscillator that creeps is linear: M·s² + N·s + Q + k·τ·s/(τ·s + 1) is its stiffness. The load
    is put on, and in the last log taken off again; where it moves as far as the input does it takes
    nearly all of the misfit by itself.
    """
    pair = hidden_pair(["creep"], seed=seed, model="oscillator")
    train, hold_out = pair.logs
    (name,) = train.outputs
    channel = train.channels[name]
    size, moved = spread * np.nanstd(channel.values), channel.values
    moments_s = [round(share * train.time_s[-1], 1) for share in shares]
    for sign, at_s in zip((1.0, -1.0), moments_s, strict=False):
        moved = moved + sign * size * creeping_step(pair, train.time_s - at_s)
    loaded = replace(train, channels={**train.channels, name: replace(channel, values=moved)})
    found = diagnose(loaded, hold_out=[hold_out], model="oscillator")
    told = [issue.message for issue in found.issues if issue.code == ZERO_JUMP]
    assert len(told) == len(moments_s)
    place = rf"another place at ([0-9.]+) s of {train.name}, {name} by ([-+0-9.]+) mm"
    for message, at_s in zip(told, moments_s, strict=True):
        moment = re.search(place, message)
        assert moment is not None
        assert float(moment[1]) == pytest.approx(at_s, abs=0.02)
        assert abs(float(moment[2])) == pytest.approx(size, rel=0.05)
    assert [cause.effect for cause in found.causes] == ["creep"]
    assert all_recovered(found, pair)


def creeping_step(pair: HiddenPair, since_s: np.ndarray) -> np.ndarray:
    """How an oscillator that creeps goes to where a load moves it at once."""
    values, hidden = pair.actuator.values, pair.hidden["creep"]
    tau, bare = hidden["tau"], [values["M"], values["N"], values["Q"]]
    creeps = np.array([0.0, 0.0, hidden["k"] * tau, 0.0])
    denominator = np.polymul(bare, [tau, 1.0]) + creeps
    after = np.maximum(since_s, 0.0)
    fine_s = np.linspace(0.0, after[-1], 20_000)
    share = step((values["Q"] * np.array([tau, 1.0]), denominator), T=fine_s)[1]
    return np.where(since_s > 0.0, np.interp(after, fine_s, share), 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(("effect", "seed"), [("creep", 3), ("delay", 7)])
def test_a_cause_is_named_beside_a_load_of_a_muscle(effect: str, seed: int) -> None:
    """Known truth of the generator, whose held-out log has the load throughout.

    A load throughout is in a muscle a gain of all its numbers, so that only times are compared.
    """
    pair = hidden_pair([effect, "load_jump"], seed=seed)
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    (told,) = (issue.message for issue in found.issues if issue.code == ZERO_JUMP)
    moment = re.search(
        r"another place at ([0-9.]+) s of train, contraction by [-+0-9.]+ mm on average", told
    )
    assert moment is not None
    assert float(moment[1]) == pytest.approx(pair.hidden["load_jump"]["at"], abs=0.05)
    assert told.endswith("as if it had been so from the start")
    assert [cause.effect for cause in found.causes] == [effect]
    (tau,) = (p for p in found.causes[0].parameters if p.name == f"{effect}_tau")
    assert tau.value == pytest.approx(pair.hidden[effect]["tau"], rel=0.1)
    assert RESIDUAL_SET not in {issue.code for issue in found.issues}


@pytest.mark.slow
def test_a_slip_alone_is_an_event() -> None:
    """Nothing is named beside it."""
    found = answer_to(hidden_pair([], seed=5), 0.3)
    assert found.verdict is Verdict.UNKNOWN
    assert CHANGE_POINT in {issue.code for issue in found.issues}


@pytest.mark.parametrize(
    "effect", ["coulomb_friction", pytest.param("creep", marks=pytest.mark.slow)]
)
def test_no_jump_is_taken_out_of_a_steady_log(effect: str) -> None:
    """Where the cause is not among those considered, a jump does not stand in for it."""
    train, hold_out = hidden_pair([effect], seed=6).logs
    request = Request("muscle", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((train,)), (hold_out,), thorough=False)
    search = CauseSearch(base, effects_of(["quadratic_damping"]), 0, lambda *report: None)
    known = search.search()
    recordings = Recordings(LogSet((train,)), (hold_out,))
    assert search_without_zero_jumps(recordings, request, search, known) is None
