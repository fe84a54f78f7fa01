"""How near a diagnosis comes to the truth of what was hidden."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from softid.diagnosis_results import Cause, Diagnosis
from softid.results import FitResult
from softid.synthesis.hidden_log import HiddenPair

FROM_TRUTH = 0.2
"""A parameter counts as recovered within its interval or a fifth of the truth."""

FEWEST_KNOTS = 4
"""Fewest parameters that are taken for the knots of a curve."""


def all_recovered(found: Diagnosis, pair: HiddenPair) -> bool | None:
    """Whether all causes of a diagnosis that were hidden have the parameters that were hidden.

    Parameters
    ----------
    found
        The diagnosis.
    pair
        The logs with their truth.

    Returns
    -------
    bool | None
        None where no cause has a true value.
    """
    if found.extended is None:
        return None
    judged = [
        is_recovered(cause, true_values(cause, pair, found.extended)) for cause in found.causes
    ]
    known = [each for each in judged if each is not None]
    return all(known) if known else None


def is_recovered(cause: Cause, truth: Mapping[str, float]) -> bool | None:
    """Whether every parameter with a true value lies in its interval or within a fifth of it.

    Knots of a curve are judged by its shape: its first is zero, and its slope is as well one of the
    base.

    Parameters
    ----------
    cause
        A cause that was named.
    truth
        Parameter → true value, without the name of the effect.

    Returns
    -------
    bool | None
        None where nothing has a true value.
    """
    known = [
        (estimate, truth[name])
        for estimate in cause.parameters
        if (name := estimate.name.removeprefix(f"{cause.effect}_")) in truth
    ]
    if not known:
        return None
    if len(known) >= FEWEST_KNOTS:
        found, true = _bend([e.value for e, _ in known]), _bend([t for _, t in known])
        return bool(np.linalg.norm(found - true) <= FROM_TRUTH * np.linalg.norm(true))
    return all(
        (estimate.ci95 is not None and estimate.ci95[0] <= true <= estimate.ci95[1])
        or abs(estimate.value - true) <= FROM_TRUTH * abs(true)
        for estimate, true in known
    )


def true_values(cause: Cause, pair: HiddenPair, extended: FitResult) -> Mapping[str, float]:
    """What was hidden of a cause, whatever its form; nothing where it was not.

    A power of the speed is written with the largest speed, v_m, of which the fit has its own: the
    same law has d2 v_m^(2 − n) in common. So is a lag that differs by level with the range of the
    pressure: ln τ is the same linear function of the pressure.

    Parameters
    ----------
    cause
        The cause.
    pair
        The logs with their truth.
    extended
        The fit that names it.
    """
    hidden = pair.hidden
    key = next((key for key in hidden if key.split(".")[0] == cause.effect), None)
    if key is None:
        return {}
    values = dict(hidden[key])
    sizes, scale = pair.sizes, extended.model.scale
    if key == "quadratic_damping.power":
        ratio = sizes.v_max / float(scale["v_max"])
        values["d2"] *= ratio ** (2.0 - values["n"])
    if key == "pneumatic_lag.level":
        per_kpa = np.log(values["ratio"]) / sizes.p_span
        low, high = float(scale["u_low"]), float(scale["u_high"])
        moved_kpa = 0.5 * (low + high) - 0.5 * (sizes.p_low + sizes.p_high)
        values["tau"] *= float(np.exp(per_kpa * moved_kpa))
        values["ratio"] = float(np.exp(per_kpa * (high - low)))
    return values


def _bend(knots: Sequence[float]) -> npt.NDArray[np.float64]:
    """What a straight line leaves of equidistant knots behind one that is zero."""
    heights = np.array([0.0, *knots])
    places = np.arange(float(heights.size))
    return heights - np.polyval(np.polyfit(places, heights, 1), places)
