"""The repaired theory of Zhao et al. on its golden numbers and on an energy balance of its own."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import softid
from softid.errors import UsageError
from softid.log import Log
from softid.models import MODELS, Yeoh
from softid.models.bulge import LARGEST_BULGE_RAD, BulgeGeometry, pressure_terms, strain
from softid.models.zhao2021 import FINITE_ELEMENT_ANGLE_RAD, PRESSURE_KPA
from softid.models.zhao2021_theory import (
    claims,
    fitted_width_mm,
    printed_energy_pressure,
    repaired_angles,
    repaired_errors_percent,
)

ZHAO = Yeoh().geometry
THETA = np.array([14.7, 0.09, 0.02])


def _sweep(width_mm: float, *, zero_rad: float = 0.1, seed: int = 0) -> Log:
    """Levels 0 to 80 kPa, each held for 100 samples, with noise of both channels."""
    rng = np.random.default_rng(seed)
    level = np.repeat(np.arange(0.0, 90.0, 10.0), 100)
    angle = repaired_angles(width_mm, level) + zero_rad
    channels = {
        "pressure": level + rng.normal(0.0, 0.05, level.size),
        "angle": angle + rng.normal(0.0, 0.003, level.size),
    }
    return Log.from_arrays(0.1 * np.arange(level.size), channels, name="sweep")


def test_golden_numbers_of_the_bulge() -> None:
    """δ(2.88) = .7012671, λ = 1.0207884, Φ(1) = 4.1334269, A(1) = 62.8498 mm², all as computed
    from the corrected Eq 12 to 16 by two other ways; the last digit is rounding."""
    bulge = ZHAO.bulge_of_angle([2.88])
    assert bulge[0] == pytest.approx(0.7012671, abs=5e-8)
    assert 1.0 + strain(bulge).value[0] == pytest.approx(1.0207884, abs=5e-8)
    assert ZHAO.angle(np.array([1.0])).value[0] == pytest.approx(4.1334269, abs=5e-8)
    assert ZHAO.area(np.array([1.0])).value[0] == pytest.approx(62.8498, abs=5e-5)


def test_the_width_that_fits_the_table_best() -> None:
    """w ≈ 14.7 mm leaves at most 12.8 %, the figures of an independent evaluation, as rounded."""
    width = fitted_width_mm()
    assert width == pytest.approx(14.7, abs=0.05)
    assert np.abs(repaired_errors_percent(width)).max() == pytest.approx(12.8, abs=0.05)
    for other in (0.99 * width, 1.01 * width):
        assert np.abs(repaired_errors_percent(other)).max() > 12.8


def test_the_pressure_is_the_derivative_of_the_energy() -> None:
    """Central differences of energies by quadrature, to 1e-7, against the closed derivatives.

    The area is integrated over the circle of Eq 11 and the column's energy over its layers.
    """

    def strain_energy(lam: float) -> float:
        return 0.09 * (lam - 1 / lam) ** 2 + 0.02 * (lam - 1 / lam) ** 4

    def energy(bulge: float) -> float:
        phi = 26.0 * np.arctan(27.0 / 43.0 * np.tan(bulge / 4))
        column = quad(lambda y: strain_energy(1 + y * phi / 160), 0, 16, epsabs=1e-13)[0]
        wall = strain_energy(bulge / (2 * np.sin(bulge / 2)))
        return 26 * 2 * 27 * wall + 160 * column + 0.5 * 1.1 / 14.7 * (16 * phi / 2) ** 2

    def area(bulge: float) -> float:
        radius = 27.0 / (2 * np.sin(bulge / 2))
        depth = radius * np.cos(bulge / 2)
        return quad(lambda x: np.sqrt(radius**2 - x**2) - depth, -13.5, 13.5, epsabs=1e-11)[0]

    weights = np.array([0.09, 0.02, 1.1 / 14.7])
    for bulge in (0.2, 0.7, 1.5, 2.5):
        h = 1e-4 * bulge
        work = energy(bulge + h) - energy(bulge - h)
        expected = 1e3 * work / (26 * (area(bulge + h) - area(bulge - h)))
        terms, _ = pressure_terms(ZHAO, np.array([bulge]))
        assert weights @ terms[:, 0] == pytest.approx(expected, rel=1e-7)


def test_slopes_are_those_of_the_terms() -> None:
    """Central differences at δ from 1e-6 to the half circle; 1e-6 is their own error."""
    bulge = np.array([1e-6, 1e-3, 0.1, 0.7, 1.5, LARGEST_BULGE_RAD])
    h = 1e-5 * bulge
    upper, lower = pressure_terms(ZHAO, bulge + h)[0], pressure_terms(ZHAO, bulge - h)[0]
    _, slopes = pressure_terms(ZHAO, bulge)
    # C20's term vanishes like δ³, so its slope at 1e-6 is all rounding and counts for nothing.
    floor = 1e-9 * np.abs(slopes).max()
    assert (upper - lower) / (2 * h) == pytest.approx(slopes, rel=1e-6, abs=floor)


def test_derivatives_by_the_parameters() -> None:
    """Central differences through the inversion, below, at and above zero pressure."""
    model = Yeoh()
    pressure = np.array([-5.0, 0.0, 1e-3, 1.0, 40.0, 200.0])
    segment = Log.from_arrays(
        np.arange(6.0), {"pressure": pressure, "angle": np.arange(6.0)}
    ).segments()[0]

    def angle(theta: np.ndarray) -> np.ndarray:
        return model.static_output(theta, pressure, "angle")

    found = model.response(THETA, segment, ("angle",), start=None, derivatives=True)
    assert found.by_parameter is not None
    for k in range(3):
        step = np.zeros(3)
        step[k] = 1e-5 * THETA[k]
        slope = (angle(THETA + step) - angle(THETA - step)) / (2 * step[k])
        assert found.by_parameter["angle"][:, k] == pytest.approx(slope, rel=1e-6, abs=1e-9)


def test_the_curve_starts_at_zero_and_ends_at_the_half_circle() -> None:
    """Smooth through zero by its tangent; NaN above 245.4 kPa, where the walls are half circles."""
    model = Yeoh()
    small = model.static_output(THETA, np.array([-1e-3, 0.0, 1e-3]), "angle")
    assert small[1] == 0.0
    assert small[0] == pytest.approx(-small[2], rel=1e-5)
    terms, _ = pressure_terms(ZHAO, np.array([LARGEST_BULGE_RAD]))
    edge = float(np.array([0.09, 0.02, 1.1 / 14.7]) @ terms[:, 0])
    ends = model.static_output(THETA, np.array([0.9999 * edge, 1.0001 * edge]), "angle")
    assert np.isfinite(ends).tolist() == [True, False]


def test_a_stiff_spring_ends_the_curve_early() -> None:
    """At w = 1 mm the pressure has a maximum before the half circle: below it the angle rises with
    pressure, above it there is none. The maximum is that of a dense grid, to the table's 1 %."""
    theta = np.array([1.0, 0.09, 0.02])
    terms, _ = pressure_terms(ZHAO, np.linspace(1e-3, LARGEST_BULGE_RAD, 20001))
    highest = float((np.array([0.09, 0.02, 1.1]) @ terms).max())
    grid = highest * np.array([0.2, 0.5, 0.9, 0.99, 1.001])
    angle = Yeoh().static_output(theta, grid, "angle")
    assert np.isfinite(angle).tolist() == [True] * 4 + [False]
    assert (np.diff(angle[:4]) > 0).all()
    back = pressure_terms(ZHAO, ZHAO.bulge_of_angle(angle[:4]))[0]
    assert np.array([0.09, 0.02, 1.1]) @ back == pytest.approx(grid[:4], rel=1e-12)


