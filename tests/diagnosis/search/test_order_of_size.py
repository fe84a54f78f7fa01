"""The causes of a chain in the order of what each takes away."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

import bent_readings
import pytest
from bent_readings import base_with
from handmade_rounds import candidate, link
from linear_motion import SIGMA, Bow

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.search.order_of_size import largest_first, prefix_models
from softid.effects import effect_of
from softid.effects.scale import Scale

DRIFT = effect_of("sensor_drift")


def chained(base: Candidate, scale: Scale, *keys: str) -> Chain:
    known = {effect.key: effect for effect in (DRIFT, Bow())}
    return bent_readings.chained(base, scale, [known[key] for key in keys])


@pytest.mark.parametrize(
    ("rate", "size", "first"), [(0.1, 0.3, "sensor_drift"), (0.003, 2.0, "bow")]
)
@pytest.mark.parametrize("found", [("bow", "sensor_drift"), ("sensor_drift", "bow")])
def test_the_larger_cause_is_first(
    rate: float, size: float, first: str, found: tuple[str, str]
) -> None:
    """Known truth: whichever was found first, the one that does more by itself leads."""
    base, scale = base_with(rate=rate, size=size)
    chain = largest_first(chained(base, scale, *found), base, scale, SIGMA)
    assert chain.links[0].added.key == first
    models = prefix_models(chain, base)
    assert [set(model.keys) for model in models] == [set(), {first}, set(found)]
    assert models[0] is base
    assert models[-1] is chain.final
    alone = chained(base, scale, first).final
    assert models[1].squares == pytest.approx(alone.squares, rel=1e-3)
    left = [link.left_before for link in chain.links]
    assert left == [base.squares, models[1].squares]


@pytest.mark.parametrize(("creep", "first"), [(99.5, "delay"), (98.0, "creep")])
def test_causes_that_do_as_much_stay_as_they_were_found(creep: float, first: str) -> None:
    """A delay was found before a creep, which goes before it only if it clearly does more."""
    links = (link(80.0, after=100.0), link(80.0, after=creep, key="creep"))
    found = Chain(links, None, candidate(("delay", "creep"), 10.0))
    ordered = largest_first(found, candidate((), 1000.0), cast("Scale", None), SIGMA)
    assert ordered.links[0].added.key == first


def test_a_model_of_the_search_stands_for_the_first_causes() -> None:
    """A refit from where all causes stand may stop at a worse optimum than the search found."""
    base, scale = base_with(rate=0.1, size=0.2)
    chain = chained(base, scale, "sensor_drift", "bow")
    first, second = chain.links
    alone = first.found
    first = replace(first, chosen=replace(first.chosen, plain=chain.final))
    again = largest_first(replace(chain, links=(first, second)), base, scale, SIGMA)
    assert prefix_models(again, base)[1] is alone


def test_one_cause_or_none_stays() -> None:
    """There is no order of less than two."""
    base, scale = base_with(rate=0.1, size=0.0)
    nothing, one = Chain((), None, base), chained(base, scale, "sensor_drift")
    assert largest_first(nothing, base, scale, SIGMA).links == ()
    (only,) = largest_first(one, base, scale, SIGMA).links
    assert only.found is one.final
    assert only.left_before == base.squares
