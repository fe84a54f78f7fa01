"""A creep and a hysteresis of another form are two laws; a creep with many times is one."""

from __future__ import annotations

import pytest

from softid.diagnosis.workflow import diagnose
from softid.diagnosis_results import Diagnosis, Verdict
from softid.synthesis import hidden_pair

BOTH = ("creep", "hysteresis")


def found_in(names: list[str], seed: int, size: float) -> Diagnosis:
    log, judge = hidden_pair(names, seed=seed, size=size).logs
    return diagnose(log, hold_out=[judge], model="muscle", effects=BOTH)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_both_act_though_one_is_not_of_the_catalogue(seed: int) -> None:
    """Four elements that slip, beside a creep: a hysteresis leaves more than noise of them."""
    found = found_in(["maxwell_slip", "creep"], seed, 4.0)
    assert found.remainder.excess > 0.1
    assert found.verdict is Verdict.PARTIAL
    assert sorted(cause.effect for cause in found.causes) == [*BOTH]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 4])
def test_a_creep_with_many_times_is_no_hysteresis(seed: int) -> None:
    """A fractional creep: two creeps leave less of it than a creep and a hysteresis."""
    found = found_in(["fractional_damping"], seed, 1.0)
    assert found.remainder.excess > 0.1
    assert "hysteresis" not in [cause.effect for cause in found.causes]
