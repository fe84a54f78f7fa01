"""Which parameters the logs determine, and what stands in the way of the others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.parameters import ParameterScale
from softid.results import ParameterVerdict
from softid.sentences import listed
from softid.uncertainty.covariance import Covariance

Array = npt.NDArray[np.float64]

IDENTIFIED_BELOW = 0.2
"""Relative standard deviation below which a parameter is identified: its 95 % interval spans a
factor of about two at the most."""

WEAK_BELOW = 1.0
"""Relative standard deviation below which it is weakly identified: its size is roughly known."""

STRONG_CORRELATION = 0.95
"""Correlation of two parameters beyond which the partner is named: given the partner, the standard
deviation would be less than a third."""


def condition_number(jacobian: Array) -> float:
    """Condition number of a Jacobian whose columns are scaled to unit length.

    Parameters
    ----------
    jacobian
        Derivatives of the residuals, shape (n, K).

    Returns
    -------
    float
        Infinite when a column is zero or the columns are dependent.

    Examples
    --------
    >>> condition_number(np.array([[1.0, 0.0], [0.0, 1000.0]]))
    1.0
    """
    norm = np.linalg.norm(jacobian, axis=0)
    if np.any(norm == 0.0) or jacobian.shape[0] < jacobian.shape[1]:
        return float("inf")
    singular = np.linalg.svd(jacobian / norm, compute_uv=False)
    floor = np.finfo(float).eps * singular[0]
    return float(singular[0] / singular[-1]) if singular[-1] > floor else float("inf")


def strongest_partner(covariance: Covariance, name: str) -> tuple[str, float] | None:
    """The estimate that is most correlated with one of them.

    Parameters
    ----------
    covariance
        From `sandwich_covariance`.
    name
        The parameter asked about.

    Returns
    -------
    tuple of str and float, or None
        Name and correlation; None where nothing is determined besides.
    """
    index = covariance.names.index(name)
    variance = np.diag(covariance.matrix)
    there = np.flatnonzero(variance > 0.0)  # never so for NaN
    there = there[there != index]
    if not variance[index] > 0.0 or not there.size:
        return None
    row = covariance.matrix[index, there] / np.sqrt(variance[index] * variance[there])
    strongest = int(np.argmax(np.abs(row)))
    value = min(max(float(row[strongest]), -1.0), 1.0)
    return covariance.names[there[strongest]], value


def companions(covariance: Covariance, name: str) -> tuple[str, ...]:
    """Other parameters in the undetermined directions that a parameter takes part in."""
    groups = [group for group in covariance.undetermined if name in group]
    return tuple(dict.fromkeys(n for group in groups for n in group if n != name))


def relative_sd(
    value: float,
    scale: ParameterScale,
    sd: float,
    *,
    lower: float | None = None,
    upper: float | None = None,
) -> float:
    """Standard deviation that a verdict is based on.

    On a logarithmic scale it is the standard deviation of log v. On a linear scale it is the
    smaller of sd/|v| and, where the search is bounded on both sides, sd/(upper − lower), since a
    parameter near zero may be well known without a relative error.

    Parameters
    ----------
    value, scale
        Estimate in its own unit and the scale of its search.
    sd
        In the internal coordinate.
    lower, upper
        Bounds of the search; None or infinite when there are none.

    Examples
    --------
    >>> relative_sd(0.1, "linear", 1.0, lower=-50.0, upper=50.0)
    0.01
    """
    if scale == "log":
        return sd
    spans = [abs(value)]
    if lower is not None and upper is not None and np.isfinite(upper - lower):
        spans.append(upper - lower)
    span = max(spans)
    if span > 0.0:
        return sd / span
    return float("inf") if sd > 0.0 else 0.0


def judge(
    value: float,
    scale: ParameterScale,
    sd: float | None,
    *,
    at_bound: bool = False,
    partner: tuple[str, float] | None = None,
    lower: float | None = None,
    upper: float | None = None,
    companions: Sequence[str] = (),
) -> tuple[ParameterVerdict, str]:
    """Say whether a parameter is identified, and why not.

    Identified when the relative standard deviation (`relative_sd`) is below 0.2, weakly identified
    below 1, otherwise not identified; not identified either when it rests on a bound, where the
    logs give only a limit, or when no standard deviation exists.

    Parameters
    ----------
    value, scale, sd
        Estimate, scale of its search, and standard deviation in the internal coordinate or None.
    at_bound
        Whether the optimum rests on a bound.
    partner
        The most correlated other parameter and the correlation, named when beyond 0.95.
    lower, upper
        Bounds of the search; None or infinite when there are none.
    companions
        Parameters that can make up for this one exactly, when there is no standard deviation.

    Returns
    -------
    verdict, reason
        The reason has no full stop, and is empty for an identified parameter.

    Examples
    --------
    >>> judge(2.0, "log", 0.5)
    ('weakly identified', 'its standard error is 50 % of it')
    """
    if at_bound:
        bound = _which_bound(value, lower, upper)
        return "not identified", f"it rests on {bound}, so only a limit is known"
    if sd is None or not np.isfinite(sd):
        if companions:
            return (
                "not identified",
                f"{listed(dict.fromkeys(companions))} can make up for it exactly",
            )
        return "not identified", "it does not change the response"
    size = relative_sd(value, scale, sd, lower=lower, upper=upper)
    if size < IDENTIFIED_BELOW:
        return "identified", ""
    why = ""
    if partner is not None and abs(partner[1]) > STRONG_CORRELATION:
        why = f", since {partner[0]} can make up for it (correlation {partner[1]:.2f})"
    is_of_bounds = scale == "linear" and size < relative_sd(value, scale, sd)
    if size < WEAK_BELOW:
        of = "the distance between its bounds" if is_of_bounds else "it"
        return "weakly identified", f"its standard error is {100.0 * size:.0f} % of {of}{why}"
    if scale == "log":
        return "not identified", f"its order of magnitude is not known{why}"
    of = "the distance between its bounds" if is_of_bounds else "the value"
    return "not identified", f"its standard error is as large as {of}{why}"


def _which_bound(value: float, lower: float | None, upper: float | None) -> str:
    if lower is None or upper is None:
        return "a bound"
    name = "lower" if abs(value - lower) <= abs(upper - value) else "upper"
    return f"its {name} bound"
