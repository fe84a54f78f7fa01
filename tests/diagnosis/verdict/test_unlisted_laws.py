"""Laws in no catalogue for which a cause may stand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from extended_fits import scale_of as sizes_of
from linear_motion import TRUTH, linear_log, linear_problem
from printed_laws import unnamed_in

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.verdict.equivalence import CHANGING, DRIFTS, REPLACED
from softid.diagnosis.verdict.unlisted_curves import (
    MARGIN,
    FineCurve,
    FreeSpring,
    PowerSpring,
    PressureStiffness,
)
from softid.diagnosis.verdict.unlisted_drifts import (
    LoadDrift,
    PressureDrift,
    PressureGainDrift,
    RecoveringSoftening,
    SettlingGain,
    SettlingStiffness,
)
from softid.diagnosis.verdict.unlisted_laws import (
    LAWS_BESIDE,
    UNLISTED_LAWS,
    BentReading,
    InputPlay,
    OutputPlay,
    suiting,
)
from softid.diagnosis.verdict.unlisted_names import UNLISTED
from softid.diagnosis.verdict.unlisted_pneumatics import (
    InputLimit,
    RateLimit,
    ReliefLeak,
    UnevenDelay,
)
from softid.diagnosis.verdict.unlisted_positions import (
    PositionDamping,
    PositionFriction,
    PositionInertia,
)
from softid.diagnosis.verdict.unlisted_readings import (
    EarlyReading,
    Feedthrough,
    LateGauge,
    SmoothedInput,
    SwingingPart,
    UnevenReading,
)
from softid.effects import EFFECTS, effect_of
from softid.effects.base import Effect
from softid.effects.sensor_lag import SensorLag
from softid.effects.sensor_resonance import SensorResonance
from softid.kernels.filters import lag
from softid.kernels.terms import DAMPING, FORCE, INERTIA, RATE, SHIFT, STIFFNESS


def residual_with(effect: Effect, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Times and what an effect takes from the exact answer of the linear actuator."""
    problem = linear_problem([linear_log()])
    z = problem.unknowns(TRUTH)
    extended = extend(problem, [effect], scale_of(problem, z))
    at = start_unknowns(extended, problem, z, {f"{effect.name}_rate": rate})
    (block,) = extended.blocks(at, derivatives=False)
    return problem.logs[0].time_s, block.residual


def test_a_load_that_changes_moves_by_its_compliance() -> None:
    """Closed form: x = −f (t − N/Q)/Q once the start has died away, 1e-3 of its end."""
    rate = 0.5
    time_s, residual = residual_with(LoadDrift(), rate)
    late = time_s > 3.0
    expected = rate * (time_s - TRUTH["N"] / TRUTH["Q"]) / TRUTH["Q"]
    np.testing.assert_allclose(residual[late], expected[late], atol=1e-3 * expected[-1])


@pytest.mark.parametrize(
    ("law", "expected"), [(PressureGainDrift(), [10.0, 18.0]), (PressureDrift(), [10.0, 19.9])]
)
def test_what_arrives(law: Any, expected: list[float]) -> None:
    """10 kPa at 0 s and 20 kPa at 2 s, at −0.05 a second."""
    found = law.apply(np.array([-0.05]), np.array([0.0, 2.0]), np.array([10.0, 20.0]), None)
    np.testing.assert_allclose(found, expected)


def test_a_limit_is_followed() -> None:
    """1 span in 2 s, with steps of 0.25 s: it rises by an eighth of the span a step, and stays; by
    half of that it falls where that takes twice as long."""
    scale = sizes_of("muscle")
    time_s = 0.25 * np.arange(7)
    u = scale.u_span * np.array([0.0, 0.3, 0.3, 0.3, 0.3, 0.2, 0.2])
    found = RateLimit().apply(np.array([2.0, 1.0]), time_s, u, scale) / scale.u_span
    np.testing.assert_allclose(found, [0.0, 0.125, 0.25, 0.3, 0.3, 0.2, 0.2], atol=1e-12)
    slower = RateLimit().apply(np.array([2.0, 2.0]), time_s, u, scale) / scale.u_span
    np.testing.assert_allclose(slower[4:], [0.3, 0.2375, 0.2], atol=1e-12)
    np.testing.assert_array_equal(RateLimit().apply(np.array([0.0, 1.0]), time_s, u, scale), u)


