"""The tables printed in Zhao et al. 2021, and what their own numbers say about their errors.

W. Zhao, Y. Zhang, N. Wang, *Development and Performance Analysis of Pneumatic Soft-Bodied Bionic
Actuator*, Appl. Bionics Biomech. 2021, 6623059, doi 10.1155/2021/6623059.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from softid.models.polynomial import evaluate

PRESSURE_KPA: tuple[float, ...] = (10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0)
"""Pressures of Table 2; the tests of §5 cover the same range."""

FINITE_ELEMENT_ANGLE_RAD: tuple[float, ...] = (0.37, 0.75, 1.17, 1.64, 2.23, 2.57, 2.76, 2.88)
"""Table 2: bending angle of the middle part by numerical simulation."""

ANGLE_COEFFICIENTS: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {
        "middle": (6.25e-8, -2.02e-5, 1.64e-3, -3.94e-3, 2.57e-1),
        "side": (2.28e-7, -3.99e-5, 1.95e-3, 1.27e-3, 1.58e-1),
    }
)
"""Table 4: p1 to p5 of Eq 23 for the measured angle in rad over x in kPa, by chamber."""

TORQUE_COEFFICIENTS: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {
        "middle": (9.36e-6, -2.99e-3, 2.43e-1, -7.80e-1, 38.29),
        "side": (3.26e-5, -5.72e-3, 2.79e-1, -2.02e-1, 22.7),
    }
)
"""Table 5: p1 to p5 for the driving torque, by chamber.

The paper does not print the unit of torque. N·mm is this project's ASSUMPTION.
"""

PRINTED_MAX_ERROR_RAD = 0.23
PRINTED_MAX_ERROR_PERCENT = 7.99
"""Largest errors that the paper states (§5.1.2): 7.99 % is 0.23 rad over the endpoint, 2.88 rad."""


@dataclass(frozen=True)
class FiniteElementRow:
    """One pressure of the comparison of test and finite elements.

    Attributes
    ----------
    pressure_kpa
        Pressure.
    finite_element_rad
        Table 2.
    measured_rad
        The polynomial of the measured angle.
    error_rad
        finite element − measured.
    error_percent
        100·|error|/finite element.
    """

    pressure_kpa: float
    finite_element_rad: float
    measured_rad: float
    error_rad: float
    error_percent: float


def compare_with_finite_element(
    coefficients: tuple[float, ...] = ANGLE_COEFFICIENTS["middle"],
) -> tuple[FiniteElementRow, ...]:
    """Compare an angle polynomial with the finite-element angles of Table 2.

    With the printed coefficients the largest error is 0.2246 rad at 80 kPa, as the paper says
    (0.23 rad), but the largest relative error is 9.16 % at 50 kPa and 8.99 % at 20 kPa: the paper's
    7.99 % is 0.23 rad over the angle at the endpoint.

    Parameters
    ----------
    coefficients
        p1, … highest power first, in rad over kPa; Table 4, middle, by default.

    Returns
    -------
    tuple of FiniteElementRow
        One row per pressure of Table 2.

    Source: Zhao et al. 2021, Tables 2 and 4, Fig 15.

    Examples
    --------
    >>> rows = compare_with_finite_element()
    >>> worst = max(rows, key=lambda row: row.error_percent)
    >>> worst.pressure_kpa, round(worst.error_percent, 2)
    (50.0, 9.16)
    """
    rows = []
    for pressure, simulated in zip(PRESSURE_KPA, FINITE_ELEMENT_ANGLE_RAD, strict=True):
        measured = float(evaluate(coefficients, pressure))
        error = simulated - measured
        rows.append(
            FiniteElementRow(pressure, simulated, measured, error, 100.0 * abs(error) / simulated)
        )
    return tuple(rows)
