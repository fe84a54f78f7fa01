"""Sizes of a fitted motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import (
    MODEL,
    RATE_HZ,
    TRUTH,
    linear_angle,
    linear_log,
    linear_problem,
    pressure_course,
)

from softid.diagnosis.refit.characteristic_scales import (
    LONGEST_SHARE,
    TRIED_SHIFTS,
    fastest_time,
    scale_of,
)
from softid.fitters.problem import Problem
from softid.kernels.bending_body import elastic_torque
from softid.log import Log
from softid.models import Equilibrium, Muscle, Oscillator

PERIOD_S = 1.0 / RATE_HZ


def test_spans_and_units() -> None:
    """The input and the output as recorded, for there is no zero; the position as simulated, the
    force as Q times it."""
    log = linear_log()
    problem = linear_problem([log])
    scale = scale_of(problem, problem.unknowns(TRUTH))
    pressure, angle = log.pressure_kpa, log.channels["angle"].values
    assert (scale.u_low, scale.u_high) == (pressure.min(), pressure.max())
    assert scale.y_low == pytest.approx(angle.min(), abs=1e-6)
    assert scale.y_high == pytest.approx(angle.max(), abs=1e-6)
    assert scale.x_span == pytest.approx(float(np.ptp(angle)), rel=1e-6)
    assert scale.force == pytest.approx(TRUTH["Q"] * scale.x_span)
    assert scale.period_s == pytest.approx(PERIOD_S)
    assert scale.duration_s == pytest.approx(log.time_s[-1])
    units = (scale.u_unit, scale.x_unit, scale.y_unit, scale.force_unit)
    assert units == ("kPa", "rad", "rad", "kPa")


def test_a_bending_actuator_is_a_balance_of_torques() -> None:
    """Its stiffness is a share of the geometry's and tells no unit."""
    problem = Problem(Equilibrium(), Equilibrium().parameters(), [linear_log()])
    at = problem.unknowns(Equilibrium().parameters().values_dict())
    assert scale_of(problem, at).force_unit == "N·m"


def test_the_output_counts_from_the_zero_of_its_log() -> None:
    """As the model gives it: two logs of one motion whose sensors are zeroed 190 and 40 rad off."""
    log = linear_log()
    angle = log.channels["angle"]
    logs = [
        replace(
            log,
            name=f"zero-{zero:g}",
            channels=dict(log.channels) | {"angle": replace(angle, values=angle.values + zero)},
        )
        for zero in (190.0, -40.0)
    ]
    problem = linear_problem(logs)
    scale = scale_of(problem, problem.unknowns(TRUTH))
    assert scale.y_low == pytest.approx(float(angle.values.min()), abs=1e-6)
    assert scale.y_high == pytest.approx(float(angle.values.max()), abs=1e-6)


def test_unused_samples_do_not_widen_the_output() -> None:
    """A spike that is masked is no size of the motion."""
    log = linear_log()
    angle = np.array(log.channels["angle"].values)
    top = float(angle.max())
    angle[700] = 100.0
    channels = dict(log.channels) | {"angle": replace(log.channels["angle"], values=angle)}
    spiked = replace(log, channels=channels).with_masked(np.arange(len(log)) == 700)
    problem = linear_problem([spiked])
    assert scale_of(problem, problem.unknowns(TRUTH)).y_high <= top


def test_time_constant_of_an_oscillator() -> None:
    """Closed form N/Q; without a spring M/N, the time in which a drive comes up to speed."""
    problem = linear_problem([linear_log()])
    assert scale_of(problem, problem.unknowns(TRUTH)).motion_s == pytest.approx(0.2)
    drive = replace(MODEL, spring="none")
    free = Problem(drive, drive.parameters(), [linear_log()])
    found = scale_of(free, free.unknowns({"M": 4.0, "N": 5.0, "offset": 0.0}))
    assert found.motion_s == pytest.approx(0.8)
    assert found.force == pytest.approx(found.u_span)


@pytest.mark.parametrize("order", [1, -1])
def test_the_time_constant_does_not_depend_on_the_order_of_the_logs(order: int) -> None:
    """Closed form N/Q = 10 ms: shorter than the interval of one log, 20 ms, not than 5 ms."""
    logs = []
    for period_s in (0.02, 0.005):
        time_s = np.arange(0.0, 20.0, period_s)
        pressure = pressure_course(time_s)
        log = Log.from_arrays(time_s, {"pressure": pressure, "angle": 0.02 * pressure})
        logs.append(log)
    problem = linear_problem(logs[::order])
    found = scale_of(problem, problem.unknowns({**TRUTH, "N": 0.5})).motion_s
    assert found == pytest.approx(0.01)


def test_time_constant_of_a_muscle() -> None:
    """Closed form c2/(a1·e^{b1 p} + c1) at the median input, p in bar."""
    time_s = PERIOD_S * np.arange(500)
    pressure = np.where(time_s < 2.0, 0.0, 100.0)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": 0.1 * pressure})
    model = Muscle(damping="constant").adapted({"input": "kPa", "angle": "rad"})
    values = {"M": 1e-4, "a1": 0.5, "b1": 1.2, "c1": 2.0, "c2": 1.5}
    problem = Problem(model, model.parameters(), [log])
    found = scale_of(problem, problem.unknowns(values)).motion_s
    assert found == pytest.approx(1.5 / (0.5 * np.exp(1.2) + 2.0))


