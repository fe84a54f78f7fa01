"""An effect is hidden in a log by code apart from the fitter's, and must be found by name."""

from __future__ import annotations

import pytest

from softid.diagnoses import Verdict
from softid.diagnosis import diagnose
from softid.effects import EFFECTS
from softid.synthesis import hidden_pair
from softid.synthesis.hidden import names_of
from softid.synthesis.rig import Rig

FROM_TRUTH = 0.2
"""A parameter counts as recovered within its interval or a fifth of the truth."""

NOISE_SHARE = 1.1
"""The true structure leaves the noise; nine tenths of its gain leave little more."""


def test_clean_data_are_adequate() -> None:
    """Stands on the truth of the generator: nothing is hidden, so nothing may be named."""
    pair = hidden_pair([], seed=7)
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    assert found.verdict is Verdict.ADEQUATE
    assert not found.causes


def hide_and_find(name: str, seed: int) -> None:
    pair = hidden_pair([name], seed=seed)
    train, hold_out = pair.logs
    found = diagnose(train, hold_out=[hold_out], model="muscle")
    told = {cause.effect for cause in found.causes}
    tied = {effect for alternative in found.alternatives for effect in alternative.effects}
    assert found.verdict in (Verdict.NAMED, Verdict.AMBIGUOUS)
    assert name in told | tied
    if found.verdict is Verdict.NAMED:
        assert told == {name}
        truth = pair.hidden[name]
        for estimate in found.causes[0].parameters:
            true = truth.get(estimate.name.removeprefix(f"{name}_"))
            if true is None:
                continue
            inside = estimate.ci95 is not None and estimate.ci95[0] <= true <= estimate.ci95[1]
            assert inside or abs(estimate.value - true) <= FROM_TRUTH * abs(true)
    noise = next(iter(pair.hold_out.sigma[c] for c in pair.hold_out.sigma if "pressure" not in c))
    assert found.causes[-1].holdout_rmse_after <= NOISE_SHARE * noise


@pytest.mark.parametrize("name", ["creep", "sensor_clipping"])
def test_a_hidden_effect_is_found(name: str) -> None:
    """Stands on the generator's truth; the seed is arbitrary."""
    hide_and_find(name, seed=7)


def test_two_hidden_effects_are_both_found() -> None:
    """Stands on the generator's truth: a lag and a drift hide each other in nothing."""
    assert set(told_of(["sensor_drift", "delay"], seed=7)) == {"sensor_drift", "delay"}


def test_what_the_catalogue_does_not_know_is_not_named() -> None:
    """Stands on the generator's truth: a gain that swings in time is no effect of the catalogue."""
    assert told_of(["periodic_gain"], seed=7) == ()


def test_a_slow_sine_does_not_split_delay_and_lag() -> None:
    """Stands on algebra: at one frequency a delay and a lag turn the phase alike."""
    pair = hidden_pair(["delay"], seed=7, protocol="sine")
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    assert found.verdict is Verdict.AMBIGUOUS
    assert {"delay", "pneumatic_lag"} <= set(found.alternatives[0].effects)


def told_of(names: list[str], seed: int) -> tuple[str, ...]:
    pair = hidden_pair(names, seed=seed)
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    return tuple(cause.effect for cause in found.causes)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 108))
@pytest.mark.parametrize(
    "names",
    [
        ["delay", "creep"],
        ["pneumatic_lag", "coulomb_friction"],
        ["hysteresis", "sensor_drift"],
        ["sensor_clipping", "contact"],
    ],
    ids="+".join,
)
def test_pairs_are_found(names: list[str], seed: int) -> None:
    """Stands on the generator's truth, for eight draws of pairs of different kinds."""
    assert set(told_of(names, seed)) == set(names)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 104))
@pytest.mark.parametrize("name", names_of("outside"))
def test_nothing_outside_the_catalogue_is_misnamed(name: str, seed: int) -> None:
    """Stands on the generator's truth: none of these laws is in the catalogue."""
    assert told_of([name], seed) == ()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 108))
def test_clean_data_stay_adequate(seed: int) -> None:
    """Stands on the generator's truth, with noise that is white and with 90 % coloured noise."""
    for rig in (Rig(), Rig(coloured_share=0.9, rest_s=30.0)):
        pair = hidden_pair([], seed=seed, rig=rig)
        found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
        assert found.verdict is Verdict.ADEQUATE


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 108))
@pytest.mark.parametrize("name", sorted({key for key in EFFECTS if "." not in key}))
def test_every_hidden_effect_is_found(name: str, seed: int) -> None:
    """Stands on the generator's truth, for eight draws of every effect."""
    hide_and_find(name, seed)
