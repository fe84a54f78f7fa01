"""Last stage of Ru's protocol: the damping N(p) fitted to force balance over velocity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.channels import read_only
from softid.errors import IdentificationError, Issue
from softid.kernels.muscle import KPA_PER_BAR
from softid.uncertainty import ResidualBlock, sandwich_covariance

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
Damping = Literal["exponential", "constant"]

MIN_SAMPLES = 10
"""Fast samples that a fit needs: about three for each of a2, b2 and c2, a judgement."""

STRONGLY_CORRELATED = 0.95
"""Correlation of a2 and b2 beyond which only the curve is told: not knowing the one then makes the
standard error of the other 1/√(1 − 0.95²) = 3.2 times what it would be."""

TRIED_STEEPNESS = np.linspace(-12.0, 12.0, 97)
"""b2 times the range of the pressure, tried at the start; the limits bound the estimate."""

_GOLDEN_STEPS = 60
"""Each leaves 0.618 of the bracket: 60 leave 3e-13 of it, which is rounding."""


@dataclass(frozen=True, eq=False)
class DampingSamples:
    """What is left for damping along one or more stretches.

    Attributes
    ----------
    pressure_kpa
        Pressure, shape (n,).
    force
        P − Q·x − M·ẍ, shape (n,).
    velocity
        ẋ, shape (n,).
    lengths
        Samples of each stretch; they add up to n.
    """

    pressure_kpa: Array
    force: Array
    velocity: Array
    lengths: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class DampingFit:
    """N(p) = a2·exp(b2·p) + c2, p in bar, or N = c2.

    Attributes
    ----------
    damping
        ``"exponential"`` or ``"constant"``.
    a2, b2, c2
        The parameters; a2 = b2 = 0 for constant damping.
    stderr
        Parameter → standard error that allows for the memory of the residual; None where a
        parameter rests on its bound or is not determined. The errors of the stages before are not
        in it.
    correlation
        Of the estimates of a2 and b2; None for constant damping.
    pressure_kpa, samples, velocity
        p, N = force/ẋ and ẋ of the samples fitted, each of shape (m,).
    rmse
        Root mean square error of the force balance.
    unit
        Unit of x; N is in s per unit.
    issues
        What the user should know.
    """

    damping: Damping
    a2: float
    b2: float
    c2: float
    stderr: Mapping[str, float | None]
    correlation: float | None
    pressure_kpa: Array
    samples: Array
    velocity: Array
    rmse: float
    unit: str
    issues: tuple[Issue, ...] = ()

    def curve(self, pressure_kpa: npt.ArrayLike) -> Array:
        """N at pressures of any shape, in s per unit of x."""
        p = np.asarray(pressure_kpa, dtype=np.float64) / KPA_PER_BAR
        value: Array = self.a2 * np.exp(self.b2 * p) + self.c2
        return value


def fit_damping(
    samples: DampingSamples,
    damping: Damping,
    *,
    min_speed_share: float,
    where: str,
    unit: str,
) -> DampingFit:
    """Minimise Σ (force − N(p)·ẋ)² over the fast samples, with a2, c2 ≥ 0.

    Raises
    ------
    IdentificationError
        Too few samples move, or the damping they show is not positive.
    """
    speed = np.abs(samples.velocity)
    fast = speed > min_speed_share * speed.max()
    if fast.sum() < MIN_SAMPLES:
        raise IdentificationError(
            f"only {int(fast.sum())} samples move fast enough to show damping",
            where=where,
            remedy="use a livelier log or a smaller share of the top speed",
        )
    p = samples.pressure_kpa[fast] / KPA_PER_BAR
    force, velocity = samples.force[fast], samples.velocity[fast]
    if damping == "constant":
        values = np.array([0.0, 0.0, _constant(force, velocity)[0]])
    else:
        values = _exponential(p, force, velocity)
    if values[0] <= 0.0 and values[2] <= 0.0:
        raise IdentificationError(
            "the motion shows no positive damping",
            where=where,
            value=float(velocity @ force / (velocity @ velocity)),
            remedy="check the static curve and the inertia, or fit all logs together",
        )
    a2, b2, c2 = values.tolist()
    residual = force - (a2 * np.exp(b2 * p) + c2) * velocity
    stderr, correlation = _errors(values, samples, fast, residual, damping)
    return DampingFit(
        damping=damping,
        a2=a2,
        b2=b2,
        c2=c2,
        stderr=stderr,
        correlation=correlation,
        pressure_kpa=read_only(samples.pressure_kpa[fast]),
        samples=read_only(force / velocity),
        velocity=read_only(velocity),
        rmse=float(np.sqrt(np.mean(residual**2))),
        unit=unit,
        issues=_issues(values, correlation, damping),
    )


def _constant(force: Array, velocity: Array) -> tuple[float, float]:
    """c2 ≥ 0 and its sum of squares."""
    c2 = max(float(velocity @ force) / float(velocity @ velocity), 0.0)
    return c2, float(np.sum((force - c2 * velocity) ** 2))


def _exponential(p: Array, force: Array, velocity: Array) -> Array:
    """Best (a2, b2, c2): a grid and a golden section over b2, the other two linear in between."""
    span = float(np.ptp(p))
    if span == 0.0:
        return np.array([0.0, 0.0, _constant(force, velocity)[0]])
    grid = TRIED_STEEPNESS[TRIED_STEEPNESS != 0.0] / span
    costs = [_given_b2(b2, p, force, velocity)[1] for b2 in grid]
    best = int(np.argmin(costs))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
    ratio = (np.sqrt(5.0) - 1.0) / 2.0
    for _ in range(_GOLDEN_STEPS):
        left, right = high - ratio * (high - low), low + ratio * (high - low)
        if _given_b2(left, p, force, velocity)[1] <= _given_b2(right, p, force, velocity)[1]:
            high = right
        else:
            low = left
    return _given_b2(0.5 * (low + high), p, force, velocity)[0]


def _given_b2(b2: float, p: Array, force: Array, velocity: Array) -> tuple[Array, float]:
    """Non-negative a2 and c2 at a given b2, and the sum of squares."""
    # Written from the pressure where the exponential is largest, so that nothing overflows.
    anchor = float(p.max()) if b2 > 0 else float(p.min())
    columns = np.column_stack([np.exp(b2 * (p - anchor)), np.ones(p.size)]) * velocity[:, None]
    solved = np.linalg.lstsq(columns, force, rcond=None)[0]
    if solved.min() < 0.0:
        alone = np.maximum(columns.T @ force / np.sum(columns**2, axis=0), 0.0)
        kept = int(np.argmax(alone**2 * np.sum(columns**2, axis=0)))
        solved = np.where(np.arange(2) == kept, alone, 0.0)
    cost = float(np.sum((force - columns @ solved) ** 2))
    return np.array([solved[0] * np.exp(-b2 * anchor), b2, solved[1]]), cost


def _errors(
    values: Array, samples: DampingSamples, fast: BoolArray, residual: Array, damping: Damping
) -> tuple[dict[str, float | None], float | None]:
    a2, b2, _ = values
    p = samples.pressure_kpa / KPA_PER_BAR
    by = {
        "a2": np.exp(b2 * p) * samples.velocity,
        "b2": a2 * p * np.exp(b2 * p) * samples.velocity,
        "c2": samples.velocity,
    }
    free = ["c2"] if damping == "constant" or a2 <= 0.0 else ["a2", "b2", "c2"]
    if values[2] <= 0.0:
        free.remove("c2")
    whole = np.full(p.size, np.nan)
    whole[fast] = residual
    cuts = np.cumsum(samples.lengths)[:-1]
    block = ResidualBlock(
        "force balance",
        tuple(np.split(np.column_stack([by[name] for name in free]), cuts)),
        tuple(np.split(whole, cuts)),
    )
    found = sandwich_covariance([block], free)
    stderr: dict[str, float | None] = dict.fromkeys(by)
    stderr.update(zip(free, found.sd, strict=True))
    if "a2" not in free:
        return stderr, None
    spread = np.sqrt(found.matrix[0, 0] * found.matrix[1, 1])
    known = bool(np.isfinite(spread)) and spread > 0.0
    return stderr, float(found.matrix[0, 1] / spread) if known else None


def _issues(values: Array, correlation: float | None, damping: Damping) -> tuple[Issue, ...]:
    found = []
    if damping == "exponential" and values[0] <= 0.0:
        found.append(
            Issue(
                "damping-constant",
                "info",
                "the damping does not change with pressure: a2 is zero",
                "use constant damping",
            )
        )
    if correlation is not None and abs(correlation) > STRONGLY_CORRELATED:
        found.append(
            Issue(
                "a2-b2-inseparable",
                "warning",
                f"a2 and b2 correlate by {correlation:.2f}: only the curve N(p) is known",
                "quote N over the range of the log, or use constant damping",
            )
        )
    return tuple(found)