@pytest.mark.parametrize("late_samples", [0, 6, 25])
def test_a_static_law_takes_how_late_the_output_comes(late_samples: int) -> None:
    """Known shift: a static output moved by whole samples, found within a step of the search.

    The search ends at a tenth of the log in 200 steps, here 0.01 s; never below one period.
    """
    time_s = PERIOD_S * np.arange(1000)
    pressure = 50.0 + 40.0 * np.sin(2.0 * np.pi * 0.3 * time_s) * np.sin(0.4 * time_s)
    angle = np.interp(time_s - late_samples * PERIOD_S, time_s, pressure) / TRUTH["Q"]
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})
    static = Oscillator(order="static", x_unit="rad", u_unit="kPa")
    problem = Problem(static, static.parameters(), [log])
    found = scale_of(problem, problem.unknowns({"Q": TRUTH["Q"]})).motion_s
    step_s = LONGEST_SHARE * time_s[-1] / (TRIED_SHIFTS - 1)
    assert found == pytest.approx(max(late_samples * PERIOD_S, PERIOD_S), abs=1.01 * step_s)


@pytest.mark.parametrize("swing", [0.0, 1.0])
def test_an_output_that_stands_still_is_not_late(swing: float) -> None:
    """Nothing follows anything: one period, and sizes that nothing divides by zero with.

    Under a constant input even the simulated position has no span.
    """
    time_s = PERIOD_S * np.arange(200)
    pressure = 50.0 + swing * np.sin(time_s)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": np.zeros(200)})
    static = Oscillator(order="static", x_unit="rad", u_unit="kPa")
    problem = Problem(static, static.parameters(), [log])
    scale = scale_of(problem, problem.unknowns({"Q": 50.0}))
    assert scale.motion_s == pytest.approx(PERIOD_S)
    assert min(scale.x_span, scale.v_max, scale.force, scale.travel) > 0.0


def test_travel_and_speed() -> None:
    """Closed form: a slow up and down of overdamped steps travels twice its height, at most.

    The largest speed is that of a first-order answer, height/(N/Q), less what the inertia and the
    hundredth of the time that may be faster take away.
    """
    time_s = PERIOD_S * np.arange(1000)
    pressure = np.where((time_s >= 2.0) & (time_s < 10.0), 50.0, 0.0)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": linear_angle(time_s, pressure)})
    problem = linear_problem([log])
    scale = scale_of(problem, problem.unknowns(TRUTH))
    assert scale.travel == pytest.approx(2.0, rel=0.01)
    assert 0.5 / 0.2 < scale.v_max < 1.0 / 0.2


def test_a_free_mass_turns_round_as_quickly_as_it_is_driven() -> None:
    """Closed form: under a sine of A the acceleration is A/M where the speed is none, and the speed
    goes from its largest to none at the rate ω of the drive; a log that never turns has no rate of
    its own."""
    time_s = 0.01 * np.arange(3000)
    omega, mass = 2.0 * np.pi * 0.7, 0.4
    pressure = 30.0 * np.cos(omega * time_s)
    drive = replace(MODEL, spring="none")
    values = {"M": mass, "N": 1e-3, "offset": 0.0}
    for course, wanted in ((pressure, 30.0 / mass), (np.full(3000, 5.0), 0.0)):
        log = Log.from_arrays(time_s, {"pressure": course, "angle": np.cos(omega * time_s)})
        problem = Problem(drive, drive.parameters(), [log])
        scale = scale_of(problem, problem.unknowns(values))
        assert scale.a_turn == pytest.approx(wanted, rel=0.03)
        own = scale.v_max / scale.x_span
        assert scale.turning_rate == pytest.approx(max(omega if wanted else 0.0, own), rel=0.05)


def test_of_several_logs_the_longest_counts() -> None:
    """Travel and duration are those of the longest log, not of all together."""
    long, short = linear_log(), replace(linear_log(samples=400), name="short")
    alone, both = linear_problem([long]), linear_problem([short, long])
    one, two = (scale_of(p, p.unknowns(TRUTH)) for p in (alone, both))
    assert two.travel == pytest.approx(one.travel)
    assert two.duration_s == one.duration_s


def test_the_fastest_place_of_the_range() -> None:
    """Closed form: N/Q at the pressure where it is the least, and √(M/Q) where that is longer."""
    problem = linear_problem([linear_log()])
    for mass, wanted in ((0.4, 0.2), (4.5, 0.3)):
        z = problem.unknowns({**TRUTH, "M": mass})
        assert fastest_time(problem, z) == pytest.approx(wanted)


def test_the_force_of_a_bending_actuator_is_its_own() -> None:
    """Closed form s·(K(high) − K(low)), K rising with the angle, whatever the actuator's size."""
    model = Equilibrium()
    problem = Problem(model, model.parameters(), [linear_log()])
    values = model.parameters().values_dict()
    scale = scale_of(problem, problem.unknowns(values))
    torques = [elastic_torque(x, model.compiled_body) for x in (scale.x_low, scale.x_high)]
    assert scale.force == pytest.approx(values["stiffness"] * (torques[1] - torques[0]))
