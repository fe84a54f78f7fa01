"""Earlier links of a chain, seen again in the light of the later ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import bent_readings
import numpy as np
import pytest
from bent_readings import base_with
from handmade_rounds import candidate, link, ranked
from linear_motion import SIGMA, TRUTH, Array, Bow, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.search import backward_revision
from softid.diagnosis.search.backward_revision import (
    _is_beyond_doubt,
    _with_first_look,
    _without_stepping_stone,
    refit_without,
    revised,
)
from softid.diagnosis.search.forward_selection import Chain, converged
from softid.diagnosis.search.screening import Signature
from softid.effects import effect_of
from softid.effects.scale import Scale

DRIFT = effect_of("sensor_drift")


@dataclass(frozen=True)
class Swing(Bow):
    """Half a swing over the log, + c sin(π t/T): near a parabola once a drift is free as well."""

    name: ClassVar[str] = "swing"
    changes_sign: ClassVar[bool] = True

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Add the swing."""
        swung: Array = y + eta[0] * np.sin(np.pi * time_s / scale.duration_s)
        return swung


@dataclass(frozen=True)
class SteeperBow(Bow):
    """Another form of the same effect, + c (t/T)⁴."""

    variant: ClassVar[str] = "steeper"

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Add the curve."""
        bent: Array = y + eta[0] * (time_s / scale.duration_s) ** 4
        return bent


CATALOGUE = (DRIFT, Bow(), Swing(), SteeperBow())


PROMISES = (("delay", 60.0), ("creep", 30.0))


def chained(base: Candidate, scale: Scale, *keys: str) -> Chain:
    known = {effect.key: effect for effect in CATALOGUE}
    return bent_readings.chained(base, scale, [known[key] for key in keys])


def test_true_causes_stay() -> None:
    """Both are there: each is found again with the other in the model, and the end is the same."""
    base, scale = base_with(rate=0.01, size=0.2)
    before = chained(base, scale, "sensor_drift", "bow")
    after = revised(before, base, (DRIFT, Bow()), scale, SIGMA)
    assert len(after.links) == 2
    assert set(after.final.keys) == {"sensor_drift", "bow"}
    assert after.final.squares == pytest.approx(before.final.squares, rel=1e-3)
    assert after.final.parameters["sensor_drift_rate"] == pytest.approx(0.01, abs=0.002)


def test_a_first_cause_that_the_second_explains_is_dropped() -> None:
    """Only the parabola is there. A drift came first for want of it, and pays no more."""
    base, scale = base_with(size=0.2)
    before = chained(base, scale, "sensor_drift", "bow")
    after = revised(before, base, (DRIFT, Bow()), scale, SIGMA)
    assert [link.chosen.candidate.keys for link in after.links] == [("sensor_drift", "bow")]
    assert after.final.keys == ("bow",)
    assert after.final.parameters["bow_c"] == pytest.approx(0.2, abs=0.01)
    assert after.final.squares == pytest.approx(1000.0, abs=180.0)


def test_a_wrong_first_cause_is_exchanged() -> None:
    """A parabola and a drift are there; half a swing came first and stood for the parabola."""
    base, scale = base_with(rate=0.02, size=0.5)
    before = chained(base, scale, "swing", "sensor_drift")
    after = revised(before, base, CATALOGUE, scale, SIGMA)
    assert set(after.final.keys) == {"sensor_drift", "bow"}
    assert after.final.squares < before.final.squares
    assert after.final.squares == pytest.approx(1000.0, abs=180.0)


@pytest.mark.parametrize(("power", "found"), [(2, "bow"), (4, "bow.steeper")])
def test_the_form_of_a_cause_beyond_doubt_is_asked_again(
    power: int, found: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Known truth: which power fits is seen with the drift known. No other effect is tried."""
    monkeypatch.setattr(backward_revision, "_is_beyond_doubt", lambda link, final: True)
    base, scale = base_with(rate=0.02, size=0.5, power=power)
    before = chained(base, scale, "bow", "sensor_drift")
    after = revised(before, base, CATALOGUE, scale, SIGMA)
    assert set(after.final.keys) == {"sensor_drift", found}
    tried = {key for row in after.links[0].ranked for key in row.candidate.keys}
    assert "swing" not in tried


