"""The compiled equation of motion: golden numbers, energy, derivatives, convergence, rest."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from softid.kernels.bending import (
    N_DYNAMIC,
    acceleration,
    acceleration_slopes,
    fastest_rates,
    propagate_bending,
    propagate_bending_with_sensitivities,
    rest_angle,
    torque_parts,
)
from softid.kernels.bending_body import (
    CELLS,
    Body,
    elastic_parts,
    elastic_torque,
    inertia_parts,
    parts_at,
    parts_with_slopes_at,
)
from softid.models.actuator_geometry import Actuator

BODY = Actuator().body("root-moment", "exact")
THETA = np.array([4.5e-4, 0.2, -0.3, 1.3, 1.0, 1.0, 0.0, 0.0])


def run(
    theta: np.ndarray, pressure_kpa: float, start: tuple[float, float], steps: int, step_s: float
) -> np.ndarray:
    """(θ, θ̇) at all steps under a constant pressure, the start first."""
    states = np.empty((steps, 2))
    pressures = np.full((steps, 3), pressure_kpa)
    state = np.array(start)
    propagate_bending(np.full(steps, step_s), pressures, theta, BODY, state, states)
    np.testing.assert_array_equal(state, states[-1])
    return np.vstack((start, states))


def test_golden_numbers() -> None:
    """The reference actuator, each number computed by two methods apart from this code."""
    m, _, d, _ = inertia_parts(1.0, BODY)
    assert m == pytest.approx(6.4424637e-5 + 1.7499323e-6, rel=1e-8)
    assert d == pytest.approx(-7.398970e-6, rel=1e-7)
    assert elastic_torque(1.0, BODY) == pytest.approx(0.041949544, rel=2e-8)
    assert rest_angle(20.0, THETA, BODY) == pytest.approx(0.7048266347, abs=1e-10)
    swing, fading = fastest_rates(np.array([0.7048266347]), THETA, BODY)
    assert swing / (2 * np.pi) == pytest.approx(3.7, abs=0.05)
    assert fading / (2 * swing) == pytest.approx(0.12, abs=0.005)


def test_the_other_bank_mirrors() -> None:
    """Every part is odd or even in θ, so −p from −θ₀ gives the mirrored motion to the last bit."""
    there = run(THETA, 20.0, (0.1, 0.5), 3000, 1e-3)
    mirrored = run(THETA, -20.0, (-0.1, -0.5), 3000, 1e-3)
    np.testing.assert_array_equal(mirrored, -there)
    assert rest_angle(-20.0, THETA, BODY) == -rest_angle(20.0, THETA, BODY)


def test_inertia_derivatives() -> None:
    """D ≡ dM/dθ holds exactly for the root moment; D′ by central differences, error about h²."""
    for angle in (-2.5, -1e-6, 0.0, 0.3, 3.2):
        _, m_by, d, d_by = inertia_parts(angle, BODY)
        assert d == pytest.approx(m_by, rel=1e-12, abs=1e-25)
        h = 1e-5
        moved = inertia_parts(angle + h, BODY)[2] - inertia_parts(angle - h, BODY)[2]
        assert d_by == pytest.approx(moved / (2 * h), rel=1e-8)


def test_elastic_torque_is_the_slope_of_an_energy() -> None:
    """K = dU/dθ, so dK/dθ by central differences, and K against adaptive quadrature of the wall."""
    a = Actuator()
    chambers_m = a.chambers * a.chamber_length_m

    def stress(stretch: float) -> float:
        grown = 2 * a.c10_pa + 4 * a.c20_pa * (stretch - 1 / stretch) ** 2
        return (stretch**4 - 1) / stretch**3 * grown

    for angle in (1e-6, 0.7, 1.5, 3.2):

        def both(y: float, angle: float = angle) -> float:
            z = y * angle / chambers_m
            return y * (stress(1 + z) - stress(1 - z))

        sides = 2 * a.wall_m * quad(both, 0, a.chamber_height_m, epsabs=0, epsrel=1e-12)[0]
        top = both(a.chamber_height_m + a.wall_m / 2) * a.wall_m * a.outer_width_m
        layer = a.layer_modulus_pa * a.outer_width_m * a.layer_m**3 / 12 / a.length_m * angle
        torque, slope = elastic_parts(angle, BODY)
        assert torque == pytest.approx(elastic_torque(angle, BODY), rel=1e-11)
        assert torque == pytest.approx(sides + top + layer, rel=1e-9)
        moved = elastic_torque(angle + 1e-5, BODY) - elastic_torque(angle - 1e-5, BODY)
        assert slope == pytest.approx(moved / 2e-5, rel=1e-6)


WIDEST = CELLS / float(BODY.constants[4])
"""The largest angle of the table."""


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.01, 0.7, -1.9, 3.2, 0.999 * WIDEST, -1.05 * WIDEST])
def test_the_table_holds_what_its_series_say(angle: float) -> None:
    """To rounding, until the wall has lost nine tenths of its length; beyond, by the series."""
    m, m_by, d, d_by = inertia_parts(angle, BODY)
    k, k_by = elastic_parts(angle, BODY)
    exact = np.array([m, m_by, d, d_by, k, k_by])
    size = np.abs([m, m, m, m, max(abs(k), 0.01 * k_by), k_by])
    found = parts_with_slopes_at(angle, BODY)
    assert np.all(np.abs(found - exact) <= 1e-10 * size)
    assert parts_at(angle, BODY) == pytest.approx((m, d, k), rel=1e-10, abs=1e-16)
    assert parts_at(0.0, BODY)[1:] == (0.0, 0.0)


def test_the_table_is_no_rougher_than_rounding_where_it_is_used() -> None:
    """Over half a circle, the largest difference of M, D and K from their series, by their size."""
    for angle in np.linspace(-np.pi, np.pi, 4001).tolist():
        m, _, d, _ = inertia_parts(angle, BODY)
        k = elastic_torque(angle, BODY)
        found = parts_at(angle, BODY)
        assert found[0] == pytest.approx(m, rel=1e-14)
        assert found[1] == pytest.approx(d, abs=1e-14 * m)
        assert found[2] == pytest.approx(k, rel=1e-12, abs=1e-17)


def test_parts_make_the_acceleration() -> None:
    """m·θ̈ + inertial + damping + elastic = driving, and both forms of θ̈ agree to rounding."""
    theta = np.array([5e-4, 0.1, -0.2, 1.1, 0.9, 1.2, 1e-3])
    slopes = np.empty(N_DYNAMIC + 2)
    for state in ((0.0, 0.0, 5.0), (0.8, -12.0, 20.0), (-1.4, 3.0, -30.0)):
        m, inertial, damping, elastic, driving = torque_parts(*state, theta, BODY)
        found = acceleration(*state, theta, BODY)
        assert m * found + inertial + damping + elastic == pytest.approx(driving, abs=1e-15)
        assert acceleration_slopes(*state, theta, BODY, slopes) == pytest.approx(found, rel=1e-12)


def test_slopes_of_the_acceleration() -> None:
    """Central differences of θ̈ by all seven parameters, θ and θ̇; their error is about 1e-8."""
    theta = np.array([5e-4, 0.1, -0.2, 1.1, 0.9, 1.2, 1e-3])
    slopes = np.empty(N_DYNAMIC + 2)
    for angle, speed in ((0.8, -7.0), (-1.2, 4.0)):
        acceleration_slopes(angle, speed, 20.0, theta, BODY, slopes)
        sizes = np.append(np.maximum(np.abs(theta), 1e-4), (1.0, 1.0))
        for k, size in enumerate(sizes):
            ends = []
            for sign in (1.0, -1.0):
                at, state = theta.copy(), [angle, speed]
                if k < N_DYNAMIC:
                    at[k] += sign * 1e-6 * size
                else:
                    state[k - N_DYNAMIC] += sign * 1e-6
                ends.append(acceleration(*state, 20.0, at, BODY))
            step = 2e-6 * size
            assert slopes[k] == pytest.approx((ends[0] - ends[1]) / step, rel=1e-6, abs=1e-6), k


def energy(states: np.ndarray, theta: np.ndarray, pressure_kpa: float) -> np.ndarray:
    """½(M·θ̇)² − ∫M·(F − K)/C_m dθ, constant without damping."""

    def pull(angle: float) -> float:
        m, _, _, elastic, driving = torque_parts(angle, 0.0, pressure_kpa, theta, BODY)
        mass = inertia_parts(angle, BODY)[0]
        return mass * (driving - elastic) / (m / mass)

    found = []
    for angle, speed in states:
        momentum = inertia_parts(angle, BODY)[0] * speed
        work = quad(pull, 0.0, angle, epsabs=0, epsrel=1e-11)[0]
        found.append(0.5 * momentum**2 - work)
    return np.array(found)


def test_the_undamped_invariant() -> None:
    """d/dt(M·θ̇) = M·θ̈ + D·θ̇², so ½(Mθ̇)² − ∫M(F−K)/C_m dθ stays to 1e-7 in 5 s.

    The rule itself drifts by less at 1 kHz; a speed that is 5 % off breaks it by a hundredth.
    """
    theta = THETA.copy()
    theta[0] = 0.0
    states = run(theta, 20.0, (0.0, 0.0), 5000, 1e-3)[::100]
    kinetic = 0.5 * max((inertia_parts(a, BODY)[0] * v) ** 2 for a, v in states)
    drifted = energy(states, theta, 20.0)
    assert np.ptp(drifted) < 1e-7 * kinetic
    wrong = energy(states * [1.0, 1.05], theta, 20.0)
    assert np.ptp(wrong) > 1e-2 * kinetic


def test_the_rule_has_order_four() -> None:
    """Half the step, a sixteenth of the error, against DOP853; positive C_m without a kink."""
    theta = THETA.copy()
    theta[2] = 0.0

    def rates(time_s: float, y: np.ndarray) -> list[float]:
        return [y[1], acceleration(y[0], y[1], 20.0, theta, BODY)]

    exact = solve_ivp(rates, (0.0, 0.8), [0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-13)
    errors = [
        abs(run(theta, 20.0, (0.0, 0.0), n, 0.8 / n)[-1, 0] - exact.y[0, -1]) for n in (100, 200)
    ]
    assert 12.0 < errors[0] / errors[1] < 20.0


def test_sensitivities_are_those_of_the_computed_solution() -> None:
    """Central differences of the same steps: within 1e-6, the differences' own error."""
    n = 1500
    theta = THETA.copy()
    theta[6] = 1e-4
    pressures = np.tile(20.0 * (1.0 - np.exp(-np.arange(n) / 30.0))[:, None], (1, 3))
    steps = np.full(n, 2e-3)
    tangent = np.zeros((2, N_DYNAMIC + 2))
    tangent[0, N_DYNAMIC] = tangent[1, N_DYNAMIC + 1] = 1.0
    states, tangents = np.empty((n, 2)), np.empty((n, N_DYNAMIC + 2))
    start = np.array([0.05, -0.3])
    propagate_bending_with_sensitivities(
        steps, pressures, theta, BODY, start.copy(), tangent, states, tangents
    )
    plain = np.empty((n, 2))
    propagate_bending(steps, pressures, theta, BODY, start.copy(), plain)
    np.testing.assert_allclose(states, plain, atol=1e-12)
    for k in range(N_DYNAMIC + 2):
        size = max(abs(theta[k]), 1e-4) if k < N_DYNAMIC else 1.0
        ends = []
        for sign in (1.0, -1.0):
            at, first = theta.copy(), start.copy()
            if k < N_DYNAMIC:
                at[k] += sign * 1e-6 * size
            else:
                first[k - N_DYNAMIC] += sign * 1e-6
            moved = np.empty((n, 2))
            propagate_bending(steps, pressures, at, BODY, first, moved)
            ends.append(moved[:, 0])
        numeric = (ends[0] - ends[1]) / (2e-6 * size)
        assert np.abs(tangents[:, k] - numeric).max() < 1e-6 * np.abs(numeric).max(), k
        assert tangent[0, k] == tangents[-1, k]