def test_a_fit_finds_the_width_and_its_error() -> None:
    """20 sweeps of width 20 mm with noise and a sensor zero: errors over standard errors have unit
    spread, within a factor of 1.6 (0.1 % of χ² on 20 lies outside), and no bias (3 sigma)."""
    pulls = []
    for seed in range(20):
        result = softid.fit(_sweep(20.0, seed=seed), model="yeoh")
        width = result.parameter("w")
        pulls.append((width.value - 20.0) / width.stderr)
        assert result.success
    assert 1 / 1.6 < np.std(pulls) < 1.6
    assert abs(np.mean(pulls)) < 3 / np.sqrt(20)


def test_the_model_is_taken_only_by_name() -> None:
    """Its dimensions belong to one actuator, so the choice by data never meets it."""
    assert MODELS["yeoh"]().variants("pressure") == ()


@pytest.mark.parametrize(
    "options", [{"wall_mm": 0.0}, {"foot_mm": 35.0}, {"chambers": 2.5}, {"spring_n_per_mm": -1.0}]
)
def test_impossible_dimensions_are_refused(options: dict[str, float]) -> None:
    """Lengths, counts and stiffness are positive, and the foot is part of the wall."""
    with pytest.raises(UsageError):
        Yeoh(**options)


def test_printed_energies_cannot_give_the_table() -> None:
    """k in N/mm: at least 168.169 kPa for any bulge and 782 kPa on Table 2, which spans 10 to 80.

    The least is at the half circle, where λ = π/2 and every term of Eq 15 to 21 is closed; at other
    bulges the area comes from quadrature of Eq 11, the energies by hand. With N/m, and without
    spring, the printed balance stays below 10 kPa.
    """
    highest = float(ZHAO.angle(np.array([LARGEST_BULGE_RAD])).value[0])
    grid = np.linspace(0.01, highest * (1 - 1e-9), 2000)
    found = printed_energy_pressure(grid)
    assert (np.diff(found) < 0.0).all()
    e = np.pi / 2 - 2 / np.pi
    energy = (26 * 2 * 27 + 160 * 16) * (0.09 * e**2 + 0.02 * e**4) + 1.1 * 160**2 / 32
    half_circle = 1e3 * energy / (26 * np.pi * 27**2 / 8)
    assert half_circle == pytest.approx(168.1689, abs=5e-5)
    assert found.min() == pytest.approx(half_circle, rel=1e-8)
    for bulge in (0.7, 2.0):
        radius = 27 / (2 * np.sin(bulge / 2))
        depth = radius * np.cos(bulge / 2)
        area = quad(lambda x: np.sqrt(radius**2 - x**2) - depth, -13.5, 13.5, epsabs=1e-11)[0]  # noqa: B023
        lam = bulge / (2 * np.sin(bulge / 2))
        e = lam - 1 / lam
        energy = (26 * 2 * 27 + 160 * 16) * (0.09 * e**2 + 0.02 * e**4) + 1.1 * 160**2 / 32
        angle = ZHAO.angle(np.array([bulge])).value
        assert printed_energy_pressure(angle)[0] == pytest.approx(
            1e3 * energy / 26 / area, rel=1e-9
        )
    table = np.array(FINITE_ELEMENT_ANGLE_RAD)
    assert printed_energy_pressure(table).min() == pytest.approx(782.0, abs=0.5)
    for k in (1.1e-3, 0.0):
        assert printed_energy_pressure(table, spring_n_per_mm=k).max() < min(PRESSURE_KPA)
    with pytest.raises(UsageError):
        printed_energy_pressure([0.0])


def test_claims_beside_the_tables() -> None:
    """0.2246 rad and 9.16 % from Tables 2 and 4; 7.99 and 7.69 % are errors at the endpoint."""
    test_abs, test_rel, theory_abs, theory_rel = claims()
    assert test_abs.computed == pytest.approx(0.2246, abs=5e-5)
    assert test_rel.computed == pytest.approx(9.16, abs=5e-3)
    assert theory_rel.computed == pytest.approx(12.8, abs=0.05)
    assert [c.agrees for c in (test_abs, test_rel, theory_abs, theory_rel)] == [True] + 3 * [False]
    end = FINITE_ELEMENT_ANGLE_RAD[-1]
    assert round(100 * 0.23 / end, 2) == test_rel.stated
    assert round(100 * 0.24 / (end + 0.24), 2) == theory_rel.stated


def test_another_actuator() -> None:
    """A geometry of its own: the bulge and the angle are inverse to each other."""
    other = BulgeGeometry(20.0, 5.0, 1.5, 8.0, 90.0, 9)
    bulge = np.linspace(0.0, LARGEST_BULGE_RAD, 7)
    assert other.bulge_of_angle(other.angle(bulge).value) == pytest.approx(bulge, abs=1e-12)
