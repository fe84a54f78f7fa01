"""What a fit of the equilibrium model can and cannot say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.models.actuator_geometry import Actuator

Array = npt.NDArray[np.float64]

COMPENSATION = ("a", "b", "c")
SEPARATED = ("C_d", *COMPENSATION)
CONDITION_LIMIT = 100.0
"""Largest condition number of the Jacobian with relative parameters that is not remarked on. One
step of 0.7 rad has 166, one of half that 537, and a large one with a small one 65: then a and b are
known to a hundredth."""

STIFFNESS_FACTOR = 2.0
"""A stiffness scale further from 1 than this says more about the geometry than about the rubber."""

_SCALES = (
    "chamber_width_m",
    "chamber_height_m",
    "rubber_density_kg_m3",
    "layer_density_kg_m3",
)
"""Values that set the scale of the driving torque and of the mass."""


def relative_condition(
    values: Mapping[str, float], known: Sequence[str], covariance: Array | None
) -> float | None:
    """Condition number of the Jacobian by C_d, a, b and c, each relative to its value.

    It is √cond of the relative covariance; a value smaller than its standard error counts as one
    standard error. None where one of the four has no standard error.
    """
    if covariance is None or not set(SEPARATED) <= set(known):
        return None
    rows = [known.index(name) for name in SEPARATED]
    part = covariance[np.ix_(rows, rows)]
    sizes = np.maximum(np.abs([values[name] for name in SEPARATED]), np.sqrt(np.diag(part)))
    return float(np.sqrt(np.linalg.cond(part / np.outer(sizes, sizes))))


def assumed_geometry(actuator: Actuator) -> tuple[Issue, ...]:
    """That values of an actuator are softid's assumptions; nothing where none is."""
    assumed = actuator.assumed_names
    if not assumed:
        return ()
    told = ", ".join(f"{name} = {getattr(actuator, name):g}" for name in assumed)
    return (
        Issue(
            "assumed-geometry",
            "info",
            f"assumed, neither measured nor printed in the paper: {told}",
            "measure them and give them with --geometry",
        ),
    )


def cautions_of(
    actuator: Actuator,
    values: Mapping[str, float],
    known: Sequence[str],
    covariance: Array | None,
) -> tuple[Issue, ...]:
    """Issues that hold for any fit of an actuator whose values are partly assumed.

    Parameters
    ----------
    actuator
        Geometry and material.
    values
        Parameter name → fitted value.
    known, covariance
        Names of the free parameters with standard errors, and their covariance.
    """
    found = []
    condition = relative_condition(values, known, covariance)
    if condition is not None and condition > CONDITION_LIMIT:
        found.append(
            Issue(
                "compensation-not-separated",
                "warning",
                "these logs hardly separate C_d, a, b and c (condition number "
                f"{condition:.0f}): take C_m(θ) as known over the angles that were reached, "
                "rather than its three numbers",
                "fit a larger and a smaller step together with these",
            )
        )
    stiffness = values.get("stiffness", 1.0)
    if "stiffness" in known and not 1.0 / STIFFNESS_FACTOR <= stiffness <= STIFFNESS_FACTOR:
        found.append(
            Issue(
                "geometry-does-not-match",
                "warning",
                f"the static angles ask for {stiffness:.3g} times the stiffness that the geometry "
                "and the material give, so one of their values is probably wrong",
                "check the dimensions and their units, and C10",
            )
        )
    found += assumed_geometry(actuator)
    assumed = actuator.assumed_names
    ratios = [name for name in ("C_d", *COMPENSATION, "stiffness") if name in known]
    if ratios:
        guessed = any(name in assumed for name in _SCALES)
        found.append(
            Issue(
                "ratios-only",
                "warning" if guessed else "info",
                f"{', '.join(ratios)} are ratios to the torque and the mass that the geometry "
                "gives: multiplying all torques by one number changes nothing in the motion, and "
                "neither does a lighter rubber with a larger C_m",
                "weigh the actuator, and measure B and h0",
            )
        )
    return tuple(found)
