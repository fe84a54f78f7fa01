"""From a chain of refits to plain results: which form of an effect is told, and in what order."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from extended_fits import scale_of
from handmade_diagnosis import estimate
from handmade_rounds import candidate, ranked

from softid.diagnosis.search.bic_ranking import Ranked
from softid.diagnosis.search.forward_selection import Chain, Link
from softid.diagnosis.search.screening import Signature
from softid.diagnosis.verdict.cause_results import (
    alternatives_of,
    causes_of,
    evidence_of,
    told_as,
)
from softid.effects import effect_of


def test_a_tie_names_the_forms_that_are_meant() -> None:
    """Known rows: the lower limit was chosen, the best friction is that of Stribeck, 3 behind; a
    rival that did not race is told by its name."""
    rows = (
        ranked(("sensor_clipping.lower",), 0.0),
        ranked(("coulomb_friction.stribeck",), 3.0),
        ranked(("sensor_clipping",), 4.0),
        ranked(("coulomb_friction",), 8.0),
        ranked((), 100.0),
    )
    rivals = ("sensor_clipping", "coulomb_friction", "delay")
    (tie,) = alternatives_of([Link(rows[-1], rows, rows[0], rivals, (), 100.0)])
    assert tie.effects == rivals
    assert tie.forms == tie.keys == ("sensor_clipping.lower", "coulomb_friction.stribeck", "delay")
    assert tie.delta_bic == {"sensor_clipping": 0.0, "coulomb_friction": 3.0, "delay": 0.0}
    assert replace(tie, forms=()).keys == rivals


def test_what_was_chosen_is_told_though_another_form_is_ahead() -> None:
    """The plain lag stays the answer while two times gain little: then it is the one in the tie."""
    rows = (
        ranked(("pneumatic_lag.separate",), 0.0),
        ranked(("pneumatic_lag",), 5.0),
        ranked(("delay",), 9.0),
        ranked((), 100.0),
    )
    link = Link(rows[-1], rows, rows[1], ("pneumatic_lag", "delay"), (), 100.0)
    (tie,) = alternatives_of([link])
    assert tie.keys == ("pneumatic_lag", "delay")
    assert tie.delta_bic == {"pneumatic_lag": 0.0, "delay": 4.0}
    (tie,) = alternatives_of([replace(link, chosen=rows[0])], {"pneumatic_lag.separate": "x"})
    assert tie.keys == ("x", "delay")


@pytest.mark.parametrize(
    ("key", "ci95", "told"),
    [
        ("pneumatic_lag.separate", (0.9, 1.1), "pneumatic_lag"),
        ("pneumatic_lag.separate", (1.0, 1.1), "pneumatic_lag"),
        ("pneumatic_lag.separate", (1.01, 1.08), "pneumatic_lag"),
        ("pneumatic_lag.separate", (1.02, 1.1), "pneumatic_lag.separate"),
        ("pneumatic_lag.separate", (0.5, 0.99), "pneumatic_lag.separate"),
        ("pneumatic_lag.separate", None, "pneumatic_lag.separate"),
        ("pneumatic_lag", (0.9, 1.1), "pneumatic_lag"),
    ],
)
def test_two_times_that_may_be_one(key: str, ci95: tuple[float, float] | None, told: str) -> None:
    """Where the ratio of venting to filling may be 1, or nearly is, no more is told than a lag."""
    tau = replace(estimate("pneumatic_lag_tau", 1.0, "s"), ci95=(0.9, 1.1))
    middle = float(np.mean(ci95)) if ci95 else 1.0
    ratio = replace(estimate("pneumatic_lag_ratio", middle, "1"), ci95=ci95)
    assert told_as(effect_of(key), [tau, ratio]).key == told


def test_every_cause_names_those_before_it() -> None:
    """By the keys of the fitted forms, in the order of the chain, whatever the errors are."""
    keys = ("delay", "pneumatic_lag.separate", "creep")
    rows = [ranked(keys[:k], -100.0 * k) for k in range(4)]
    links = tuple(
        Link(before, (after, before), after, (after.candidate.effects[-1].name,), (), 100.0)
        for before, after in pairwise(rows)
    )
    chain = Chain(links, None, candidate(keys))
    found = causes_of(chain, [np.ones(5)] * 4, None, scale_of("muscle"))
    assert [cause.added_to for cause in found] == [(), keys[:1], keys[:2]]
    assert [cause.round for cause in found] == [1, 2, 3]


def test_shares_of_those_that_raced_and_those_that_did_not_are_of_one_whole() -> None:
    """Known rows: the lag left 60 of 200 for white noise, the delay promised 50 of them; under the
    shared noise model there were 80 and 72."""
    before = Ranked(candidate((), 80.0), candidate((), 200.0), 0.0)
    lag = Ranked(candidate(["pneumatic_lag"], 72.0), candidate(["pneumatic_lag"], 60.0), -40.0)
    signatures = tuple(
        Signature(effect_of(name), {}, drop, np.zeros(0))
        for name, drop in (("pneumatic_lag", 130.0), ("delay", 50.0))
    )
    link = Link(before, (lag, before), lag, ("pneumatic_lag",), signatures, 200.0)
    raced, out = evidence_of(Chain((link,), None, lag.plain))
    assert (raced.effect, raced.delta_bic, raced.drop_share) == ("pneumatic_lag", 40.0, 0.7)
    assert (out.effect, out.delta_bic, out.drop_share) == ("delay", None, 0.25)
