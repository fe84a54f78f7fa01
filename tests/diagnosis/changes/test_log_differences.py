"""What was changed between logs, on logs in which one thing was."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

import muscle_motion
import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import (
    MODEL,
    RATE_HZ,
    TRUTH,
    linear_angle,
    linear_log,
    linear_problem,
    sizes_of,
    smoothed_levels,
    standing,
)
from muscle_motion import muscle_angle, muscle_log

from softid.diagnosis.base.base_fit import BaseFit, Request
from softid.diagnosis.changes.changed_numbers import Change
from softid.diagnosis.changes.held_out_difference import shows_motion_of
from softid.diagnosis.changes.log_differences import LogDifferences, log_differences
from softid.diagnosis.changes.probes import PROBES
from softid.diagnosis.refit.candidates import Candidate, advance
from softid.diagnosis.refit.held_out import HeldOutLogs
from softid.diagnosis.report.changes import difference_issues
from softid.diagnosis.report.difference_texts import LOG_DIFFERENCES
from softid.effects import EFFECTS
from softid.effects.scale import Scale
from softid.fitters.problem import Problem
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]

N, NOISE, MOVED = 1500, 0.01, 0.2
TIME_S = np.arange(N) / RATE_HZ


def log_with(seed: int, kind: str = "", size: float = 0.0) -> Log:
    """The linear actuator with one change from the first sample on."""
    truth, u = dict(TRUTH), smoothed_levels(TIME_S, seed)
    if kind in ("stiffness", "damping"):
        truth["Q" if kind == "stiffness" else "N"] *= 1.0 + size
    arriving = u * (1.0 + size) if kind == "pressure_gain" else u
    angle = linear_angle(TIME_S, arriving, truth)
    angle = angle * (1.0 + size) if kind == "gain" else angle
    angle = np.interp(TIME_S - size, TIME_S, angle) if kind == "delay" else angle
    noise = NOISE * np.random.default_rng(seed).standard_normal(N)
    return Log.from_arrays(TIME_S, {"pressure": u, "angle": angle + noise}, name=f"log-{seed}")


def log_of(seed: int, truth: Mapping[str, float]) -> Log:
    """The linear actuator with parameters of its own."""
    u = smoothed_levels(TIME_S, seed)
    noise = NOISE * np.random.default_rng(seed).standard_normal(N)
    angle = linear_angle(TIME_S, u, truth) + noise
    return Log.from_arrays(TIME_S, {"pressure": u, "angle": angle}, name=f"log-{seed}")


def fitted(log: Log, truth: Mapping[str, float] = TRUTH) -> tuple[Candidate, Scale]:
    problem = linear_problem([log])
    base = advance(standing(problem, problem.unknowns(truth)), {"angle": NOISE}, 40)
    return base, sizes_of(base)


def found_in(other: Log, *, zero_counts: bool = False) -> LogDifferences | None:
    """What another log has beside a fitted one; without a change nothing but noise is left."""
    base, scale = fitted(log_with(0))
    left = HeldOutLogs((other,)).first_errors(base)
    before = float(left @ left)
    before += N * MOVED**2 if zero_counts else 0.0  # the zero of the fitted log would stay
    noise = NOISE**2 * N
    return log_differences(
        base, scale, [other], before=before, noise=noise, zero_counts=zero_counts
    )


@pytest.mark.parametrize(
    ("kind", "size", "alike"),
    [
        ("gain", 0.08, {"gain", "pressure_gain"}),
        ("pressure_gain", -0.1, {"gain", "pressure_gain"}),
        ("stiffness", 0.3, {"stiffness"}),
        ("damping", -0.2, {"damping"}),
        ("delay", 0.06, {"delay"}),
    ],
)
def test_what_differs_is_found(kind: str, size: float, alike: set[str]) -> None:
    """Known truth; a linear model has one gain for the pressure and the reading."""
    found = found_in(log_with(1, kind, size))
    assert found is not None
    assert alike <= set(found.kinds)
    assert found.kinds[0] in alike
    assert found.sizes == pytest.approx((size,), rel=0.1)
    assert found.share == pytest.approx(1.0, abs=0.05)


def turned(log: Log) -> Log:
    """The log with an angle of the other sign."""
    angle = log.channels["angle"]
    return replace(log, channels={**log.channels, "angle": replace(angle, values=-angle.values)})


def test_a_turned_output_is_found_and_told() -> None:
    """An axis of a camera that points the other way on one day of three."""
    found = found_in(turned(log_with(1)))
    assert found is not None
    assert (found.kinds, found.sizes) == (("sign",), (-2.0,))
    logs = (log_with(0), turned(log_with(1)), log_with(2))
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    (issue,) = difference_issues(request.fit_base(LogSet(logs), (), thorough=False))
    assert issue.message.startswith("the logs differ: angle has the other sign in log-1 than in")
    assert "--channel angle=COLUMN:-UNIT" in str(issue.remedy)


def test_a_zero_is_each_logs_own_unless_it_counts() -> None:
    """What only a zero takes away is no difference between logs, and one within a log."""
    plain = log_with(1)
    angle = plain.channels["angle"]
    moved = replace(
        plain, channels={**plain.channels, "angle": replace(angle, values=angle.values + MOVED)}
    )
    found = found_in(moved, zero_counts=True)
    assert found is not None
    assert found.kinds == ("zero",)


@pytest.mark.parametrize(
    ("kind", "added"),
    [
        ("drift", 0.004 * TIME_S),
        ("settling_drift", -0.15 * np.expm1(-TIME_S / 5.0)),
        ("settling_drift", 0.15 * np.expm1(-TIME_S / 10.0)),
    ],
)
def test_a_drift_in_one_log_is_found(kind: str, added: Array) -> None:
    """Known truth: even, or of a sensor that warms up faster and slower than the probe does."""
    other = linear_log(noise=NOISE, seed=3, samples=N, added=added)
    _, scale = fitted(log_with(0))
    found = found_in(other)
    assert found is not None
    assert found.kinds[0] == kind
    assert found.sizes[0] * scale.y_span == pytest.approx(added[-1], rel=0.3)


@pytest.mark.parametrize(("mass", "weight"), [(3.0, 0.1), (0.4, -0.06)])
def test_a_payload_is_two_numbers(mass: float, weight: float) -> None:
    """Known truth: put on or taken off, it changes the inertia by a factor and the stiffness."""
    truth = {**TRUTH, "M": 2.0}
    loaded = {**truth, "M": mass * truth["M"], "Q": (1.0 + weight) * truth["Q"]}
    base, scale = fitted(log_of(0, truth), truth)
    other = log_of(1, loaded)
    left = HeldOutLogs((other,)).first_errors(base)
    found = log_differences(base, scale, [other], before=float(left @ left), noise=NOISE**2 * N)
    assert found is not None
    assert found.beside is not None
    sizes = {found.kinds[0]: found.sizes[0], found.beside.kinds[0]: found.beside.sizes[0]}
    assert sizes == pytest.approx({"M": mass - 1.0, "stiffness": weight}, rel=0.1)
    assert found.share == found.beside.share == pytest.approx(1.0, abs=0.05)


def test_a_payload_is_told_as_one() -> None:
    """Both numbers, and what changes them at once."""
    truth = {**TRUTH, "M": 2.0}
    loaded = {**truth, "M": 2.0 * truth["M"], "Q": 1.1 * truth["Q"]}
    (issue,) = difference_issues(base_of(log_of(0, truth), log_of(1, loaded)))
    told = re.search(
        r"against log-0 (.*) changes by ([+-][0-9.]+) % in log-1 and (.*) changes by "
        r"([+-][0-9.]+) % in log-1, as with another payload",
        issue.message,
    )
    assert told is not None
    sizes = {told[1]: float(told[2]), told[3]: float(told[4])}
    assert sizes == pytest.approx({"the inertia M": 100.0, "the stiffness": 10.0}, rel=0.1)


def test_what_two_numbers_do_not_explain_is_no_difference() -> None:
    """A swing, and noise alone."""
    swing = linear_log(noise=NOISE, seed=3, samples=N, added=0.1 * np.sin(TIME_S))
    for other in (swing, log_with(1)):
        assert found_in(other) is None


def test_probes_are_in_no_catalogue() -> None:
    assert not {probe.name for probe in PROBES} & set(EFFECTS)


def base_of(*logs: Log) -> BaseFit:
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    return request.fit_base(LogSet(logs), (), thorough=False)


def test_the_differences_of_fitted_logs_are_told() -> None:
    """Of three logs the second has a gain 10 % larger: that log, the size and the share."""
    logs = (log_with(0), log_with(1, "gain", 0.1), log_with(2))
    (issue,) = difference_issues(base_of(*logs))
    assert issue.code == LOG_DIFFERENCES
    told = re.search(
        r"against log-0 .* changes by ([+-][0-9.]+) % in log-1 and ([+-][0-9.]+) % in log-2",
        issue.message,
    )
    assert told is not None
    assert float(told[1]) == pytest.approx(10.0, abs=1.0)
    assert float(told[2]) == pytest.approx(0.0, abs=1.0)


def test_one_frequency_says_nothing_of_another() -> None:
    """A log that is a sine of 0.5 Hz asks for a delay in one of 1 Hz, though nothing differs: what
    is known of mass and damping is one number. Two sines of 0.5 Hz tell of a gain."""
    half, same, whole = (sine_log(*row) for row in ((0.5, 0.0), (0.5, 0.1), (1.0, 0.0)))
    assert not shows_motion_of((half,), (whole,))
    assert shows_motion_of((half,), (same,))
    assert shows_motion_of((half, whole), (half,))
    assert [issue.code for issue in difference_issues(base_of(half, same))] == [LOG_DIFFERENCES]


def sine_log(frequency_hz: float, gain: float) -> Log:
    """A pressure that is a sine alone, and the exact angle with noise, by a gain larger."""
    time_s = np.arange(2000) / 50.0
    pressure = 60.0 + 30.0 * np.sin(2.0 * np.pi * frequency_hz * time_s)
    noise = 0.01 * np.random.default_rng(round(10 * frequency_hz + 100 * gain)).standard_normal(
        2000
    )
    angle = (1.0 + gain) * linear_angle(time_s, pressure) + noise
    name = f"sine-{frequency_hz}-{gain}"
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}, name=name)


def test_like_logs_do_not_differ() -> None:
    """Nor does a single one."""
    assert difference_issues(base_of(log_with(0), log_with(1))) == ()
    assert difference_issues(base_of(log_with(0))) == ()


@pytest.mark.parametrize(("late_s", "expected"), [(0.4, True), (0.503, False), (-0.503, False)])
def test_a_delay_at_the_bound_of_its_probe_is_none(late_s: float, expected: bool) -> None:
    """Known truth: up to 0.5 s a delay is looked for; of a longer one that bound is no size."""
    found = found_in(log_with(1, "delay", late_s))
    assert (found is not None and "delay" in found.kinds) == expected
    if found is not None and expected:
        assert found.sizes == pytest.approx((late_s,), abs=0.01)


def test_a_parameter_that_was_zero_has_no_share() -> None:
    """Known truth: a drive whose input has no offset, and one of 0.2 kPa, which is no 20 %."""
    model = replace(MODEL, spring="none")
    truth = {"M": 0.4, "N": 10.0, "G": 1.0, "offset": 0.0}
    for known, share in ((0.0, None), (0.16, (0.25,))):
        values = {**truth, "offset": known}
        problem = Problem(model, model.parameters().with_values(values), [drive_log(known)])
        left, size = Change(("offset",), ("offset",), problem, values).on(drive_log(0.2))
        assert left == pytest.approx(0.0, abs=1e-6)
        assert size == (share if share is None else pytest.approx(share, abs=1e-3))


def drive_log(offset_kpa: float) -> Log:
    """The exact position of a drive 0.4 x'' + 10 x' = u − offset, from rest at zero."""
    from scipy.signal import lsim

    u = smoothed_levels(TIME_S, 1)
    u = u - u.mean()
    angle = lsim(([1.0], [0.4, 10.0, 0.0]), u - offset_kpa, TIME_S, interp=True)[1]
    return Log.from_arrays(TIME_S, {"pressure": u, "angle": angle}, name=f"drive-{offset_kpa}")


