"""Other first causes, for a search that came to nothing from the best one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, Bow, linear_log, linear_problem, standing

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search import alternative_first
from softid.diagnosis.search.alternative_first import (
    alternative_first_links,
    that_promise_the_rest,
)
from softid.diagnosis.search.forward_selection import FIRST, converged, is_accepted
from softid.effects import effect_of


class OtherBow(Bow):
    """Another form of the same effect."""

    variant = "other"


def test_the_others_begin_in_the_order_of_their_promise() -> None:
    """Known truth: a drift and a small parabola. Either pays; a delay does not, and the known first
    cause is not asked again, but other forms of it are."""
    time_s = linear_log().time_s
    bow = 0.04 * (time_s / time_s[-1]) ** 2
    problem = linear_problem([linear_log(noise=0.01, added=0.01 * time_s + bow)])
    z = problem.unknowns(TRUTH)
    base, scale = converged(standing(problem, z), SIGMA), scale_of(problem, z)
    drift, other_bow = effect_of("sensor_drift"), OtherBow()
    effects = (effect_of("delay"), drift, Bow())
    for known, begun in (
        (None, ["sensor_drift", "bow"]),
        (drift, ["bow"]),
        (other_bow, ["sensor_drift", "bow"]),
    ):
        chains = list(alternative_first_links(known, base, effects, scale, SIGMA))
        assert [chain.final.keys[-1] for chain in chains] == begun
        assert all(chain.final.squares < base.squares for chain in chains)


def test_what_did_best_and_was_refused_begins_whatever_it_promised(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A screening knows straight lines only: the winner of a race need not be among its first."""
    time_s = linear_log().time_s
    problem = linear_problem([linear_log(noise=0.01, added=0.01 * time_s)])
    z = problem.unknowns(TRUTH)
    base, scale = converged(standing(problem, z), SIGMA), scale_of(problem, z)
    drift, effects = effect_of("sensor_drift"), (effect_of("sensor_drift"), Bow())
    monkeypatch.setattr(alternative_first, "TRIED", 0)
    assert list(alternative_first_links(None, base, effects, scale, SIGMA)) == []
    (chain,) = alternative_first_links(None, base, effects, scale, SIGMA, refused=drift)
    assert chain.final.keys == ("sensor_drift",)


@pytest.mark.parametrize(
    ("others", "excess", "promises"),
    [("delay", 10.0, False), ("delay", 1e-9, True), ("bow", 10.0, True)],
)
def test_a_second_cause_promises_what_is_left(others: str, excess: float, promises: bool) -> None:
    """Known truth: behind a drift a parabola is left, which a delay does not take away.

    Where the first leaves noise there is nothing to promise, and the search goes on.
    """
    time_s = linear_log().time_s
    bow = 0.04 * (time_s / time_s[-1]) ** 2
    problem = linear_problem([linear_log(noise=0.001, added=0.01 * time_s + bow)])
    z = problem.unknowns(TRUTH)
    base, scale = converged(standing(problem, z), SIGMA), scale_of(problem, z)
    drift, second = effect_of("sensor_drift"), Bow() if others == "bow" else effect_of(others)
    (chain,) = alternative_first_links(None, base, (drift,), scale, SIGMA)
    left: Any = SimpleNamespace(excess=excess)
    found = that_promise_the_rest([chain], lambda model: left, (drift, second), scale, SIGMA)
    assert found == ([chain] if promises else [])


def test_the_first_cause_behind_which_least_may_be_left_begins() -> None:
    """Known truth: a drift that slackens, as a parabola beside it. A warm-up takes most of both,
    and behind it neither of the two takes all; behind the drift the parabola does."""
    time_s = linear_log().time_s
    slackening = -0.02 * time_s + 0.2 * (time_s / time_s[-1]) ** 2
    problem = linear_problem([linear_log(noise=0.001, added=slackening)])
    z = problem.unknowns(TRUTH)
    base, scale = converged(standing(problem, z), SIGMA), scale_of(problem, z)
    effects = (effect_of("sensor_warmup"), effect_of("sensor_drift"), Bow())
    warmup, drift = (
        next(alternative_first_links(None, base, (effect,), scale, SIGMA)) for effect in effects[:2]
    )
    assert warmup.final.squares < drift.final.squares
    left: Any = SimpleNamespace(excess=1e-9)
    found = that_promise_the_rest([warmup, drift], lambda model: left, effects, scale, SIGMA)
    assert found == [drift, warmup]


@pytest.mark.parametrize(("swing", "begun"), [(0.1, True), (0.3, False)])
def test_what_takes_much_begins_though_its_bic_does_not_fall(swing: float, begun: bool) -> None:
    """Beside a slow swing of 0.1 rad a drift takes two thirds of the squares, of 0.3 rad a tenth.

    The swing passes for slow noise, in which a drift is nothing to speak of.
    """
    time_s = linear_log().time_s
    slow = swing * np.sin(2.0 * np.pi * 0.11 * time_s)
    problem = linear_problem([linear_log(noise=0.001, added=0.02 * time_s + slow)])
    z = problem.unknowns(TRUTH)
    base, scale = converged(standing(problem, z), SIGMA), scale_of(problem, z)
    chains = list(alternative_first_links(None, base, (effect_of("sensor_drift"),), scale, SIGMA))
    assert bool(chains) is begun
    assert all(not is_accepted(chain.links[0], FIRST) for chain in chains)
