"""The race of candidate causes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from handmade_rounds import candidate
from linear_motion import (
    SIGMA,
    TRUTH,
    Array,
    Bow,
    linear_log,
    linear_problem,
    parabolic,
    standing,
)

from softid.diagnosis.refit.candidates import advance
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search.effect_starts import candidate_at
from softid.diagnosis.search.forms import by_themselves, is_richer
from softid.diagnosis.search.forward_selection import converged
from softid.diagnosis.search.racing import (
    _last_survivors,
    _starts,
    race,
)
from softid.diagnosis.search.screening import Signature
from softid.effects import effect_of
from softid.effects.scale import Scale
from softid.parameters import Parameter, ParameterSet

DRIFT = effect_of("sensor_drift")
NOTHING = np.zeros(0)


def promises(*rows: tuple[str, float]) -> list[Signature]:
    made = [Signature(effect_of(key), {}, drop, NOTHING) for key, drop in rows]
    return sorted(made, key=lambda s: -s.drop)


@pytest.mark.parametrize(
    ("drops", "run"),
    [
        ([10.0, 3.1], [10.0, 3.1]),
        ([10.0, 2.9], [10.0]),
        ([10.0, 9.0, 8.0], [10.0, 9.0]),
        ([0.0, 0.0], [0.0, 0.0]),
    ],
)
def test_two_starts_at_most_and_the_second_only_if_it_promises(
    drops: Sequence[float], run: Sequence[float]
) -> None:
    """Stands on the share of 0.3 of the best start's drop."""
    chosen = _starts(promises(*(("creep", drop) for drop in drops)))
    assert [s.drop for s in chosen] == list(run)


def test_starts_are_counted_for_each_effect() -> None:
    """Every effect runs, however little it promises against the others; a variant is another."""
    chosen = _starts(
        promises(
            ("creep", 100.0),
            ("delay", 1.0),
            ("delay", 0.9),
            ("delay", 0.8),
            ("pneumatic_lag", 50.0),
            ("pneumatic_lag.separate", 5.0),
        )
    )
    assert [(s.effect.key, s.drop) for s in chosen] == [
        ("creep", 100.0),
        ("pneumatic_lag", 50.0),
        ("pneumatic_lag.separate", 5.0),
        ("delay", 1.0),
        ("delay", 0.9),
    ]


def test_neighbours_of_the_leader_stay() -> None:
    """Four stay, and further down those for which the leader is easily taken, if they are near."""
    keys = ("pneumatic_lag", "creep", "ageing", "softening", "sensor_drift", "delay")
    field = [candidate((key,), 10.0 + k) for k, key in enumerate(keys)]
    assert "delay" in effect_of("pneumatic_lag").neighbours
    kept = [c.keys[0] for c in _last_survivors(field, (), 20.0, 20.0)]
    assert kept == [*keys[:4], "delay"]
    kept = [c.keys[0] for c in _last_survivors(field, (), 14.0, 14.0)]
    assert kept == list(keys[:4])


def test_who_names_the_leader_stays() -> None:
    """Smoothing names the sensor's lag as its neighbour, and not the other way round."""
    keys = ("sensor_lag", "creep", "ageing", "softening", "sensor_drift", "smoothing")
    field = [candidate((key,), 10.0 + k) for k, key in enumerate(keys)]
    kept = [c.keys[0] for c in _last_survivors(field, (), 20.0, 20.0)]
    assert kept == [*keys[:4], "smoothing"]


@pytest.mark.parametrize(("behind", "stays"), [(1e-4, True), (0.1, False)])
def test_neighbours_of_who_is_hardly_behind_stay(behind: float, stays: bool) -> None:
    """A moving average is taken for a resonance of the sensor, which is level with the delay that
    leads; n = 10,000 turns 0.01 % into 1 and 10 % into 950."""
    keys = ("delay", "sensor_resonance", "creep", "ageing", "softening", "smoothing")
    squares = (10.0, 10.0 * (1.0 + behind), 12.0, 13.0, 14.0, 15.0)
    field = [candidate((key,), value) for key, value in zip(keys, squares, strict=True)]
    kept = [c.keys[0] for c in _last_survivors(field, (), 20.0, 20.0)]
    assert ("smoothing" in kept) is stays


