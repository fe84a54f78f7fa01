"""The chain of causes: what counts, what is as good, and when it ends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest
from handmade_rounds import SAMPLES, UNKNOWNS, link, ranked
from linear_motion import SIGMA, TRUTH, Bow, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search import forward_selection
from softid.diagnosis.search.contenders import choose_contender
from softid.diagnosis.search.forward_selection import (
    BEHIND_NOISE,
    CONVERGING,
    FIRST,
    FURTHER,
    Acceptance,
    converged,
    is_accepted,
    next_link,
    select_forward,
)
from softid.diagnosis.search.screening import screen
from softid.effects import effect_of
from softid.effects.scale import Scale

DRIFT = effect_of("sensor_drift")
RATE, SIZE = 0.003, 0.05
BEFORE, PERIOD_S = ranked((), 1000.0), 0.01
"""What the rounds by hand extend, and their sampling interval."""


@pytest.mark.parametrize(
    ("fall", "demands"),
    [
        (17.9, ()),
        (18.1, (FIRST,)),
        (29.9, (FIRST,)),
        (30.1, (FIRST, FURTHER)),
        (59.9, (FIRST, FURTHER)),
        (60.1, (FIRST, FURTHER, BEHIND_NOISE)),
    ],
)
def test_how_far_the_bic_must_fall(fall: float, demands: tuple[Acceptance, ...]) -> None:
    """Stands on the limits: 18 for the first cause, 30 for a further one, 60 behind noise."""
    for acceptance in (FIRST, FURTHER, BEHIND_NOISE):
        assert is_accepted(link(fall), acceptance) is (acceptance in demands)


@pytest.mark.parametrize(("after", "counts"), [(98.9, True), (99.1, False)])
def test_a_further_cause_takes_a_hundredth(after: float, counts: bool) -> None:
    """However far the BIC of many samples falls; of the first cause that is not asked."""
    assert is_accepted(link(500.0, after=after), FURTHER) is counts
    assert is_accepted(link(500.0, after=after), FIRST)


@pytest.mark.parametrize(("gain", "key"), [(5.9, ""), (6.1, "separate")])
def test_a_richer_law_must_gain_on_the_plain_one(gain: float, key: str) -> None:
    """The plain lag stays the answer while two time constants gain less than 6 of BIC."""
    rows = [
        ranked(("pneumatic_lag.separate",), 0.0),
        ranked(("pneumatic_lag",), gain),
        ranked(("creep",), gain + 20.0),
    ]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best.candidate.effects[0].variant == key
    assert names == ("pneumatic_lag",)


@pytest.mark.parametrize(("speed", "key"), [("vb", ""), ("vs", "stribeck")])
def test_a_richer_law_that_ends_at_its_floor_is_the_plain_one(speed: str, key: str) -> None:
    """An excess of friction within a speed that is hardly one makes up for the rounded sign."""
    held = ranked(("coulomb_friction.stribeck",), 0.0, at_bound=(f"coulomb_friction_{speed}",))
    best, _ = choose_contender([held, ranked(("coulomb_friction",), 60.0)], BEFORE, PERIOD_S)
    assert best.candidate.effects[0].variant == key


def test_a_richer_law_without_a_plain_one_is_taken() -> None:
    """When the plain form has dropped out of the race there is nothing to prefer."""
    rows = [ranked(("pneumatic_lag.separate",), 0.0), ranked(("creep",), 1.0)]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best is rows[0]
    assert names == ("pneumatic_lag", "creep")


def test_rivals_are_those_within_twelve() -> None:
    """By the name of the cause, each once, the best first."""
    rows = [
        ranked(("delay",), 0.0),
        ranked(("pneumatic_lag.separate",), 3.0),
        ranked(("pneumatic_lag",), 5.0),
        ranked(("sensor_lag",), 11.9),
        ranked(("creep",), 12.1),
    ]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best is rows[0]
    assert names == ("delay", "pneumatic_lag", "sensor_lag")


def test_rivals_are_measured_from_what_was_chosen() -> None:
    """Against the plain form, not against the richer one that it is preferred to."""
    rows = [
        ranked(("pneumatic_lag.separate",), 0.0),
        ranked(("pneumatic_lag",), 5.0),
        ranked(("delay",), 12.0),
    ]
    assert choose_contender(rows, BEFORE, PERIOD_S)[1] == ("pneumatic_lag", "delay")


@pytest.mark.parametrize(
    ("at_bound", "bic", "chosen"),
    [
        (["line_resonance_period"], 11.9, "sensor_lag"),
        (["line_resonance_period"], 12.1, "line_resonance"),
        (["line_resonance_zeta"], 11.9, "sensor_lag"),
        (["line_resonance_zeta"], 12.1, "line_resonance"),
        ([], 11.9, "line_resonance"),
    ],
)
def test_what_stands_for_another_is_chosen_last(
    at_bound: Sequence[str], bic: float, chosen: str
) -> None:
    """At the bound of its period a resonance is another law, and at the lower one of its damping no
    actuator's, so a rival within twelve comes first. It stays in the tie, for it explains as well.
    """
    rows = [
        ranked(("line_resonance",), 0.0, values={"line_resonance_zeta": 0.5}, at_bound=at_bound),
        ranked(("sensor_lag",), bic),
    ]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best.candidate.keys == (chosen,)
    assert ("line_resonance" in names) == (bic < 12.0 or chosen == "line_resonance")


@pytest.mark.parametrize(
    ("softness", "behind", "chosen"),
    [
        ("at_upper_bound", 11.9, "static_curve"),
        ("at_upper_bound", 12.1, "dead_zone"),
        ("at_bound", 11.9, "dead_zone"),
    ],
)
def test_a_dead_zone_that_is_no_threshold_is_not_cheaper_than_a_curve(
    softness: str, behind: float, chosen: str
) -> None:
    """At its softest it bends everywhere: three knots more cost the curve 28, and count for nought.

    A sharp one is a corner, and the price of the knots speaks for it.
    """
    price = 3.0 * np.log(SAMPLES)
    held = {softness: ["dead_zone_softness"]}
    rows = [
        ranked(("dead_zone",), 0.0, **held),
        ranked(("static_curve",), behind + price, unknowns=UNKNOWNS + 3),
    ]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best.candidate.keys == (chosen,)
    assert ("static_curve" in names, "dead_zone" in names) == (chosen == "static_curve", True)


@pytest.mark.parametrize(
    ("zeta", "gain", "names"),
    [
        (0.9, 1.0, ("line_resonance", "pneumatic_lag")),
        (1.1, 5.9, ("pneumatic_lag",)),
        (1.1, 6.1, ("line_resonance", "pneumatic_lag")),
        (1.1, -3.0, ("pneumatic_lag",)),
    ],
)
def test_a_line_that_does_not_ring_is_a_lag(
    zeta: float, gain: float, names: tuple[str, ...]
) -> None:
    """Beyond a damping ratio of 1 it must gain 6 of BIC on the lag, and is no rival to it else."""
    rows = [
        ranked(
            ("line_resonance",),
            0.0,
            values={"line_resonance_zeta": zeta, "line_resonance_period": 0.1},
        ),
        ranked(("pneumatic_lag",), gain),
    ]
    assert choose_contender(sorted(rows, key=lambda row: row.bic), BEFORE, PERIOD_S)[1] == names


@pytest.mark.parametrize(
    ("period_s", "zeta", "gain", "key"),
    [
        (0.12, 1.9, 45.0, "sensor_lag"),
        (0.12, 1.9, 55.0, "sensor_resonance"),
        (0.3, 1.9, 45.0, "sensor_resonance"),
        (0.12, 0.9, 45.0, "sensor_resonance"),
    ],
)
def test_what_goes_on_between_two_samples_tells_no_second_time_constant(
    period_s: float, zeta: float, gain: float, key: str
) -> None:
    """Of ζ = 1.9 and a period of 0.12 s the shorter time constant is 5.4 ms, half a sample: it must
    gain a twentieth of the 1000 that both explain. Of 0.3 s it is 14 ms, and gains its 6."""
    values = {"sensor_resonance_zeta": zeta, "sensor_resonance_period": period_s}
    rows = [ranked(("sensor_resonance",), 0.0, values=values), ranked(("sensor_lag",), gain)]
    assert choose_contender(rows, BEFORE, PERIOD_S)[0].candidate.keys == (key,)


@pytest.mark.parametrize(("bic", "is_told"), [(11.9, True), (12.1, False)])
def test_poles_of_a_sensor_are_told_beside_those_of_a_line(bic: float, is_told: bool) -> None:
    """Where both explain as much: the sensor's are found as two that do not ring, one of them
    within a sample, when the base of a linear motion has taken the others."""
    values = {
        "sensor_resonance_zeta": 1.5,
        "sensor_resonance_period": 0.1,
        "line_resonance_zeta": 0.5,
        "line_resonance_period": 0.14,
    }
    rows = [
        ranked(("sensor_resonance",), 0.0, values=values),
        ranked(("line_resonance",), bic, values=values),
        ranked(("sensor_lag",), 45.0),
    ]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best.candidate.keys == ("sensor_lag",)
    assert ("sensor_resonance" in names) is is_told


def test_effects_that_were_there_are_nochoose_contender() -> None:
    """In a second round only what each candidate adds is compared."""
    rows = [ranked(("delay", "creep"), 0.0), ranked(("delay", "ageing"), 2.0)]
    best, names = choose_contender(rows, ranked(("delay",), 1000.0), PERIOD_S)
    assert best is rows[0]
    assert names == ("creep", "ageing")


def beginning(rate: float, size: float) -> tuple[Candidate, Scale]:
    """The base at its optimum under a drift and a parabola of the reading, with noise."""
    time_s = linear_log().time_s
    added = rate * time_s + size * (time_s / time_s[-1]) ** 2
    problem = linear_problem([linear_log(noise=0.01, added=added)])
    z = problem.unknowns(TRUTH)
    return converged(standing(problem, z), SIGMA), scale_of(problem, z)


def test_nothing_is_tried_where_nothing_is_promised() -> None:
    """White noise alone: a curve of time promises a χ² of one degree, far below 6.

    A drift promises hundreds, and is tried.
    """
    base, scale = beginning(0.0, 0.0)
    assert screen(base, [DRIFT], scale, SIGMA)[0].drop < 0.006 * base.squares
    assert next_link(base, [DRIFT], scale, SIGMA, FIRST) is None
    base, scale = beginning(RATE, 0.0)
    found = next_link(base, [DRIFT], scale, SIGMA, FIRST)
    assert found is not None
    assert found.rivals == ("sensor_drift",)
    assert found.chosen.plain.parameters["sensor_drift_rate"] == pytest.approx(RATE, rel=0.1)
    assert found.squares_before == base.squares


def test_a_chain_finds_both_causes_and_ends() -> None:
    """Known truth: two curves of time that are both there, in 1000 samples of known noise.

    What is left is the noise, 1000·(0.01/σ)² with σ = 0.01, within four times √2000.
    """
    base, scale = beginning(RATE, SIZE)
    told: list[tuple[str, float]] = []
    chain = select_forward(
        base,
        [DRIFT, Bow()],
        scale,
        SIGMA,
        is_no_worse=lambda before, after: True,
        is_noise=lambda now: False,
        report=lambda message, fraction: told.append((message, fraction)),
    )
    assert {key for link_ in chain.links for key in link_.chosen.candidate.keys} == {
        "sensor_drift",
        "bow",
    }
    assert chain.final.squares == pytest.approx(1000.0, abs=180.0)
    assert chain.last is None
    assert [message for message, _ in told][:2] == ["looking for cause 1", "looking for cause 2"]
    assert [fraction for _, fraction in told] == sorted(fraction for _, fraction in told)


def test_what_is_held_out_may_refuse_a_link() -> None:
    """The round is kept as evidence, and the model stays without it."""
    base, scale = beginning(RATE, 0.0)
    asked = []

    def never(before: Candidate, after: Candidate) -> bool:
        asked.append((before.keys, after.keys))
        return False

    chain = select_forward(
        base, [DRIFT], scale, SIGMA, is_no_worse=never, is_noise=lambda now: False
    )
    assert asked == [((), ("sensor_drift",))]
    assert chain.links == ()
    assert chain.last is not None
    assert chain.final is base


def test_no_more_links_than_allowed() -> None:
    """The limit ends the chain with no round behind it."""
    base, scale = beginning(RATE, SIZE)
    chain = select_forward(
        base,
        [DRIFT, Bow()],
        scale,
        SIGMA,
        is_no_worse=lambda before, after: True,
        is_noise=lambda now: False,
        max_links=1,
    )
    assert len(chain.links) == 1
    assert chain.last is None


@pytest.mark.parametrize(("rate", "links"), [(RATE, 2), (0.5 * RATE, 1)])
def test_more_is_asked_of_a_cause_behind_noise(rate: float, links: int) -> None:
    """Two effects are there, but after the first nothing seems to be left to explain.

    A plain second one is found all the same; one whose BIC falls by about 41 is found only where
    something is seen to be left.
    """
    base, scale = beginning(rate, SIZE)
    found = [
        select_forward(
            base,
            [DRIFT, Bow()],
            scale,
            SIGMA,
            is_no_worse=lambda before, after: True,
            is_noise=is_noise,
        )
        for is_noise in (lambda now: True, lambda now: False)
    ]
    assert [len(chain.links) for chain in found] == [links, 2]
    if links == 1:
        assert 30.0 < found[1].links[1].delta_bic < 60.0


@pytest.mark.parametrize(
    ("reaches", "falls", "laps"),
    [
        ([0.9], 0.5, 1),
        ([1.1, 0.9], 0.5, 2),
        ([1.1, 1.1, 1.1], 0.5, 3),
        ([1.1], 0.9995, 1),
        ([1.1, 0.9], 0.998, 2),
    ],
)
def test_a_model_settles_while_it_is_on_its_way(
    reaches: list[float], falls: float, laps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """More than a standard error away it goes on, three times at most, and only while its sum of
    squares falls by a thousandth."""
    base, _ = beginning(0.0, 0.0)
    ahead = iter(reaches)

    def advanced(now: Candidate, sigma: Mapping[str, float], evaluations: int) -> Candidate:
        assert (now.minimum.damping, evaluations) == (None, CONVERGING)
        assert now.prior.centre == pytest.approx(now.minimum.point)
        normal = replace(now.minimum.normal, cost=0.5 * falls * now.squares)
        minimum = replace(now.minimum, normal=normal, offset=next(ahead), damping=1.0)
        return replace(now, minimum=minimum)

    monkeypatch.setattr(forward_selection, "advance", advanced)
    assert converged(base, SIGMA).squares == pytest.approx(falls**laps * base.squares, rel=1e-6)
    assert next(ahead, None) is None


def test_an_effect_is_added_once() -> None:
    """With every effect of the catalogue in the model there is no further round."""
    base, scale = beginning(RATE, 0.0)
    found = next_link(base, [DRIFT], scale, SIGMA, FIRST)
    assert found is not None
    assert next_link(found.chosen.plain, [DRIFT], scale, SIGMA, FIRST) is None
