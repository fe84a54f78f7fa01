"""Which causes follow the same law as another one, in the catalogue or not."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from extended_fits import scale_of as sizes_of
from handmade_diagnosis import cause, estimate
from handmade_rounds import link_of
from linear_motion import TRUTH, linear_angle, linear_log, linear_problem, standing
from scipy.signal import lsim

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.verdict.law_rivals import own_time, with_law_rivals
from softid.effects import effect_of
from softid.effects.scale import Scale
from softid.log import Log

OWN_S = TRUTH["N"] / TRUTH["Q"]


def linear_with(
    key: str, *, intersample: str | None = None, **values: float
) -> tuple[Candidate, Scale]:
    """The linear actuator at its truth with an effect."""
    problem = linear_problem([linear_log().with_intersample(intersample)])
    z = problem.unknowns(TRUTH)
    scale = scale_of(problem, z)
    extended = extend(problem, [effect_of(key)], scale)
    named = {f"{key.split('.')[0]}_{name}": value for name, value in values.items()}
    return standing(extended, start_unknowns(extended, problem, z, named)), scale


@pytest.mark.parametrize(("share", "rivals"), [(0.01, 2), (0.03, 1)])
def test_a_short_hysteresis_may_be_friction(share: float, rivals: int) -> None:
    """Dahl's law is both; up to 2 % of the range it may be a presliding."""
    told = cause("hysteresis", [estimate("hysteresis_zs", share, "mm")], before=2.0, after=1.0)
    scale = replace(sizes_of("muscle"), x_low=3.0, x_high=4.0)
    final: Any = None
    found = with_law_rivals(link_of("hysteresis"), told, "hysteresis", final, scale)
    assert len(found.rivals) == rivals
    assert found.rivals[0] == "hysteresis"


@pytest.mark.parametrize(
    ("tau", "told_as", "rivals"),
    [
        (6.0 * OWN_S, "pneumatic_lag.level", ("pneumatic_lag", "position_damping")),
        (6.0 * OWN_S, "pneumatic_lag", ("pneumatic_lag",)),
        (4.0 * OWN_S, "pneumatic_lag.level", ("pneumatic_lag",)),
    ],
)
def test_a_lag_beside_an_actuator_without_damping_may_be_that_damping(
    tau: float, told_as: str, rivals: tuple[str, ...]
) -> None:
    """Where less than a fifth of the lag's time is the actuator's own, and the level matters."""
    key = "pneumatic_lag.level"
    final, scale = linear_with(key, tau=tau, ratio=2.0)
    assert own_time(final) == pytest.approx(OWN_S)
    sizes = [estimate("pneumatic_lag_tau", tau, "s"), estimate("pneumatic_lag_ratio", 2.0, "1")]
    told = cause(key, sizes, before=2.0, after=1.0)
    assert with_law_rivals(link_of(key), told, told_as, final, scale).rivals == rivals


def test_a_lag_of_the_level_is_a_damping_that_goes_with_the_position() -> None:
    """The law in the docstring: Q x = pa and τ(pa) ṗa + pa = p against N(x) ẋ + Q x = p.

    Both by small Euler steps of their own form; rounding is all that differs.
    """
    q, step = 50.0, 1e-3
    pressure = 60.0 + 30.0 * np.sin(np.arange(5000) * step)
    inside, x = float(pressure[0]), float(pressure[0]) / q
    for p in pressure.tolist():
        tau = 0.2 * 3.0 ** (inside / 100.0)
        damping = q * 0.2 * 3.0 ** (q * x / 100.0)
        inside += step * (p - inside) / tau
        x += step * (p - q * x) / damping
    assert x == pytest.approx(inside / q, rel=1e-12)


@pytest.mark.parametrize(
    ("tau", "rivals"),
    [(2.0 * OWN_S, ("creep", "gauge_lag", "sensor_lead")), (4.0 * OWN_S, ("creep",))],
)
def test_a_creep_as_fast_as_the_motion_may_be_any_pole_and_zero(
    tau: float, rivals: tuple[str, ...]
) -> None:
    """Below three times the motion's own time."""
    final, scale = linear_with("creep", k=10.0, tau=tau)
    assert scale.motion_s == pytest.approx(OWN_S)
    sizes = [estimate("creep_k", 10.0, "kPa/rad"), estimate("creep_tau", tau, "s")]
    told = cause("creep", sizes, before=2.0, after=1.0)
    assert with_law_rivals(link_of("creep"), told, "creep", final, scale).rivals == rivals


@pytest.mark.parametrize(("tau", "is_open"), [(2.0 * OWN_S, True), (4.0 * OWN_S, False)])
def test_a_relaxation_as_fast_as_the_motion_may_be_a_lead(tau: float, is_open: bool) -> None:
    """Below three times the motion's own time."""
    final, scale = linear_with("relaxation", c=0.2, tau=tau)
    sizes = [estimate("relaxation_c", 0.2, "1"), estimate("relaxation_tau", tau, "s")]
    told = cause("relaxation", sizes, before=2.0, after=1.0)
    rivals = with_law_rivals(link_of("relaxation"), told, "relaxation", final, scale).rivals
    assert rivals == ("relaxation", "sensor_lead", "gauge_lag")[: 3 if is_open else 1]


