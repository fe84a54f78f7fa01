"""Moments of inertia against quadrature, the paper's printed forms and golden numbers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import spherical_jn

from softid.models.actuator_geometry import Actuator
from softid.models.bending_inertia import (
    N_TERMS,
    Stretch,
    bending_moment_of_mass,
    inertia_series,
    rotation_inertia,
)

ROD = (Stretch(0.0, 1.0, 1.0, 0.0),)
ANGLES = (1e-6, 1e-4, 1e-3, 0.05, 0.4999, 0.5001, 1.0, 2.0, 3.2, -2.3)


def summed(series: np.ndarray, angle: float) -> float:
    return float(series @ angle ** (2 * np.arange(series.size)))


def quadrature(stretches: tuple[Stretch, ...], length_m: float, angle: float) -> tuple[float, ...]:
    """M and D by adaptive quadrature of forms that do not cancel, with h = rθ/2l0.

    1 − cos u = 2·sin²h and u·sin u + 2·(cos u − 1) = −4·sin h·h²·j₁(h), j₁ the spherical Bessel
    function.
    """
    mass = speed = 0.0
    for s in stretches:

        def heavy(r: float) -> float:
            return 2.0 * length_m * r * np.sin(0.5 * r * angle / length_m) ** 2 / angle**2

        def fast(r: float) -> float:
            h = 0.5 * r * angle / length_m
            return -4.0 * length_m * r * np.sin(h) * h**2 * spherical_jn(1, h) / angle**3

        span = (s.start_m, s.stop_m)
        mass += s.density_kg_m * quad(heavy, *span, epsabs=0, epsrel=1e-12)[0]
        if angle > 0:
            speed += s.density_kg_m * quad(fast, *span, epsabs=0, epsrel=1e-12)[0]
    return mass, speed


@pytest.mark.parametrize(("angle", "golden"), [(1.0, 0.1182267093), (2.0, 0.0998469989)])
def test_uniform_rod(angle: float, golden: float) -> None:
    """M_b/ρl³ = 1/8, 0.1182267093, 0.0998469989 at θ → 0, 1, 2; D(1)/ρl³ = −0.0132091432."""
    m, d = inertia_series(ROD, 1.0, "root-moment", "exact")
    assert m[0] == pytest.approx(0.125, rel=1e-15)
    assert summed(m, angle) == pytest.approx(golden, abs=6e-11)
    assert summed(d, 1.0) == pytest.approx(-0.0132091432, abs=6e-11)


@pytest.mark.parametrize("angle", ANGLES)
def test_the_series_is_exact(angle: float) -> None:
    """Relative error below 1e-9 for M and D up to 3.2 rad, and at 1e-6.

    The plain closed form of D is wrong by a factor of 1e4 at 1e-3 rad.
    """
    actuator = Actuator()
    stretches, length_m = actuator.stretches, actuator.length_m
    still = tuple(Stretch(s.start_m, s.stop_m, s.density_kg_m, 0.0) for s in stretches)
    mass, speed = quadrature(still, length_m, abs(angle))
    m, d = inertia_series(still, length_m, "root-moment", "exact")
    assert summed(m, angle) == pytest.approx(mass, rel=1e-9)
    assert abs(angle) * summed(d, angle) == pytest.approx(speed, rel=1e-9)


def test_velocity_term_is_the_slope_of_the_inertia() -> None:
    """D = dM/dθ for the root moment and half of it for the Lagrangian form, term by term."""
    powers = 2.0 * np.arange(1, N_TERMS)
    for form, share in (("root-moment", 1.0), ("lagrangian", 0.5)):
        m, d = inertia_series(Actuator().stretches, Actuator().length_m, form, "exact")
        np.testing.assert_allclose(d[:-1], share * powers * m[1:], rtol=1e-14)


def test_lagrangian_form() -> None:
    """M_L = ∫ρ(x_θ² + y_θ²)dr by differences of the positions; ρl³/20 at θ → 0."""
    m, _ = inertia_series(ROD, 1.0, "lagrangian", "exact")
    assert m[0] == pytest.approx(1 / 20, rel=1e-15)
    for angle in (0.5, 1.5, 3.0):

        def speed_squared(r: float, angle: float = angle) -> float:
            def place(t: float) -> np.ndarray:
                return np.array([np.sin(r * t), 1.0 - np.cos(r * t)]) / t

            h = 1e-4
            moved = place(angle - 2 * h) - 8 * place(angle - h) + 8 * place(angle + h)
            slope = (moved - place(angle + 2 * h)) / (12 * h)
            return float(slope @ slope)

        assert summed(m, angle) == pytest.approx(quad(speed_squared, 0, 1)[0], rel=1e-9)


def test_the_papers_taylor_form() -> None:
    """−1/72 and +1/36 where the consistent expansion has 1/720 and 1/180.

    Eq 7 and 8 multiplied out with sin u = u − u³/6 and cos u = 1 − u²/2 + u⁴/24. Golden: at θ = 1
    M is 1.6 % and D 19 % too small, at θ = 2 20 % and 51 %, for the reference actuator.
    """
    sine, cosine = np.poly1d([-1 / 6, 0, 1, 0]), np.poly1d([1 / 24, 0, -1 / 2, 0, 1])
    u = np.poly1d([1, 0])
    x_by, y_by = u * cosine - sine, u * sine - (1 - cosine)
    x_by_by = 2 * sine - 2 * u * cosine - u * u * sine
    y_by_by = 2 * (1 - cosine) - 2 * u * sine + u * u * cosine
    heavy = y_by * sine - x_by * (1 - cosine)
    fast = y_by_by * sine - x_by_by * (1 - cosine)
    actuator = Actuator()
    stretches, length_m = actuator.stretches, actuator.length_m
    m, d = inertia_series(stretches, length_m, "root-moment", "taylor")
    rotation = rotation_inertia(stretches, length_m, "root-moment")
    for k in range(4):
        scale = bending_moment_of_mass(stretches, 2 * k + 3) / length_m ** (2 * k + 1)
        assert m[k] == pytest.approx(heavy.coeffs[::-1][2 * k + 3] * scale + (k == 0) * rotation)
        if k > 0:
            assert d[k - 1] == pytest.approx(fast.coeffs[::-1][2 * k + 3] * scale)
    for angle, of_m, of_d in ((1.0, -0.016, -0.19), (2.0, -0.20, -0.51)):
        mass, speed = quadrature(stretches, length_m, angle)
        assert (summed(m, angle) - rotation) / mass - 1 == pytest.approx(of_m, abs=0.005)
        assert angle * summed(d, angle) / speed - 1 == pytest.approx(of_d, abs=0.005)