@pytest.mark.parametrize(
    ("plain", "separate", "runs"),
    [(0.0, 31.0, True), (0.0, 29.0, False), (20.0, 61.0, True), (20.0, 59.0, False)],
)
def test_a_richer_form_that_promises_far_more_runs_by_itself(
    plain: float, separate: float, runs: bool
) -> None:
    """By hand: thrice the plain one's promise, and 0.3 of the best one's, which is 100."""
    rows = (("stiffening", 100.0), ("pneumatic_lag", plain), ("pneumatic_lag.separate", separate))
    chosen = by_themselves(promises(*rows), [effect_of("pneumatic_lag.separate")])
    assert chosen == ({"pneumatic_lag.separate"} if runs else set())
    assert by_themselves(promises(rows[0]), [effect_of("pneumatic_lag.separate")]) == set()


@pytest.mark.parametrize(
    ("one", "other", "richer"),
    [
        ("pneumatic_lag.separate", "pneumatic_lag", True),
        ("pneumatic_lag", "pneumatic_lag.separate", False),
        ("pneumatic_lag", "pneumatic_lag", False),
        ("sensor_clipping.both", "sensor_clipping.lower", True),
        ("sensor_clipping.lower", "sensor_clipping", False),
        ("line_resonance", "pneumatic_lag", False),
    ],
)
def test_a_richer_form_has_more_parameters(one: str, other: str, richer: bool) -> None:
    """Of one law only: two times have the one time among them, the lower limit not the upper."""
    problem = linear_problem([linear_log(noise=0.01)])
    scale = scale_of(problem, problem.unknowns(TRUTH))
    assert is_richer(effect_of(one), effect_of(other), scale) is richer


