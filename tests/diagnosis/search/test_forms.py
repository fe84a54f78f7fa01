"""What a law is like at the values that a race has given it."""

from __future__ import annotations

import numpy as np
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

from softid.diagnosis.base.base_fit import Request
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search.effect_starts import candidate_at
from softid.diagnosis.search.forms import is_twin, simpler_forms
from softid.diagnosis.search.forward_selection import converged
from softid.effects import effect_of
from softid.log import LogSet
from softid.synthesis import hidden_pair

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


@pytest.mark.parametrize(
    ("one", "other", "twins"),
    [
        ("line_resonance", "sensor_resonance", True),
        ("pneumatic_lag", "sensor_lag", True),
        ("line_resonance", "sensor_lag", False),
        ("delay", "pneumatic_lag", False),
        ("sensor_lag", "sensor_resonance", False),
    ],
)
def test_what_acts_before_and_behind_a_linear_model_alike(
    one: str, other: str, twins: bool
) -> None:
    """The same parameters, on the input and on the reading; in either order."""
    scale = scale_of(linear_problem([linear_log()]), linear_problem([linear_log()]).unknowns(TRUTH))
    for pair in ((one, other), (other, one)):
        effect, twin = (effect_of(key) for key in pair)
        assert is_twin(effect, twin, scale) is twins


def test_a_line_in_a_linear_model_is_tried_where_the_resonance_of_a_sensor_is() -> None:
    """Known truth: what drives the actuator rings; where a sensor's resonance stands, the line
    leaves the noise: 1000 within four times √2000."""
    log, ringing = linear_log(), {"period": 0.5, "zeta": 0.2}
    clean = linear_problem([log])
    z = clean.unknowns(TRUTH)
    scale, line = scale_of(clean, z), effect_of("line_resonance")
    eta = np.array(list(ringing.values()))
    fine_s = np.linspace(0.0, log.time_s[-1], 20 * (len(log) - 1) + 1)
    u = np.interp(fine_s, log.time_s, pressure_course(log.time_s))
    arriving = line.apply(eta, fine_s, u, scale)  # type: ignore[attr-defined]
    added = (linear_angle(fine_s, arriving) - linear_angle(fine_s, u))[::20]
    base = converged(standing(linear_problem([linear_log(noise=0.01, added=added)]), z), SIGMA)
    _, leader = candidate_at(base, effect_of("sensor_resonance"), ringing, scale, SIGMA)
    (found,) = simpler_forms(base, [leader], [line], scale, SIGMA)
    assert found.keys == ("line_resonance",)
    assert found.squares < 1180.0 < base.squares


def test_a_curve_is_tried_as_a_dead_zone() -> None:
    """Stands on the generator: where a curve of six knots has taken the dead zone's place, a dead
    zone explains as much with its two numbers; a creep is not asked."""
    pair = hidden_pair(["dead_zone"], seed=710008, size=2.0)
    request = Request("muscle", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet(pair.logs[:1]), pair.logs[1:], thorough=False)
    begun = dict(effect_of("static_curve").starts(base.scale)[0])
    _, start = candidate_at(
        base.candidate, effect_of("static_curve"), begun, base.scale, base.sigma
    )
    leader = converged(start, base.sigma)
    asked = [effect_of("dead_zone"), effect_of("creep")]
    found = simpler_forms(base.candidate, [leader], asked, base.scale, base.sigma)
    assert {form.keys for form in found} == {("dead_zone",)}
    best = min(found, key=lambda form: form.squares)
    assert best.squares < 1.01 * leader.squares < 0.9 * base.candidate.squares
    true = pair.hidden["dead_zone"]["p0"]
    assert best.parameters["dead_zone_p0"] == pytest.approx(true, rel=0.2)