def test_a_supply_gives_no_more() -> None:
    """Up to the limit as recorded, above it the limit, with a corner of 0.5 % of the range."""
    scale = sizes_of("muscle")
    u = scale.u_low + scale.u_span * np.array([0.0, 0.4, 0.6, 0.65, 0.9])
    top = scale.u_low + 0.6 * scale.u_span
    found = (InputLimit().apply(np.array([top]), np.arange(5.0), u, scale) - top) / scale.u_span
    np.testing.assert_allclose(found, [-0.6, -0.2, -0.005 * np.log(2.0), 0.0, 0.0], atol=1e-6)


def test_a_leak_opens_above_a_pressure() -> None:
    """A hold at 60 kPa after one at 20: of what is beyond 40 kPa two thirds arrive, at once where
    there is no restriction."""
    u = np.array([20.0, 20.0, 60.0, 60.0, 60.0])
    found = ReliefLeak().apply(np.array([1e-9, 40.0, 0.5]), np.arange(5.0), u, sizes_of("muscle"))
    np.testing.assert_allclose(found, [20.0, 20.0, *[40.0 + 20.0 / 1.5] * 3], rtol=1e-6)


def test_a_bent_reading_keeps_the_ends_of_its_range() -> None:
    """Closed form: waves of one, two and three half periods over the range."""
    scale = sizes_of("muscle")
    y = scale.y_low + scale.y_span * np.array([0.0, 1.0 / 6.0, 0.25, 0.5, 1.0])

    def bent(*waves: float) -> np.ndarray:
        found = BentReading().apply(np.array(waves), np.zeros(5), y, scale)
        return np.asarray((found - y) / scale.y_span)

    half = 0.05 * 0.5**0.5
    np.testing.assert_allclose(bent(0.05, 0.0, 0.0), [0, 0.025, half, 0.05, 0], atol=1e-12)
    np.testing.assert_allclose(bent(0.0, 0.05, 0.0)[[0, 2, 3, 4]], [0, 0.05, 0, 0], atol=1e-12)
    np.testing.assert_allclose(bent(0.0, 0.0, 0.05), [0, 0.05, half, -0.05, 0], atol=1e-12)


def test_a_reading_runs_ahead() -> None:
    """A ramp of 2 per second read 0.25 s early, to its very end."""
    time_s = 0.1 * np.arange(11)
    found = EarlyReading().apply(np.array([0.25]), time_s, 2.0 * time_s, sizes_of("muscle"))
    np.testing.assert_allclose(found, 2.0 * time_s + 0.5)


def test_a_late_gauge_is_made_up_for() -> None:
    """A lag of 0.2 s behind a sine of 1 Hz, taken back at 100 Hz: differences over two samples lose
    (ωh)²/6 of the rate, 7e-4 of its ωτ = 1.3 times the sine."""
    h, tau = 0.01, 0.2
    time_s = h * np.arange(301)
    pressure = np.sin(2.0 * np.pi * time_s)
    recorded = pressure.copy()
    lag(np.diff(time_s), recorded, tau, tau)
    found = LateGauge().apply(np.array([tau]), time_s, recorded, sizes_of("muscle"))
    np.testing.assert_allclose(found[1:-1], pressure[1:-1], atol=1e-3)
    line = LateGauge().apply(np.array([tau]), time_s, 2.0 * time_s, sizes_of("muscle"))
    np.testing.assert_allclose(line, 2.0 * (time_s + tau), atol=1e-12)


def test_smoothing_is_undone() -> None:
    """A line stays; of t² the mean over w has w²/12 too much, so as much less arrives; and of a
    sine what smoothing leaves, sinc(w/T), comes back to within (1 - sinc)⁴."""
    h, w = 0.01, 0.3
    time_s = h * np.arange(301)
    law, scale, inner = SmoothedInput(), sizes_of("muscle"), slice(70, -70)
    line = law.apply(np.array([w]), time_s, 2.0 * time_s, scale)
    np.testing.assert_allclose(line[inner], 2.0 * time_s[inner], atol=1e-12)
    bent = law.apply(np.array([w]), time_s, time_s**2, scale) - time_s**2
    np.testing.assert_allclose(bent[inner], -(w**2) / 12.0 - h**2 / 6.0, rtol=1e-6)
    sine = np.sin(2.0 * np.pi * time_s)
    smoothed = effect_of("smoothing.mean").apply(np.array([w]), time_s, sine, scale)
    left = law.apply(np.array([w]), time_s, smoothed, scale) - sine
    assert np.max(np.abs(left[80:-80])) < (1.0 - np.sinc(w)) ** 4 + 1e-3
    np.testing.assert_array_equal(law.apply(np.array([0.0]), time_s, sine, scale), sine)