def test_what_is_no_motion_is_nan() -> None:
    """Beyond a full circle, and where C_m is not positive: the trial is refused, not clipped."""
    assert np.isnan(acceleration(6.4, 0.0, 0.0, THETA, BODY))
    light = THETA.copy()
    light[1:4] = 0.0, -2.0, 1.3
    assert np.isfinite(acceleration(0.6, 0.0, 0.0, light, BODY))
    assert np.isnan(acceleration(0.7, 0.0, 0.0, light, BODY))
    assert np.isnan(run(light, 20.0, (0.0, 0.0), 200, 1e-3)[-1, 0])


def test_rest_angle_balances_or_is_nan() -> None:
    """s·K + τ0 = d·F to 1e-12 of F wherever there is an angle; a huge pressure has none."""
    theta = np.array([4.5e-4, 0.2, -0.3, 1.3, 0.7, 1.1, 2e-3])
    for pressure_kpa in (-40.0, -3.0, 0.0, 1e-9, 25.0, 60.0):
        angle = rest_angle(pressure_kpa, theta, BODY)
        _, _, _, elastic, driving = torque_parts(angle, 0.0, pressure_kpa, theta, BODY)
        assert elastic == pytest.approx(driving, abs=1e-12 * max(abs(driving), 1e-2))
    assert np.isnan(rest_angle(1e5, theta, BODY))


def test_a_body_is_plain_arrays() -> None:
    """Other code builds one too; its fields are the contract."""
    assert Body._fields == ("inertia", "velocity", "stretch", "lever", "constants", "table")