@pytest.mark.parametrize(("mass", "weight"), [(1.3, 0.1), (2.0, 0.2)])
def test_a_payload_of_a_muscle_is_inertia_and_load(mass: float, weight: float) -> None:
    """Known truth; the zero of the second log is free.

    In a muscle a gain of the reading with another zero is the same as a load, so that rounding
    alone tells which of the two takes more.
    """
    theta, known = muscle_motion.TRUTH, muscle_motion.MODEL.parameters()
    logs = [muscle_with(0, theta)]
    problem = Problem(muscle_motion.MODEL, known.with_values(theta), logs)
    base = advance(standing(problem, problem.unknowns(theta)), {"angle": NOISE}, 40)
    scale = sizes_of(base)
    other = muscle_with(1, {**theta, "M": mass * theta["M"]}, weight * scale.force)
    left = HeldOutLogs((other,)).first_errors(base)
    found = log_differences(base, scale, [other], before=float(left @ left), noise=NOISE**2 * N)
    assert found is not None
    assert found.beside is not None
    assert (found.kinds, found.beside.kinds[0]) == (("load",), "M")
    assert found.sizes == pytest.approx((weight,), rel=0.15)
    assert found.beside.sizes == pytest.approx((mass - 1.0,), abs=0.1)
    assert len(found.beside.kinds) == 1


def muscle_with(seed: int, theta: Mapping[str, float], load: float = 0.0) -> Log:
    u = smoothed_levels(TIME_S, seed)
    noise = NOISE * np.random.default_rng(seed).standard_normal(N)
    angle = muscle_angle(TIME_S, u, theta, load=load) + noise
    return muscle_log(f"muscle-{seed}", TIME_S, u, angle)
