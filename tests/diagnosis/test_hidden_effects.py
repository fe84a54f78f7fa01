"""An effect is hidden in a log by code apart from the fitter's, and must be found by name."""

from __future__ import annotations

import pytest

from softid.diagnoses import Verdict
from softid.diagnosis import diagnose
from softid.effects import EFFECTS
from softid.synthesis import hidden_pair

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


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 108))
@pytest.mark.parametrize("name", sorted({key for key in EFFECTS if "." not in key}))
def test_every_hidden_effect_is_found(name: str, seed: int) -> None:
    """Stands on the generator's truth, for eight draws of every effect."""
    hide_and_find(name, seed)
