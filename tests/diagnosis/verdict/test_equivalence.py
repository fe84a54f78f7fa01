"""Causes that are not told apart: by algebra, and by the logs at hand."""

from __future__ import annotations

import pytest

from softid.diagnosis.verdict.equivalence import (
    CLASSES,
    LINEAR_CLASSES,
    LINEAR_FILTERS,
    REPLACED,
    UNLISTED,
    classes_of,
)
from softid.diagnosis.verdict.laws_alike import LAWS_ALIKE
from softid.diagnosis.verdict.separations import (
    CHIRP,
    EXPERIMENTS,
    HOLD,
    SEPARATIONS,
    SINE,
    STEPS,
    Split,
    splitting_experiment,
    why_unsplit,
)
from softid.diagnosis.verdict.unlisted_laws import UNLISTED_LAWS
from softid.effects import EFFECTS

BEST = {
    ("delay", "pneumatic_lag"): (CHIRP, 4.9),
    ("delay", "sensor_lag"): (CHIRP, 4.8),
    ("line_resonance", "pneumatic_lag"): (CHIRP, 15.0),
    ("creep", "sensor_warmup"): (HOLD, 4.3),
    ("creep", "hysteresis"): (HOLD, 4.2),
    ("coulomb_friction", "hysteresis"): (STEPS, 3.7),
    ("softening", "ageing"): (SINE, 5.0),
    ("pressure_mass", "quadratic_damping"): (CHIRP, 3.1),
}


@pytest.mark.parametrize("pair", BEST)
def test_the_largest_separation_is_proposed(pair: tuple[str, str]) -> None:
    """Stands on the simulated separations: the largest of the row, in either order of the pair."""
    for names in (pair, pair[::-1]):
        split = splitting_experiment(names)
        assert split is not None
        assert (split.experiment, split.separation) == BEST[pair]


def test_three_causes_are_split_by_their_worst_known_pair() -> None:
    """By hand: of creep or lag against hysteresis the smaller is largest in fast steps, 3.0.

    Creep against a lag was not simulated, so no size is claimed.
    """
    split = splitting_experiment(("hysteresis", "pneumatic_lag", "creep"))
    assert split == Split(STEPS, None)


def test_causes_outside_the_table_are_shown_by_what_shows_each() -> None:
    """A pair of which nothing was simulated leaves the catalogue's own words."""
    split = splitting_experiment(("ageing", "creep"))
    assert split is not None
    assert split.separation is None
    assert EFFECTS["creep"].shown_by in split.experiment


def test_a_best_cause_that_was_not_simulated_beside_the_others_is_shown_by_its_own() -> None:
    """A pair further behind was, ageing and a drift of the gain; of six causes three are listed."""
    keys = ("sensor_drift", "sensor_warmup", "ageing", "sensor_gain_drift", "softening", "creep")
    split = splitting_experiment(keys)
    assert split == Split("; ".join(EFFECTS[key].shown_by for key in keys[:3]), None)


def test_variants_of_one_cause_need_no_split() -> None:
    """A richer law of the same cause is the same cause."""
    assert splitting_experiment(("pneumatic_lag", "pneumatic_lag.separate")) is None
    assert splitting_experiment(("delay",)) is None
    assert splitting_experiment(("mine", "yours")) is None


def test_tables_name_effects() -> None:
    """A name that is not in the catalogue would never be met; every row has all experiments."""
    names = {name for pair in SEPARATIONS for name in pair}
    names |= {name for known in (*CLASSES, *LINEAR_CLASSES) for name in known.effects}
    assert names <= set(EFFECTS)
    tied = {name for known in (*LINEAR_FILTERS, *LAWS_ALIKE, *REPLACED) for name in known.effects}
    assert tied - set(EFFECTS) | {law.name for law in UNLISTED_LAWS} == set(UNLISTED)
    assert {len(row) for row in SEPARATIONS.values()} == {len(EXPERIMENTS)}


def test_classes_of_algebra() -> None:
    """The four of the theory, and forces that go with the position, springs and weights."""
    assert len(CLASSES) == 5
    assert [c.members[1] for c in classes_of(["stiffening"])] == [
        "a load that goes with the position, such as a weight"
    ]
    assert [c.members[1] for c in classes_of(["delay", "creep"])] == [
        "an offset between the clocks of the two channels"
    ]
    assert classes_of(["pneumatic_lag.separate"])[0].effects == ("pneumatic_lag",)
    assert classes_of(["creep"]) == ()
    assert [c.effects for c in classes_of(["creep.series"], linear=True)] == [("creep",)]


def test_why_is_told_in_sentences() -> None:
    """With the experiment where one is known, and openly where none is."""
    assert why_unsplit(("delay", "pneumatic_lag")).endswith(
        "A chirp from slow to fast would tell them apart best."
    )
    assert "What shows each of them: " in why_unsplit(("ageing", "creep"))
    assert "No experiment is known" in why_unsplit(("mine", "yours"))
