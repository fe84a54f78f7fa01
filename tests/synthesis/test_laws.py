"""Laws against the numbers that were computed from the papers, each by two methods."""

from __future__ import annotations

import numpy as np
import pytest

from softid.errors import InputError
from softid.synthesis import bundled_datasets, load_recipe
from softid.synthesis.laws import Arc, muscle_motion, parameter_units, polynomial_units, quartic

TENS_KPA = np.arange(10.0, 81.0, 10.0)
# Zhao et al. 2021, Tables 4 and 5 evaluated at 10 … 80 kPa.
ZHAO = {
    ("zhao_middle", "angle"): (
        0.36203, 0.68260, 1.12002, 1.59060, 2.02562, 2.37140, 2.58923, 2.65540,
    ),
    ("zhao_left_right", "angle"): (
        0.32808, 0.68068, 1.05848, 1.35888, 1.53400, 1.59068, 1.59048, 1.64968,
    ),
    ("zhao_middle", "torque"): (
        51.894, 97.468, 160.442, 228.492, 291.540, 341.756, 373.554, 383.596,
    ),
    ("zhao_left_right", "torque"): (
        43.186, 89.716, 139.706, 178.396, 198.850, 201.956, 196.426, 198.796,
    ),
}  # fmt: skip


@pytest.mark.parametrize(("log", "channel"), list(ZHAO))
def test_bundled_quartics_are_the_printed_ones(log: str, channel: str) -> None:
    """The recipes' coefficients give the golden values to their last printed digit."""
    recipe = load_recipe(bundled_datasets() / "recipes" / f"{log}.toml")
    coefficients = tuple(recipe.parameters[f"{channel}.p{k}"] for k in range(1, 6))
    last_digit = 1e-5 if channel == "angle" else 1e-3
    golden = np.array(ZHAO[log, channel])
    assert np.abs(quartic(coefficients, TENS_KPA) - golden).max() < 0.6 * last_digit


@pytest.mark.parametrize(
    ("contraction_mm", "distance_mm"),
    [(10.0, 143.494296), (30.0, 122.694977), (60.0, 79.799599)],
)
def test_distance_of_the_arc(contraction_mm: float, distance_mm: float) -> None:
    """Ru Eq 1 with d the diameter; L0 = 150 mm, d = 20 mm. A radius would give 124.7 for 109.4."""
    found = Arc(150.0, 20.0).distance_mm(np.array([contraction_mm]))[0]
    assert found == pytest.approx(distance_mm, abs=5e-7)


def test_both_printed_forms_of_the_distance_agree() -> None:
    """Ru Eq 1 is D = d·(L0+L)/(L0−L)·sin((L0−L)/2d); Eq 2 is D = 2 sin(θ/2)·(L/θ + d/2)."""
    arc = Arc(150.0, 20.0)
    x = np.linspace(0.5, 120.0, 50)
    length, theta = 150.0 - x, arc.angle_rad(x)
    first = 20.0 * (150.0 + length) / x * np.sin(x / 40.0)
    second = 2.0 * np.sin(theta / 2.0) * (length / theta + 10.0)
    assert np.abs(arc.distance_mm(x) - first).max() < 1e-11
    assert np.abs(arc.distance_mm(x) - second).max() < 1e-11


@pytest.mark.parametrize("contraction_mm", [0.0, -1.0, 126.0])
def test_distance_refuses_its_other_branch(contraction_mm: float) -> None:
    """D falls on (0, 2πd) only; beyond, it belongs to two contractions."""
    with pytest.raises(InputError, match=r"between 0 and 125\.664 mm"):
        Arc(150.0, 20.0).distance_mm(np.array([20.0, contraction_mm]))


def test_muscle_rests_on_the_sigmoid() -> None:
    """x∞(p) = 1/(a1 + c1·e^(−b1 p)): 1/(a1+c1) without pressure, half of 1/a1 at the midpoint."""
    motion = muscle_motion({"M": 1, "a1": 0.01, "b1": 3.0, "c1": 0.5, "a2": 0, "b2": 0, "c2": 1})
    midpoint_kpa = 100.0 * np.log(50.0) / 3.0
    assert motion.rest(0.0) == pytest.approx(1.0 / 0.51, rel=1e-14)
    assert motion.rest(midpoint_kpa) == pytest.approx(50.0, rel=1e-12)
    for pressure_kpa in (0.0, 80.0, 250.0):
        x = motion.rest(pressure_kpa)
        forces = [term(0.0, pressure_kpa, x, 0.0) for term in motion.terms.values()]
        assert abs(sum(forces)) < 1e-12 * max(map(abs, forces))


def test_units_of_parameters() -> None:
    """N·ẋ, Q·x and M·ẍ have the unit of the drive: 1 for the muscle, kPa for the oscillator."""
    assert parameter_units("muscle", "mm")["M"] == "s²/mm"
    assert parameter_units("muscle", "rad")["a2"] == "s/rad"
    assert parameter_units("oscillator", "rad") == {
        "M": "kPa/rad·s²", "N": "kPa/rad·s", "Q": "kPa/rad", "G": "1", "offset": "kPa",
    }  # fmt: skip
    assert next(iter(polynomial_units("rad").values())) == "rad/kPa^4"