def test_a_sensor_lags_up_and_down_by_its_own_times() -> None:
    """Closed form: a rise and a fall in a sampling interval, each followed exponentially; with one
    time it is the lag of the catalogue, but for the course within an interval, a hundredth."""
    time_s = 0.002 * np.arange(1000)
    y = np.where((time_s >= 0.2) & (time_s < 1.0), 1.0, 0.0)
    scale = sizes_of("muscle")
    found = UnevenReading().apply(np.array([0.05, 3.0]), time_s, y, scale)
    late_s = 0.001  # the straight line through an interval comes half an interval before its end
    up, down = (time_s > 0.21) & (time_s < 0.99), time_s > 1.01
    risen = 1.0 - np.exp(-(time_s - 0.2 + late_s) / 0.05)
    np.testing.assert_allclose(found[up], risen[up], atol=1e-3)
    fallen = np.exp(-(time_s - 1.0 + late_s) / 0.15)
    np.testing.assert_allclose(found[down], fallen[down], atol=1e-3)
    even = UnevenReading().apply(np.array([0.05, 1.0]), time_s, y, scale)
    lagged = SensorLag().apply(np.array([0.05]), time_s, y, scale)
    np.testing.assert_allclose(even, lagged, atol=0.01)


def test_a_sensor_answers_to_the_pressure_at_once() -> None:
    """Closed form: a tenth of its range over the whole range of the pressure, whatever moves."""
    scale = sizes_of("muscle")
    u = scale.u_low + scale.u_span * np.array([0.0, 1.0, 0.5])
    y = np.array([0.3, 0.4, 0.2])
    found = Feedthrough().recorded(np.array([0.1]), np.arange(3.0), y, u, scale)
    np.testing.assert_allclose(found, y + 0.1 * scale.y_span * np.array([0.0, 1.0, 0.5]))
    np.testing.assert_array_equal(Feedthrough().apply(np.array([0.1]), u, y, scale), y)


def test_a_part_of_the_reading_swings() -> None:
    """Closed form: without any part the reading is the motion; all else is as much of the swing."""
    time_s, scale = np.arange(400) / 100.0, sizes_of("muscle")
    y = np.where(time_s > 1.0, 1.0, 0.0)
    swings = SensorResonance().apply(np.array([0.3, 0.1]), time_s, y, scale)
    for part in (0.0, 0.25):
        found = SwingingPart().apply(np.array([part, 0.3, 0.1]), time_s, y, scale)
        np.testing.assert_allclose(found, y + part * (swings - y), atol=1e-12)


@pytest.mark.parametrize(
    ("side", "first"),
    [(0.0, [0.0, 0.4]), (-0.5, [-0.05, 0.4]), (1.0, [0.1, 0.4])],
    ids=["middle", "after a rise", "after a fall"],
)
@pytest.mark.parametrize("law", [InputPlay(), OutputPlay()], ids=lambda law: law.name)
def test_play_keeps_a_band(law: Any, side: float, first: list[float]) -> None:
    """Closed form: it stays within half of the play, moves only when pushed, and forgets where it
    began."""
    scale = sizes_of("muscle")
    span = scale.u_span if law.stage == "input" else scale.y_span
    moved = span * np.array([0.0, 0.5, 0.45, 0.3, 0.35, 0.9])
    found = law.apply(np.array([0.2, side]), np.arange(6.0), moved, scale) / span
    np.testing.assert_allclose(found, [*first, 0.4, 0.4, 0.4, 0.8], atol=1e-12)


def test_a_damping_is_known_at_its_knots() -> None:
    """Straight between them, constant beyond."""
    law, scale, out = PositionDamping(), sizes_of("muscle"), np.zeros(6)
    knots = [0.0, 0.5, -0.2, 0.1, 0.3, 1.0, 0.0, 0.2, 0.4, -0.5, 2.0]
    assert len(knots) == len(law.amplitudes)
    eta = np.array([*knots, *law.constants(scale)])
    for share, expected in ((-0.5, 0.0), (0.05, 0.25), (0.2, -0.2), (0.95, 0.75), (2.0, 2.0)):
        out[:] = 0.0
        law.step(scale.x_low + share * scale.x_span, 0.0, 0.0, 0.0, 0.0, eta, out)
        assert out[DAMPING] == pytest.approx(expected, abs=1e-5)


