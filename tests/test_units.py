"""Units: factors against their definitions (SI brochure; 1 psi = 6.894757293168361 kPa)."""

from __future__ import annotations

import math
import subprocess
import sys

import pytest

from softid.errors import InputError
from softid.units import (
    CANONICAL_UNIT,
    CHANNEL_QUANTITY,
    factor_to_canonical,
    lookup_unit,
    parse_unit,
    split_scale,
    unit_symbol,
)


@pytest.mark.parametrize(
    ("text", "quantity", "factor"),
    [
        ("kPa", "pressure", 1.0),
        ("bar", "pressure", 100.0),
        ("Pa", "pressure", 1e-3),
        ("MPa", "pressure", 1e3),
        ("mPa", "pressure", 1e-6),
        ("psi", "pressure", 0.45359237 * 9.80665 / 0.0254**2 / 1000),
        ("mmHg", "pressure", 0.133322387415),
        ("deg", "angle", math.pi / 180),
        ("°", "angle", math.pi / 180),
        ("rad", "angle", 1.0),
        ("ms", "time", 1e-3),
        ("μs", "time", 1e-6),  # Greek mu
        ("µs", "time", 1e-6),  # micro sign
        ("m", "length", 1000.0),
        ("in", "length", 25.4),
        ("N m", "torque", 1000.0),
        ("N·mm", "torque", 1.0),
        ("kN", "force", 1000.0),
    ],
)
def test_factors_are_the_definitions(text: str, quantity: str, factor: float) -> None:
    """The table's factors to 1e-12."""
    unit = parse_unit(text)
    assert unit.quantity == quantity
    assert unit.factor == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "quantity", "factor"),
    [
        ("inHg", "pressure", 3.386388640341),  # pint's definition, conventional mercury
        ("kgf/cm^2", "pressure", 98.0665),
        ("turn", "angle", 2 * math.pi),
        ("lbf", "force", 0.45359237 * 9.80665),
        ("lbf*in", "torque", 0.45359237 * 9.80665 * 25.4),
    ],
)
def test_unusual_units_go_to_pint(text: str, quantity: str, factor: float) -> None:
    assert lookup_unit(text) is None
    unit = parse_unit(text)
    assert (unit.quantity, unit.factor) == (quantity, pytest.approx(factor, rel=1e-9))


@pytest.mark.parametrize("text", ["foo", "%", "percent", "V", "degC", "", "1", "kPa]", "decibel"])
def test_what_is_no_unit_of_ours_is_refused(text: str) -> None:
    """A percentage is dimensionless, as an angle is, and must not pass for one."""
    with pytest.raises(InputError, match="not a unit") as caught:
        parse_unit(text, where="log.csv, column x")
    assert caught.value.where == "log.csv, column x"


@pytest.mark.parametrize("text", ["%", "1", "mm/mm"])
def test_who_has_a_strain_is_told_what_to_do(text: str) -> None:
    """A McKibben muscle is often logged by its relative contraction."""
    with pytest.raises(InputError) as caught:
        parse_unit(text)
    assert caught.value.remedy is not None
    assert "--channel contraction=COLUMN:mm" in caught.value.remedy


@pytest.mark.parametrize("text", ["9**9**9**9", "m^9^9^9", "m**99999999", "(" * 5000, "a" * 10**6])
def test_no_text_keeps_pint_busy(text: str) -> None:
    """Units come from headers, so a hostile one may not be evaluated as arithmetic."""
    with pytest.raises(InputError):
        parse_unit(text)


def test_a_unit_of_another_quantity_is_refused() -> None:
    with pytest.raises(InputError, match="deg is a unit of angle") as caught:
        factor_to_canonical("deg", "pressure")
    assert "kPa" in str(caught.value)


def test_every_known_channel_has_a_canonical_unit_of_factor_one() -> None:
    for quantity in CHANNEL_QUANTITY.values():
        assert factor_to_canonical(CANONICAL_UNIT[quantity], quantity) == 1.0


@pytest.mark.parametrize(
    ("text", "symbol"),
    [("kpa", "kPa"), ("PSI", "psi"), ("degrees", "deg"), ("nmm", "N·mm"), ("V", "V"), ("MN", "MN")],
)
def test_symbols_are_the_usual_ones_and_mean_the_same(text: str, symbol: str) -> None:
    assert unit_symbol(text) == symbol
    if lookup_unit(text):
        assert parse_unit(symbol).factor == parse_unit(text).factor


@pytest.mark.parametrize(
    ("text", "scale", "unit"),
    [
        ("kPa", 1.0, "kPa"),
        ("35.15*N", 35.15, "N"),
        ("1e-3 kPa", 1e-3, "kPa"),
        ("-2·mm", -2.0, "mm"),
        (".5V", 0.5, "V"),
        ("\N{MINUS SIGN}2*mm", -2.0, "mm"),
        ("\N{MINUS SIGN}deg", -1.0, "deg"),
    ],
)
def test_a_number_before_a_unit_is_its_scale(text: str, scale: float, unit: str) -> None:
    assert split_scale(text) == (scale, unit)


def test_the_frequent_units_need_no_pint() -> None:
    """Importing pint costs 0.2 s, which a fit of one CSV must not pay."""
    code = (
        "import sys; from softid.units import parse_unit; "
        "[parse_unit(u) for u in ('bar', 'psi', 'deg', 'ms', 'N mm')]; "
        "sys.exit('pint' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    ("text", "factor"),
    [
        ("deg.", math.pi / 180),
        ("rev", 2 * math.pi),
        ("gon", math.pi / 200),
        ("psia", 6.894757293168361),
        ("MPA", 1000.0),
        ("N/mm2", 1000.0),
        ("N/m2", 0.001),
        ("N/mm²", 1000.0),
        ("kgf/cm2", 98.0665),
        ("h", 3600.0),
    ],
)
def test_spellings_of_data_sheets(text: str, factor: float) -> None:
    """By definition: 1 N/mm² = 1 MPa, 1 kgf = 9.80665 N, a turn is 2π or 400 gon."""
    assert parse_unit(text).factor == pytest.approx(factor, rel=1e-12)


def test_grad_is_no_giga_radian() -> None:
    """Degree in German, gon elsewhere: refused with both named."""
    with pytest.raises(InputError, match=r"deg or .*gon"):
        parse_unit("Grad")
