"""The chain of causes: what counts, what is as good, and when it ends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest
from handmade_rounds import link
from linear_motion import SIGMA, TRUTH, Bow, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search import forward_selection
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