def test_an_inertia_goes_straight_with_the_position() -> None:
    """The model's own at the lower end, (1 + g) times that at the upper one and beyond."""
    law, scale, out = PositionInertia(), sizes_of("muscle"), np.zeros(6)
    eta = np.array([2.0, *law.constants(scale)])
    for share, expected in ((-0.5, 0.0), (0.0, 0.0), (0.25, 0.5), (1.0, 2.0), (2.0, 2.0)):
        out[:] = 0.0
        law.step(scale.x_low + share * scale.x_span, 0.0, 0.0, 0.0, 0.0, eta, out)
        assert out[INERTIA] == pytest.approx(expected, abs=1e-12)


def test_a_spring_of_any_shape_follows_a_parabola() -> None:
    """Closed form: chords of a parabola have its slopes, so it is met everywhere between the second
    knot and the last but one; with nothing at both ends, it pulls with nothing beyond."""
    law, scale, out = FreeSpring(), sizes_of("muscle"), np.zeros(8)
    xi = np.arange(1, 10) / 10.0
    eta = np.array([*(xi * (1.0 - xi)), *law.constants(scale)])
    low, span = scale.x_low - MARGIN * scale.x_span, (1.0 + 2.0 * MARGIN) * scale.x_span
    for place in (-0.3, 0.0, 0.1, 0.13, 0.5, 0.77, 0.9, 1.0, 1.4):
        out[:] = 0.0
        law.step(low + place * span, 0.0, 0.0, 0.0, 0.0, eta, out)
        expected = scale.force * max(place * (1.0 - place), 0.0)
        assert out[FORCE] == pytest.approx(expected, abs=1e-9 * scale.force)


def test_a_fine_curve_follows_a_parabola() -> None:
    """Closed form as above, of the input; the first knot is zero, and all is level outside."""
    law, scale = FineCurve(), sizes_of("muscle")
    xi = np.arange(1, 13) / 12.0
    eta = np.array([*(xi * (1.5 - xi)), *law.constants(scale)])
    for place in (-0.3, 0.0, 1.0 / 12.0, 0.2, 0.5, 0.77, 11.0 / 12.0, 1.0, 1.4):
        out = np.zeros(8)
        law.step(0.0, 0.0, 0.0, scale.u_low + place * scale.u_span, 0.0, eta, out)
        inside = min(max(place, 0.0), 1.0)
        assert out[SHIFT] == pytest.approx(scale.x_span * inside * (1.5 - inside))


def test_a_spring_stiffens_with_a_power() -> None:
    """By hand: half way 0.5⁴ of the force at the largest position is left, to either side."""
    law, scale = PowerSpring(), sizes_of("muscle")
    unit, largest = law.constants(scale)
    for place in (0.5, -0.5):
        out = np.zeros(8)
        law.step(place * largest, 0.0, 0.0, 0.0, 0.0, np.array([0.3, 4.0, unit, largest]), out)
        assert out[FORCE] == pytest.approx(math.copysign(0.3 * 0.5**4 * unit, place))


def test_a_stiffness_settles() -> None:
    """Closed form: of a share of 0.2 that it gains with 10 s, 1 − 1/e is there after 10 s."""
    for time_s, expected in ((0.0, 0.0), (10.0, 0.2 * (1.0 - np.exp(-1.0))), (500.0, 0.2)):
        out = np.zeros(8)
        SettlingStiffness.step(0.0, 0.0, 0.0, 0.0, time_s, np.array([0.2, 10.0]), out)
        assert out[STIFFNESS] == pytest.approx(expected)


def test_a_gain_settles() -> None:
    """Closed form: a reading of 2 gains 0.2 of itself, of which 1 − 1/e is there after 10 s."""
    eta, time_s = np.array([0.2, 10.0]), np.array([0.0, 10.0, 500.0])
    found = SettlingGain().apply(eta, time_s, np.full(3, 2.0), sizes_of("muscle"))
    assert found == pytest.approx([2.0, 2.0 * (1.2 - 0.2 * np.exp(-1.0)), 2.4])