def test_both_forms_of_a_creep_are_one_transfer_function() -> None:
    """Where M = N = 0, k and τ beside Q are c = k/Q and τ (1 + c) beside Q (1 + c)."""
    q, k, tau = 50.0, 10.0, 0.4
    c = k / q
    time_s = np.arange(1000) / 50.0
    pressure = 60.0 + 30.0 * np.sin(4.0 * time_s)
    solid = ([tau, 1.0], [tau * (q + k), q])
    series = ([tau * (1.0 + c) / (1.0 + c), 1.0], [tau * (1.0 + c), 1.0])
    one = lsim(solid, pressure, time_s)[1]
    other = lsim(series, pressure / q, time_s)[1]
    assert one == pytest.approx(other, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(("share", "rivals"), [(0.08, 1), (0.12, 2)])
def test_friction_that_comes_up_slowly_may_be_a_damping(share: float, rivals: int) -> None:
    """Dry friction is full at a tenth of the largest speed."""
    scale = sizes_of("muscle")
    speed = estimate("coulomb_friction_vs", share * scale.v_max, "mm/s")
    told = cause("coulomb_friction", [speed], before=2.0, after=1.0)
    final = linear_with("coulomb_friction", Fc=1.0, vs=0.5)[0]
    found = with_law_rivals(link_of("coulomb_friction"), told, "coulomb_friction", final, scale)
    assert found.rivals == ("coulomb_friction", "thinning_damping")[:rivals]


@pytest.mark.parametrize(("way_back", "rivals"), [(0.0, 2), (1.0, 1)])
def test_friction_that_never_turns_round_may_be_a_creep(way_back: float, rivals: int) -> None:
    """One step up, and one with the step back that shows with which sign the friction acts."""
    time_s = np.arange(1000) / 50.0
    pressure = np.interp(time_s, [1.0, 1.1, 11.0, 11.1], [0.0, 60.0, 60.0, 60.0 * (1.0 - way_back)])
    angle = linear_angle(time_s, pressure)
    problem = linear_problem([Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})])
    final = standing(problem, problem.unknowns(TRUTH))
    speed = estimate("coulomb_friction_vs", 0.01, "rad/s")
    told = cause("coulomb_friction", [speed], before=2.0, after=1.0)
    scale = scale_of(problem, problem.unknowns(TRUTH))
    found = with_law_rivals(link_of("coulomb_friction"), told, "coulomb_friction", final, scale)
    assert found.rivals == ("coulomb_friction", "giving_way")[:rivals]


@pytest.mark.parametrize(
    ("interval", "intersample", "is_tied"),
    [
        ((0.008, 0.012), None, True),
        ((0.0093, 0.0097), None, True),
        ((0.0112, 0.014), None, False),
        ((0.008, 0.012), "zoh", False),
        (None, None, False),
    ],
)
@pytest.mark.parametrize("name", ["delay", "sensor_lag", "pneumatic_lag"])
def test_what_is_late_by_half_an_interval_may_be_a_held_input(
    name: str, interval: tuple[float, float] | None, intersample: str | None, is_tied: bool
) -> None:
    """At 50 Hz half an interval is 0.01 s; an input that is taken as held has it already."""
    final, scale = linear_with(name, tau=0.01, intersample=intersample)
    tau = replace(estimate(f"{name}_tau", 0.01, "s"), ci95=interval)
    told = cause(name, [tau], before=2.0, after=1.0)
    found = with_law_rivals(link_of(name), told, name, final, scale).rivals
    assert found == ((name, "held_input") if is_tied else (name,))


def test_a_lag_of_two_times_is_no_held_input() -> None:
    """It is told as what it is."""
    final, scale = linear_with("pneumatic_lag.separate", tau=0.01, ratio=2.0)
    sizes = [estimate("pneumatic_lag_tau", 0.01, "s"), estimate("pneumatic_lag_ratio", 2.0, "1")]
    told = cause("pneumatic_lag", sizes, before=2.0, after=1.0)
    key = "pneumatic_lag.separate"
    assert with_law_rivals(link_of(key), told, key, final, scale).rivals == ("pneumatic_lag",)


@pytest.mark.parametrize(("beta", "rivals"), [(8.9, 1), (9.1, 2)])
def test_friction_that_is_gone_in_motion_may_be_a_dead_band(beta: float, rivals: int) -> None:
    """A regulator that rests within a band about its set point: nothing of it is left beyond."""
    values = [
        estimate("coulomb_friction_vs", 0.1, "kPa/s"),
        estimate("coulomb_friction_beta", beta, "1"),
    ]
    told = cause("coulomb_friction.stribeck", values, before=2.0, after=1.0)
    final, scale = linear_with("coulomb_friction", Fc=1.0, vs=0.5)
    found = with_law_rivals(link_of("coulomb_friction"), told, told.key, final, scale)
    assert found.rivals == ("coulomb_friction", "dead_band")[:rivals]


@pytest.mark.parametrize(("output", "rivals"), [("force", 2), ("torque", 2), ("angle", 1)])
def test_a_force_that_stays_at_rest_may_come_behind_a_gap(output: str, rivals: int) -> None:
    """An actuator that does not touch its load yet has none; an angle that stays is clipped."""
    told = cause("sensor_clipping.lower", [], before=2.0, after=1.0)
    final: Any = SimpleNamespace(problem=SimpleNamespace(outputs=(output,)))
    link = link_of("sensor_clipping")
    found = with_law_rivals(link, told, told.key, final, sizes_of("muscle"))
    assert found.rivals == ("sensor_clipping", "gap")[:rivals]