@pytest.mark.parametrize(
    ("left", "rival", "doubt"), [(47.0, 90.0, False), (46.0, 90.0, True), (47.0, 58.0, True)]
)
def test_what_led_by_far_is_not_asked_again(left: float, rival: float, doubt: bool) -> None:
    """The link takes 50 of 100. Later ones take 3 or 4 more; three times that is 9 or 12.

    A rival 8 behind may belong there; so may one that left early, at least 10 behind.
    """
    first = link(2000.0, before=100.0, after=50.0)
    other = ranked(("creep",), 0.0, rival)
    looked_at = (Signature(effect_of("creep"), {}, 1.0, np.zeros(0)),)
    ranking = (first.chosen, other, first.before)
    asked = replace(first, ranked=ranking, signatures=looked_at)
    assert _is_beyond_doubt(asked, candidate(("delay", "ageing"), left)) is not doubt


def test_what_was_looked_at_first_stays_in_the_evidence() -> None:
    """An effect that is not asked again keeps its share of the misfit; the other has a new one."""
    first = link(2000.0, before=100.0, after=50.0)
    looks = [Signature(effect_of(key), {}, drop, np.zeros(0)) for key, drop in PROMISES]
    asked = replace(first, signatures=tuple(looks))
    again = replace(first, signatures=(replace(looks[0], drop=5.0),), squares_before=50.0)
    found = _with_first_look(again, asked)
    told = {s.effect.key: s.drop / found.squares_before for s in found.signatures}
    assert told == {"delay": 0.1, "creep": pytest.approx(0.3)}


def test_a_single_link_is_not_asked_again() -> None:
    """Nothing came after it that could change the answer."""
    base, scale = base_with(rate=0.01)
    before = chained(base, scale, "sensor_drift")
    after = revised(before, base, CATALOGUE, scale, SIGMA)
    assert after.links == before.links
    assert after.final is before.final


def test_a_cause_is_left_out() -> None:
    """The model with the other one alone, as well as it can: that of a search for it only."""
    base, scale = base_with(rate=0.01, size=0.05)
    chain = chained(base, scale, "sensor_drift", "bow")
    for position, other in ((0, "bow"), (1, "sensor_drift")):
        found = refit_without(chain, position, base, scale, SIGMA)
        (alone,) = chained(base, scale, other).links
        assert found.keys == (other,)
        assert found.squares == pytest.approx(alone.chosen.plain.squares, rel=1e-3)


@pytest.mark.parametrize(
    ("size", "times", "stays"),
    [(0.0, 5.0, False), (0.0, 1.05, True), (1.0, 5.0, True)],
)
def test_a_last_cause_that_only_led_elsewhere_is_left_out(
    size: float, times: float, stays: bool
) -> None:
    """A bow found at an optimum that leaves so many times as much, and a swing that moved it.

    The swing goes where it has shrunk to nothing, and stays where the bow was found at this place,
    or where it explains something by itself.
    """
    time_s = linear_log().time_s
    share = time_s / time_s[-1]
    added = 0.3 * share**2 + 0.1 * size * np.sin(np.pi * share)
    problem = linear_problem([linear_log(noise=0.01, added=added)])
    z = problem.unknowns(TRUTH)
    base, scale = converged(standing(problem, z), SIGMA), scale_of(problem, z)
    chain = chained(base, scale, "bow")
    bow, both = chain.final, extend(base.problem, (Bow(), Swing()), scale)
    begin = start_unknowns(both, bow.problem, bow.minimum.point, {"swing_c": 1e-3})
    final = converged(replace(standing(both, begin), effects=(Bow(), Swing())), SIGMA)
    normal = replace(final.minimum.normal, cost=times * final.minimum.normal.cost)
    worse = replace(bow, minimum=replace(bow.minimum, normal=normal))
    last = replace(chain.links[0], before=replace(chain.links[0].chosen, plain=worse))
    whole = Chain((chain.links[0], last), None, final)
    found = _without_stepping_stone(whole, base, scale, SIGMA)
    assert len(found.links) == (2 if stays else 1)
    assert found.final.keys == (("bow", "swing") if stays else ("bow",))