def test_a_softening_recovers_with_its_time() -> None:
    """By hand: of a share of 0.2 all but exp(−0.5) is gone; |v|/W0 − w/τ = 3/6 − 0.5/10."""
    out = np.zeros(8)
    eta = np.array([0.2, 6.0, 10.0])
    RecoveringSoftening.step(0.0, -3.0, 0.5, 0.0, 0.0, eta, out)
    assert out[STIFFNESS] == pytest.approx(-0.2 * (1.0 - np.exp(-0.5)))
    assert out[RATE] == pytest.approx(0.45)


@pytest.mark.parametrize(("up", "down"), [(0.05, 0.2), (0.2, 0.05), (0.1, 0.1)])
def test_a_valve_opens_and_closes_after_other_times(up: float, down: float) -> None:
    """Closed form: a ramp up comes late by the one time, a ramp down by the other."""
    time_s, scale = np.arange(800) / 100.0, sizes_of("muscle")
    corners = np.array([1.0, 2.0, 5.0, 6.0])
    found = UnevenDelay().apply(
        np.array([up, down]), time_s, np.interp(time_s, corners, [0.0, 1.0, 1.0, 0.0]), scale
    )
    late = corners + np.array([up, up, down, down])
    np.testing.assert_allclose(found, np.interp(time_s, late, [0.0, 1.0, 1.0, 0.0]), atol=1e-9)


@pytest.mark.parametrize("law", [*UNLISTED_LAWS, *LAWS_BESIDE], ids=lambda law: law.name)
def test_starts_lie_within_the_bounds(law: Any) -> None:
    scale = sizes_of("muscle")
    declared = law().parameters(scale)
    for start in law().starts(scale):
        assert set(start) == set(declared.names)
        for name, value in start.items():
            assert declared[name].lower <= value <= declared[name].upper


@pytest.mark.parametrize("law", [*UNLISTED_LAWS, *LAWS_BESIDE], ids=lambda law: law.name)
def test_the_law_names_every_parameter_and_says_what_it_is(law: Any) -> None:
    declared = law().parameters(sizes_of("muscle"))
    assert unnamed_in(law().law, declared.names) == set()
    for p in declared.values():
        assert p.meaning
        assert p.source


def test_they_are_told_and_are_in_no_catalogue() -> None:
    names = {law.name for law in (*UNLISTED_LAWS, *LAWS_BESIDE)}
    told = {name for known in REPLACED for name in known.effects}
    assert told <= names <= set(UNLISTED)
    assert not names & {key.split(".")[0] for key in EFFECTS}
    assert set(CHANGING.effects) < names
    assert set(DRIFTS) <= set(EFFECTS)


def test_a_stiffness_goes_with_the_pressure() -> None:
    """By hand: half way through the range of the input both gain half, beyond it no more."""
    scale = sizes_of("muscle")
    eta = np.array([0.6, -0.2, *PressureStiffness().constants(scale)])
    for u, share in (
        (scale.u_low - 1.0, 0.0),
        (scale.u_low + 0.5 * scale.u_span, 0.5),
        (scale.u_high + 1.0, 1.0),
    ):
        out = np.zeros(8)
        PressureStiffness.step(0.3, 0.1, 0.0, u, 0.0, eta, out)
        assert out[STIFFNESS] == pytest.approx(0.6 * share)
        assert out[DAMPING] == pytest.approx(-0.2 * share)


def test_a_stiffness_that_goes_with_the_pressure_is_asked_of_linear_bases_alone() -> None:
    """The muscle has it itself."""
    assert set(UNLISTED_LAWS) - set(suiting(UNLISTED_LAWS, is_linear=False)) == {PressureStiffness}
    assert suiting(UNLISTED_LAWS, is_linear=True) == UNLISTED_LAWS


def test_friction_goes_with_the_position() -> None:
    """By hand: half way through the range it has gained half of its share; it holds either way."""
    scale, law = sizes_of("muscle"), PositionFriction()
    eta = np.array([2.0, 1e-6, 3.0, *law.constants(scale)])
    for share, v, expected in ((0.0, 1.0, 2.0), (0.5, -1.0, -5.0), (2.0, 1.0, 8.0)):
        out = np.zeros(8)
        law.step(scale.x_low + share * scale.x_span, v, 0.0, 0.0, 0.0, eta, out)
        assert out[FORCE] == pytest.approx(expected)
    assert law.rate(eta[:3], scale) > law.rate(np.array([2.0, 1e-6, 0.0]), scale) > 0.0
