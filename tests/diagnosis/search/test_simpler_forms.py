"""What a law is like at the values that a race has given it."""

from __future__ import annotations

import pytest
from linear_motion import (
    SIGMA,
    TRUTH,
    linear_angle,
    linear_log,
    linear_problem,
    pressure_course,
    standing,
)

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search.effect_starts import candidate_at
from softid.diagnosis.search.forms import simpler_forms
from softid.diagnosis.search.forward_selection import converged
from softid.effects import effect_of

LAG, DRIFT = effect_of("sensor_lag"), effect_of("sensor_drift")


@pytest.mark.parametrize(("zeta", "keys"), [(2.9, [("sensor_lag",)]), (0.9, [])])
def test_an_overdamped_resonance_is_tried_as_a_lag(zeta: float, keys: list[object]) -> None:
    """Known truth: a reading that lags by 0.3 s.

    From a resonance of the slower time constant 0.32 (2.9 + √(2.9² − 1))/2π = 0.29 s the lag leaves
    the noise: 1000 within four times √2000.
    """
    clean = linear_problem([linear_log()])
    z = clean.unknowns(TRUTH)
    scale, time_s = scale_of(clean, z), linear_log().time_s
    angle = linear_angle(time_s, pressure_course(time_s))
    tau = LAG.parameters(scale).with_values({"tau": 0.3}).values_vector()
    late = LAG.apply(tau, time_s, angle, scale) - angle  # type: ignore[attr-defined]
    problem = linear_problem([linear_log(noise=0.01, added=late)])
    base = converged(standing(problem, z), SIGMA)
    begun = {"period": 0.32, "zeta": zeta}
    _, leader = candidate_at(base, effect_of("sensor_resonance"), begun, scale, SIGMA)
    found = simpler_forms(base, [leader], [LAG, DRIFT], scale, SIGMA)
    assert [form.keys for form in found] == keys
    assert all(form.squares < 1180.0 for form in found)
