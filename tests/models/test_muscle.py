"""The muscle law: static curve, outputs, units, options and errors."""

from __future__ import annotations

import numpy as np
import pytest

from softid.errors import UsageError
from softid.log import Log
from softid.models.muscle import Muscle
from softid.models.muscle_law import NAMES
from softid.segment import Segment

TRUTH = {"M": 2e-3, "a1": 1 / 70, "b1": 2.8, "c1": 1.0, "a2": 0.02, "b2": 1.6, "c2": 0.25}
THETA = np.array(list(TRUTH.values()))
PRESSURE = np.array([0.0, 50.0, 130.0, 300.0])


def held(pressure_kpa: float, *outputs: str) -> Segment:
    n = 8
    channels = {"pressure": np.full(n, pressure_kpa)} | {k: np.linspace(0, 1, n) for k in outputs}
    return Log.from_arrays(np.arange(n) * 0.1, channels, outputs=outputs).segments()[0]


def test_static_curve_is_the_sigmoid() -> None:
    """x∞ = 1/(a1 + c1·exp(−b1·p)), Ru 2019 Eq 5, with p in bar; to rounding."""
    expected = 1 / (TRUTH["a1"] + TRUTH["c1"] * np.exp(-TRUTH["b1"] * PRESSURE / 100))
    found = Muscle().static_output(THETA, PRESSURE, "contraction")
    np.testing.assert_allclose(found, expected, rtol=1e-13)
    assert found[0] == pytest.approx(1 / (TRUTH["a1"] + TRUTH["c1"]), rel=1e-13)


@pytest.mark.parametrize("order", ["second", "first", "static"])
def test_every_order_rests_on_the_static_curve(order) -> None:
    """Held pressure from rest: the response is the sigmoid for all samples."""
    model = Muscle(order=order)
    theta = np.where([p.fixed for p in model.parameters().values()], 0.0, THETA)
    found = model.response(
        theta, held(130.0, "contraction"), ("contraction",), start=None, derivatives=False
    )
    expected = 1 / (TRUTH["a1"] + TRUTH["c1"] * np.exp(-TRUTH["b1"] * 1.3))
    np.testing.assert_allclose(found.outputs["contraction"], expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("contraction", "distance"), [(10.0, 143.494296), (30.0, 122.694977), (60.0, 79.799599)]
)
def test_outputs_of_the_golden_arcs(contraction: float, distance: float) -> None:
    """Golden D(x) at L0 = 150, d = 20 mm of Ru's Eq 1 and 2; θ = x/d, L = L0 − x."""
    model = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
    theta = THETA.copy()
    theta[1] = 0.5 / contraction
    theta[3] = 0.5 / contraction  # at p = 0: x = 1/(a1 + c1)
    outputs = ("angle", "contraction", "length", "distance")
    found = model.response(theta, held(0.0, *outputs), outputs, start=None, derivatives=False)
    assert found.outputs["distance"] == pytest.approx(distance, abs=1e-6)
    assert found.outputs["angle"] == pytest.approx(contraction / 20.0, rel=1e-12)
    assert found.outputs["length"] == pytest.approx(150.0 - contraction, rel=1e-12)
    assert found.outputs["contraction"] == pytest.approx(contraction, rel=1e-12)
    static = {k: float(model.static_output(theta, np.zeros(1), k)[0]) for k in outputs}
    assert static["distance"] == pytest.approx(distance, abs=1e-6)
    assert static["length"] == pytest.approx(150.0 - contraction, rel=1e-12)


def test_damping_curve() -> None:
    """N = a2·exp(b2·p) + c2, Ru 2019 Eq 6."""
    expected = TRUTH["a2"] * np.exp(TRUTH["b2"] * PRESSURE / 100) + TRUTH["c2"]
    np.testing.assert_allclose(Muscle().damping_curve(THETA, PRESSURE), expected, rtol=1e-13)


def test_units_follow_the_output() -> None:
    """An angle without geometry makes x an angle; anything else is in mm."""
    assert Muscle().adapted({"input": "kPa", "angle": "rad"}).x_unit == "rad"
    assert Muscle().adapted({"input": "kPa", "length": "mm"}).x_unit == "mm"
    arc = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
    assert arc.adapted({"input": "kPa", "angle": "rad"}).x_unit == "mm"
    units = {p.name: p.unit for p in Muscle(x_unit="rad").parameters().values()}
    assert units["M"] == "s²/rad"
    assert units["a1"] == units["c1"] == "1/rad"
    assert units["b1"] == units["b2"] == "1/bar"
    assert units["a2"] == units["c2"] == "s/rad"


