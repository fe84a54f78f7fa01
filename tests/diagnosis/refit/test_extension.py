"""Models with effects added, over the logs of the model that they extend."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import MODEL, TRUTH, base_problem, linear_log, linear_problem
from scipy.integrate import solve_ivp

from softid.diagnosis import diagnose
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, named_values, start_unknowns
from softid.effects import effect_of
from softid.fitters.problem import Problem
from softid.log import Log

Array = npt.NDArray[np.float64]

AGEING, DRIFT, LAG, FRICTION = (
    effect_of(name) for name in ("ageing", "sensor_drift", "pneumatic_lag", "coulomb_friction")
)
KNOWN = ("M", "N", "Q")


def test_effects_are_added_to_those_that_are_there() -> None:
    """One model with both, not a model in a model; the base's own bounds and values stay."""
    base, scale = base_problem()
    narrow = replace(base.parameters["N"], lower=1.0, upper=20.0)
    base = Problem(base.model, base.parameters.replacing(narrow), base.logs)
    both = extend(extend(base, [DRIFT], scale), [LAG], scale)
    assert both.model.model is MODEL or both.model.model == MODEL
    assert {effect.key for effect in both.model.effects} == {"sensor_drift", "pneumatic_lag"}
    assert both.parameters["N"] == narrow
    assert set(both.free) == {*KNOWN, "sensor_drift_rate", "pneumatic_lag_tau"}


def test_a_drive_with_friction_has_no_rest() -> None:
    """Without a spring no position is at rest; that is no division by zero, whatever is added."""
    base, scale = base_problem()
    drive = replace(MODEL, spring="none")
    free = Problem(drive, drive.parameters(), base.logs)
    with np.errstate(all="raise"):
        problem = extend(free, [FRICTION], scale)
    assert not problem.has_equilibrium
    assert not problem.zeros


def test_start_keeps_what_the_base_knows() -> None:
    """By name, with zeros and states behind; added values as logarithms, inside their bounds."""
    base, scale = base_problem()
    z = base.unknowns(TRUTH) + np.array([0.1, 0.2, 0.3, 0.4])
    problem = extend(base, [DRIFT, LAG], scale)
    values = named_values(LAG, {"tau": 0.07}) | named_values(DRIFT, {"rate": 1e9})
    start = start_unknowns(problem, base, z, values)
    at = dict(zip(problem.free, start.tolist(), strict=False))
    assert [at[name] for name in KNOWN] == z[:3].tolist()
    assert start[-1] == z[-1]
    assert problem.parameters["pneumatic_lag_tau"].scale == "log"
    assert at["pneumatic_lag_tau"] == pytest.approx(np.log(0.07))
    assert at["sensor_drift_rate"] == problem.parameters["sensor_drift_rate"].upper


def test_start_has_the_states_of_every_segment_behind() -> None:
    """A log that does not begin at rest brings two states, which stay with their zero."""
    base = linear_problem([linear_log(noise=0.01).between(1.5, 15.0)])
    scale = scale_of(base, base.unknowns(TRUTH))
    z = base.unknowns(TRUTH)
    z[-3:] = [0.5, 0.6, 0.7]
    problem = extend(base, [DRIFT], scale)
    assert start_unknowns(problem, base, z, {"sensor_drift_rate": 0.0})[-3:].tolist() == [
        0.5,
        0.6,
        0.7,
    ]


def test_what_counts_the_position_frees_where_it_is_zero() -> None:
    """The offset that a spring holds is open beside an ageing, and begins where it was held.

    Beside a drift it is not, nor where the user holds it elsewhere, and it stays open in what
    extends the model further.
    """
    base, scale = base_problem()
    assert "offset" not in extend(base, [DRIFT], scale).free
    aged = extend(base, [AGEING], scale)
    assert aged.free[-2:] == ("offset", "ageing_r")
    start = start_unknowns(aged, base, base.unknowns(TRUTH), named_values(AGEING, {"r": 0.01}))
    assert dict(zip(aged.free, start.tolist(), strict=False))["offset"] == 0.0
    assert "offset" in extend(aged, [DRIFT], scale).free
    elsewhere = base.parameters.with_fixed({"offset": 7.0})
    held = extend(Problem(base.model, elsewhere, base.logs), [AGEING], scale)
    assert "offset" not in held.free
    assert held.parameters["offset"].value == 7.0


def test_an_ageing_spring_is_named_wherever_it_rests() -> None:
    """Known truth: at no pressure the actuator is bent by 0.6 rad, and its stiffness grows.

    Q (1 + r t)(x + 0.6) is no Q (1 + r t) x with another sensor zero; that one asked for a drift
    beside the ageing.
    """
    log = linear_log(samples=1500)
    time_s, pressure = log.time_s, log.channels["pressure"].values
    rate, rest = 0.01, 30.0

    def rates(t: float, state: Array) -> list[float]:
        push = np.interp(t, time_s, pressure) + rest - TRUTH["N"] * state[1]
        return [state[1], (push - TRUTH["Q"] * (1.0 + rate * t) * state[0]) / TRUTH["M"]]

    start = [rest / TRUTH["Q"], 0.0]
    found_x = solve_ivp(rates, (0.0, time_s[-1]), start, t_eval=time_s, rtol=1e-8, max_step=0.01)
    noise = 0.004 * np.random.default_rng(3).standard_normal(time_s.size)
    angle = found_x.y[0] - start[0] + noise
    made = Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})
    effects = ("ageing", "sensor_drift", "sensor_warmup", "softening", "delay")
    found = diagnose(made, model=MODEL, effects=effects)
    assert [cause.key for cause in found.causes] == ["ageing"]
    values = {p.name: p.value for p in found.extended.parameters} if found.extended else {}
    assert values["ageing_r"] == pytest.approx(rate, rel=0.05)
    assert values["offset"] == pytest.approx(-rest, rel=0.05)


def test_a_drift_of_the_zero_is_no_gain_of_a_far_place() -> None:
    """Known truth: the zero drifts by 0.002 rad/s.

    With the place of no position 30 ranges away a gain or a stiffness that drifts would do as much.
    """
    logs = [linear_log(samples=1500, noise=0.004, seed=seed) for seed in (1, 2)]
    for k, log in enumerate(logs):
        angle = log.channels["angle"]
        drifting = replace(angle, values=angle.values + 0.002 * log.time_s)
        logs[k] = replace(log, channels={**log.channels, "angle": drifting})
    effects = ("sensor_drift", "sensor_gain_drift", "ageing", "softening", "delay")
    found = diagnose(logs[0], hold_out=logs[1], model=MODEL, effects=effects)
    assert [cause.key for cause in found.causes] == ["sensor_drift"]
    tied = {name for tie in found.alternatives for name in tie.effects}
    assert not tied & {"sensor_gain_drift", "ageing"}
    base, scale = base_problem()
    offset = extend(base, [AGEING], scale).parameters["offset"]
    assert offset.upper - scale.u_high < 6.0 * scale.u_span
    assert scale.u_low - offset.lower < 6.0 * scale.u_span