@dataclass(frozen=True)
class Bent(Bow):
    """The parabola with a cubic term, + c (t/T)² + d (t/T)³."""

    variant: ClassVar[str] = "bent"

    def parameters(self, scale: Scale) -> ParameterSet:
        """Those of the parabola, and d of either sign."""
        return ParameterSet(
            (*super().parameters(scale).values(), Parameter("d", 0.0, "rad", -10.0, 10.0))
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """One."""
        return tuple({**start, "d": 0.0} for start in super().starts(scale))

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Add both."""
        bent: Array = super().apply(eta, time_s, y, scale) + eta[1] * (
            (time_s / scale.duration_s) ** 3
        )
        return bent


@pytest.mark.parametrize(("cubic", "found"), [(0.0, {"bow"}), (-0.2, {"bow.bent", "bow"})])
def test_a_richer_form_enters_where_the_plain_one_stands(cubic: float, found: set[str]) -> None:
    """Known truth: without a cubic term it leaves the race again, with one it wins it."""
    time_s = linear_log().time_s / linear_log().time_s[-1]
    log = linear_log(noise=0.01, added=0.3 * time_s**2 + cubic * time_s**3)
    problem = linear_problem([log])
    z = problem.unknowns(TRUTH)
    base = converged(standing(problem, z), SIGMA)
    rows = race(base, [Bow(), Bent()], scale_of(problem, z), SIGMA)
    assert {row.effects[-1].key for row in rows} == found
    if cubic:
        assert rows[0].effects[-1].key == "bow.bent"
        assert rows[0].parameters["bow_d"] == pytest.approx(cubic, abs=0.05)


@dataclass(frozen=True)
class Wave(Bow):
    """A reading that swings by itself, + c sin(w t)."""

    name: ClassVar[str] = "wave"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The size c and the rate w, in 1/s."""
        rate = Parameter("w", 2.0, "1", 0.1, 20.0, "log")
        return ParameterSet((*super().parameters(scale).values(), rate))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """One, at a rate from which no other is seen."""
        return tuple({**start, "w": 2.0} for start in super().starts(scale))

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Swing."""
        del scale
        swinging: Array = y + eta[0] * np.sin(eta[1] * time_s)
        return swinging


@dataclass(frozen=True)
class FadingWave(Wave):
    """One that fades away, + c exp(-d t) sin(w t)."""

    variant: ClassVar[str] = "fading"

    def parameters(self, scale: Scale) -> ParameterSet:
        """Those of the wave, and the decay d."""
        return ParameterSet((*super().parameters(scale).values(), Parameter("d", 0.0, "1", 0, 1)))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """One."""
        return tuple({**start, "d": 0.1} for start in super().starts(scale))

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Swing and fade."""
        fading = np.array([1.0, eta[1]])
        swinging: Array = y + eta[0] * np.exp(-eta[2] * time_s) * super().apply(
            fading, time_s, np.zeros_like(y), scale
        )
        return swinging


@pytest.mark.parametrize("led", [False, True])
def test_a_plain_law_follows_its_richer_form(led: bool) -> None:
    """Known truth: a wave of 5/s, which the plain law does not see from its own start of 2/s.

    Where the richer form has found it, the plain one leaves the noise, too: 1000 within four times
    √2000. By itself it leaves the wave, of a power of ½·0.1²/0.01² = 50 for each sample.
    """
    swing = 0.1 * np.sin(5.0 * linear_log().time_s)
    problem = linear_problem([linear_log(noise=0.01, added=swing)])
    z = problem.unknowns(TRUTH)
    base, scale = converged(standing(problem, z), SIGMA), scale_of(problem, z)
    right = {"c": 0.1, "w": 5.0, "d": 0.0}
    _, found = candidate_at(base, FadingWave(), right, scale, SIGMA)
    effects = [Wave(), FadingWave()] if led else [Wave()]
    known = [advance(found, SIGMA, 8)] if led else []
    rows = race(base, effects, scale, SIGMA, known=known)
    plain = next(row for row in rows if row.effects[-1].key == "wave")
    if led:
        assert plain.squares == pytest.approx(1000.0, abs=180.0)
        assert plain.parameters["wave_w"] == pytest.approx(5.0, abs=0.01)
    else:
        assert plain.squares > 20_000.0


def test_a_race_that_ran_already_is_not_run_again() -> None:
    """Who is neither known nor from elsewhere stays away; who is known ends where it stood."""
    base, scale = parabolic()
    first = race(base, [DRIFT, Bow()], scale, SIGMA)
    drift = [row for row in first if row.keys == (DRIFT.key,)]
    rows = race(base, [DRIFT, Bow()], scale, SIGMA, known=drift, again=True)
    assert [row.keys for row in rows] == [(DRIFT.key,)]
    assert rows[0].squares == pytest.approx(drift[0].squares, rel=1e-6)


def test_what_is_known_joins_for_the_last_rounds() -> None:
    """It wins as it would from its start, and its effect is not run a second time."""
    base, scale = parabolic()
    (plain,) = (row for row in race(base, [DRIFT, Bow()], scale, SIGMA) if row.keys == ("bow",))
    rows = race(base, [DRIFT, Bow()], scale, SIGMA, known=[plain])
    assert rows[0].keys == ("bow",)
    assert rows[0].squares == pytest.approx(plain.squares, rel=1e-4)


def test_what_began_elsewhere_gets_near_before_anyone_drops_out() -> None:
    """Known truth: a wave of 6/s, handed in at 5.8/s, over a parabola that leads until it is near.

    By itself the wave begins at 2/s, from where it is not found.
    """
    time_s = linear_log().time_s
    added = 0.1 * np.sin(6.0 * time_s) + 0.2 * (time_s / time_s[-1]) ** 2
    problem = linear_problem([linear_log(noise=0.01, added=added)])
    z = problem.unknowns(TRUTH)
    base, scale = converged(standing(problem, z), SIGMA), scale_of(problem, z)
    _, elsewhere = candidate_at(base, Wave(), {"c": 0.1, "w": 5.8}, scale, SIGMA)
    effects = [DRIFT, Bow(), Wave()]
    assert race(base, effects, scale, SIGMA)[0].keys == ("bow",)
    rows = race(base, effects, scale, SIGMA, extra=[elsewhere])
    assert rows[0].keys == ("wave",)
    assert rows[0].parameters["wave_w"] == pytest.approx(6.0, abs=0.05)


def test_the_race_goes_to_the_true_cause() -> None:
    """Known truth: a parabola of 0.05 under noise of 0.01, against a straight drift."""
    base, scale = parabolic()
    found = race(base, [DRIFT, Bow()], scale, SIGMA)
    assert found[0].keys == ("bow",)
    assert found[0].parameters["bow_c"] == pytest.approx(0.05, abs=0.01)
    assert found[0].squares < base.squares


def test_a_race_that_nobody_wins_ends_early() -> None:
    """On white noise two rounds show that nothing is gained; one candidate is handed back."""
    problem = linear_problem([linear_log(noise=0.01)])
    z = problem.unknowns(TRUTH)
    base = converged(standing(problem, z), SIGMA)
    found = race(base, [DRIFT, Bow()], scale_of(problem, z), SIGMA)
    assert len(found) == 1