def test_inverted_outputs() -> None:
    """A falling angle or contraction has its sign turned, and so has a length that grows."""
    angle = Muscle().adapted({"input": "kPa", "angle": "rad"}, inverted=True)
    assert angle.inverted
    found = angle.static_output(THETA, PRESSURE, "angle")
    np.testing.assert_allclose(found, -Muscle().static_output(THETA, PRESSURE, "angle"))
    assert not Muscle().adapted({"input": "kPa", "length": "mm"}, inverted=True).inverted
    length = Muscle().static_output(THETA, PRESSURE, "length")
    assert np.all(np.diff(length) < 0)


def test_a_length_that_grows_is_the_fixed_length_and_x() -> None:
    """L = L0 + x, as a bellows records it: the length of Eq 1 mirrored at L0, to rounding."""
    plain = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
    growing = plain.adapted({"input": "kPa", "length": "mm"}, inverted=False)
    assert growing.inverted
    x = plain.static_output(THETA, PRESSURE, "contraction")
    assert growing.static_output(THETA, PRESSURE, "length") == pytest.approx(150.0 + x, rel=1e-13)
    segment = held(130.0, "length")
    found = growing.response(THETA, segment, ("length",), start=None, derivatives=True)
    usual = plain.response(THETA, segment, ("length",), start=None, derivatives=True)
    assert found.outputs["length"] - 150.0 == pytest.approx(150.0 - usual.outputs["length"])
    assert found.by_parameter is not None
    assert usual.by_parameter is not None
    np.testing.assert_allclose(found.by_parameter["length"], -usual.by_parameter["length"])


@pytest.mark.parametrize("units", [{"distance": "mm"}, {"angle": "rad", "length": "mm"}])
def test_linked_outputs_need_the_geometry(units: dict[str, str]) -> None:
    """Without the two lengths the outputs have no common x; the error names the options."""
    with pytest.raises(UsageError, match="arc geometry") as error:
        Muscle().adapted({"input": "kPa"} | units)
    assert "--fixed-length" in str(error.value)
    Muscle(fixed_length_mm=150.0, diameter_mm=20.0).adapted({"input": "kPa"} | units)


def test_options_are_checked() -> None:
    """One length without the other, and choices that do not exist."""
    with pytest.raises(UsageError, match="both lengths"):
        Muscle(fixed_length_mm=150.0)
    with pytest.raises(UsageError, match="order"):
        Muscle(order="third")  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="damping"):
        Muscle(damping="dry")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("options", "free"),
    [
        ({}, NAMES),
        ({"damping": "constant"}, ("M", "a1", "b1", "c1", "c2")),
        ({"order": "first"}, ("a1", "b1", "c1", "a2", "b2", "c2")),
        ({"order": "static"}, ("a1", "b1", "c1")),
    ],
)
def test_options_hold_what_they_drop(options, free) -> None:
    """Dropped terms are fixed at exactly zero."""
    declared = Muscle(**options).parameters()
    assert declared.free == free
    assert all(p.value == 0.0 for p in declared.values() if p.fixed)
    assert len(Muscle(**options).start_states) == ["static", "first", "second"].index(
        options.get("order", "second")
    )


def test_derived_quantities() -> None:
    """x_max = 1/a1, x(0) = 1/(a1 + c1), midpoint ln(c1/a1)/b1 where x is half of x_max."""
    found = Muscle().derived(TRUTH, (0.0, 300.0))
    assert found["x_max"] == (pytest.approx(70.0), "mm")
    assert found["x_at_zero_pressure"][0] == pytest.approx(1 / (TRUTH["a1"] + TRUTH["c1"]))
    middle, unit = found["midpoint_pressure"]
    assert unit == "kPa"
    half = Muscle().static_output(THETA, np.array([middle]), "contraction")[0]
    assert half == pytest.approx(35.0, rel=1e-12)


def test_a_faded_inertia_gives_the_first_order_model() -> None:
    """M/N of 1e-8 s cannot be seen at 10 ms; the options other than the order stay."""
    theta = THETA.copy()
    theta[0] = 1e-9
    model = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
    found = model.limit(theta, 0.01, (0.0, 300.0), 10.0)
    assert found is not None
    assert found[0] == Muscle(order="first", fixed_length_mm=150.0, diameter_mm=20.0)
    assert "inertia" in found[1]
    assert Muscle().limit(THETA, 1e-4, (0.0, 300.0), 10.0) is None
