"""A resonance or a lag that is the actuator's own, before an actuator that follows at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import RATE_HZ, TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.verdict.displacement import behind, displacing
from softid.effects import effect_of
from softid.log import Log

PERIOD_S = 2.0 * np.pi * float(np.sqrt(TRUTH["M"] / TRUTH["Q"]))
ZETA = TRUTH["N"] / (2.0 * float(np.sqrt(TRUTH["M"] * TRUTH["Q"])))


@pytest.mark.parametrize(
    ("name", "times", "left", "found"),
    [
        ("line_resonance", (1.0, 1.0), 1e-3, True),
        ("sensor_resonance", (1.0, 1.0), 1e-3, True),
        ("line_resonance", (1.3, 1.0), 1e-3, False),
        ("line_resonance", (1.0, 1.3), 1e-3, False),
        ("line_resonance", (1.0, 1.0), 0.5, False),
    ],
)
def test_a_resonance_with_the_times_of_the_motion_displaces_it(
    name: str, times: tuple[float, float], left: float, found: bool
) -> None:
    """Known truth: its period and damping times those of the actuator, whose own are so short."""
    problem = linear_problem([linear_log()])
    z = problem.unknowns(TRUTH)
    base, scale, effect = standing(problem, z), scale_of(problem, z), effect_of(name)
    extended = extend(problem, (effect,), scale)
    values = {f"{name}_period": times[0] * PERIOD_S, f"{name}_zeta": times[1] * ZETA}
    point = start_unknowns(extended, problem, z, values)
    point[extended.free.index("N")] += np.log(left)
    point[extended.free.index("M")] += 2.0 * np.log(left)
    final = replace(standing(extended, point), effects=(effect,))
    assert displacing(final, base) == (frozenset({name}) if found else frozenset())


@pytest.mark.parametrize(
    ("tau_s", "mass", "left", "found"),
    [
        (0.2, 0.01, 1e-3, True),
        (0.215, 0.01, 1e-3, True),
        (0.23, 0.01, 1e-3, False),
        (0.2, 1.0, 1e-3, False),
        (0.2, 0.01, 0.5, False),
    ],
)
@pytest.mark.parametrize("name", ["pneumatic_lag", "sensor_lag"])
def test_a_lag_as_slow_as_a_motion_of_first_order_displaces_it(
    name: str, tau_s: float, mass: float, left: float, found: bool
) -> None:
    """Known truth: N/Q is 0.2 s; with a mass of 1, √(M/Q) is 0.7 of it, and the motion swings."""
    truth = {**TRUTH, "M": mass}
    problem = linear_problem([linear_log()])
    z = problem.unknowns(truth)
    base, scale, lag, curve = (
        standing(problem, z),
        scale_of(problem, z),
        effect_of(name),
        effect_of("static_curve"),
    )
    extended = extend(extend(problem, (lag,), scale), (curve,), scale)
    curved = {f"static_curve_k{k}": 0.0 for k in range(2, 7)}
    point = start_unknowns(extended, problem, z, {f"{name}_tau": tau_s, **curved})
    point[extended.free.index("N")] += np.log(left)
    point[extended.free.index("M")] += 2.0 * np.log(left)
    final = replace(standing(extended, point), effects=(lag, curve))
    displaced_by = displacing(final, base)
    assert displaced_by == (frozenset({name}) if found else frozenset())
    expected = {"static_curve"} if found and name == "pneumatic_lag" else set[str]()
    assert behind(final, displaced_by) == expected


@pytest.mark.parametrize("left", [1e-3, 0.05])
def test_what_is_left_of_a_motion_does_not_depend_on_the_order_of_the_logs(left: float) -> None:
    """Two rates: of N/Q = 0.2 s a twentieth, 10 ms, is left; it is below the 20 ms of one log, but
    not below the 5 ms of the other, which sees it."""
    slow = linear_log()
    pressure, angle = (slow.channels[name].values for name in ("pressure", "angle"))
    quick_s = np.arange(4 * len(slow) - 3) / (4.0 * RATE_HZ)
    channels = {
        name: np.interp(quick_s, slow.time_s, values)
        for name, values in (("pressure", pressure), ("angle", angle))
    }
    quick = Log.from_arrays(quick_s, channels, name="quick")
    lag = effect_of("pneumatic_lag")
    for logs in ((slow, quick), (quick, slow)):
        problem = linear_problem(logs)
        z = problem.unknowns({**TRUTH, "M": 0.01})
        extended = extend(problem, (lag,), scale_of(problem, z))
        point = start_unknowns(extended, problem, z, {"pneumatic_lag_tau": 0.2})
        point[extended.free.index("N")] += np.log(left)
        point[extended.free.index("M")] += 2.0 * np.log(left)
        final = replace(standing(extended, point), effects=(lag,))
        expected = {"pneumatic_lag"} if left < 0.01 else set[str]()
        assert displacing(final, standing(problem, z)) == expected
