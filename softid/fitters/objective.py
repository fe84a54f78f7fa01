"""What an output-error fit minimises: weighted squares of the residual, with a weak prior."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.fitters.affine_fit import AffineArrays, run
from softid.fitters.levenberg_marquardt import Minimum, Normal, minimise
from softid.fitters.normal_equations import Linearised, bend, linearise, summed
from softid.fitters.problem import Problem
from softid.kernels.affine_descent import NEEDS_COLUMNS, SINGULAR
from softid.kernels.rules import BEND_STEP
from softid.models.division import Division

Array = npt.NDArray[np.float64]

SCOUT_EVALUATIONS = 30
TOLERANCE = 1e-3
MAX_PLANS = 6
PRIOR_REACHES = 4.0
"""Standard deviation of the prior in units of each unknown's plausible move: a factor of e⁸ = 3000
for a parameter on a logarithmic scale."""

KEPT_ENTRIES = 8_000_000
"""Largest Jacobian that is kept whole for the acceleration (64 MB); a larger one is only summed."""


CHEAP_ENTRIES = 50_000
"""Largest Jacobian that is kept from the begin of a compiled run: it stays in the cache."""


@dataclass(frozen=True, eq=False)
class Prior:
    """A weak normal prior on the free parameters, ½Σ w (z − centre)².

    It holds a direction that the data cannot see near its start; a parameter that the data know to
    a relative standard error e moves by (e/8)² of its distance from the centre.

    Attributes
    ----------
    centre
        Unknowns at the start, shape (U,).
    weight
        s²/sd² of every unknown, zero for zeros and states, shape (U,); s² is the variance of the
        weighted residual.
    """

    centre: Array
    weight: Array

    def cost(self, z: Array) -> float:
        """The prior's part of the cost."""
        return float(0.5 * np.sum(self.weight * (z - self.centre) ** 2))


class Objective:
    """Weighted cost and normal equations, with the discretisation held still."""

    def __init__(self, problem: Problem, sigma: Mapping[str, float]) -> None:
        self.problem = problem
        self.sigma = dict(sigma)
        self.evaluations = 0
        self.plans: list[Division | None] | None = None
        self.prior: Prior | None = None
        self._last: Linearised | None = None
        self._weighted: dict[str, float] = {}
        self._planned: tuple[Array, list[Division | None]] | None = None

    def __call__(self, z: Array) -> Normal:
        """Cost ½Σ(r/σ)² and its normal equations at ``z`` with every zero moved to its optimum."""
        found = self._at(z)
        if self.prior is None or not np.isfinite(found.cost):
            return found
        return replace(
            found,
            cost=found.cost + self.prior.cost(found.point),
            gradient=found.gradient - self.prior.weight * (found.point - self.prior.centre),
            matrix=found.matrix + np.diag(self.prior.weight),
        )

    def _at(self, z: Array) -> Linearised:
        """The normal equations without the prior; the last ones are kept, to begin a run with."""
        if self._last is not None and self._knows(z):
            return self._last
        self.evaluations += 1
        keep = self.problem.n_samples * self.problem.size <= KEPT_ENTRIES
        found = linearise(self.problem, z, self.sigma, plans=self.plans, keep=keep)
        self._last, self._weighted = found, dict(self.sigma)
        return found

    def _knows(self, z: Array) -> bool:
        """Whether the last evaluation was this one."""
        last = self._last
        return (
            last is not None
            and self.plans is not None
            and last.plans is not None
            and bool(np.array_equal(z, last.point))
            and self.sigma == self._weighted
            and _same(self.plans, last.plans)
        )

    def adopt(self, other: Objective) -> None:
        """Go on from another one's last evaluation, of the same problem."""
        if other.problem is self.problem:
            self._last, self._weighted = other._last, other._weighted
            self._planned = other._planned

    def _plans(self, z: Array) -> list[Division | None]:
        if self._planned is None or not np.array_equal(z, self._planned[0]):
            self._planned = z.copy(), self.problem.plans(z)
        return self._planned[1]

    def set_prior(self, centre: Array, at: Minimum) -> None:
        """Hold unseen directions near ``centre``, with the residual variance found at ``at``."""
        variance = 2.0 * at.normal.cost / max(at.normal.n - self.problem.size, 1)
        weight = variance / (PRIOR_REACHES * self.problem.reach()) ** 2
        weight[len(self.problem.free) :] = 0.0
        self.prior = Prior(centre, weight)

    def bend(self, z: Array, step: Array, normal: Normal) -> Array | None:
        """Jᵀ∂²ŷ/∂v² along ``step``, or None where the Jacobian was too large to keep."""
        if not isinstance(normal, Linearised) or not normal.kept:
            return None
        self.evaluations += 1
        return bend(self.problem, normal, z, step, self.sigma, plans=self.plans, fraction=BEND_STEP)

    def solve(
        self,
        start: Array,
        evaluations: int,
        *,
        tolerance: float = TOLERANCE,
        columns: bool = True,
        bends: bool = True,
    ) -> Minimum:
        """Minimise from a start, planning the substeps anew until the plan stays.

        Parameters
        ----------
        start
            Unknowns, shape (U,).
        evaluations
            Limit of evaluations of each run.
        tolerance
            As in `minimise`.
        columns
            Whether the columns at every sample may be asked for at the end.
        bends
            Whether long steps follow their bend.
        """
        lower, upper = self.problem.bounds()
        limits = lower, upper, self.problem.reach()
        point = np.clip(start, lower, upper)
        short = evaluations <= SCOUT_EVALUATIONS
        near = False
        for _ in range(MAX_PLANS):
            plans = self._plans(point)
            if self.plans is not None and _same(plans, self.plans):
                break
            self.plans = plans
            keep = near and columns and not short
            found = self._run(point, limits, evaluations, tolerance, keep=keep, bends=bends)
            point, near = found.point, True
            if short:
                break
        if columns and not short and self._lacks_columns(found):
            kept = self._run(point, limits, 1, tolerance, keep=True).normal
            found = replace(found, normal=replace(kept, point=point))  # zeros move by rounding
            if self._last is not None:
                self._last = replace(self._last, point=point)
        self.plans = None
        return found

    def _lacks_columns(self, found: Minimum) -> bool:
        """Whether columns could have been kept at an end, but were not."""
        normal = found.normal
        small = self._entries <= KEPT_ENTRIES and bool(np.isfinite(normal.cost))
        return small and isinstance(normal, Linearised) and not normal.kept

    @property
    def _entries(self) -> int:
        return self.problem.n_samples * self.problem.size

    def _run(
        self,
        start: Array,
        limits: tuple[Array, Array, Array],
        evaluations: int,
        tolerance: float,
        *,
        keep: bool,
        bends: bool = True,
    ) -> Minimum:
        """Minimise with the steps held still, compiled where the law is affine in its state."""
        arrays = self.problem.arrays if type(self) is Objective else None
        known = self._last if self._knows(start) else None
        fresh = known is None or (keep and not known.kept)
        damping, used = None, 0
        if arrays is not None and fresh and self.plans is not None and None not in self.plans:
            ended, unsolved = self._descend(
                arrays, start, limits, evaluations, tolerance, keep=keep, bends=bends
            )
            if not unsolved and not np.isnan(ended.reach):
                return ended
            start, damping, used = ended.point, ended.damping, ended.evaluations
        return minimise(
            self,
            start,
            *limits,
            evaluations=evaluations - used,
            tolerance=tolerance,
            bend=self.bend if bends else None,
            damping=damping,
        )

    def _descend(
        self,
        arrays: AffineArrays,
        start: Array,
        limits: tuple[Array, Array, Array],
        evaluations: int,
        tolerance: float,
        *,
        keep: bool,
        bends: bool,
    ) -> tuple[Minimum, bool]:
        """The compiled run, and whether it stopped at a system without a single solution.

        Columns are kept from the begin where that is cheap, else from the first long step on.
        """
        assert self.plans is not None
        prior = None if self.prior is None else (self.prior.centre, self.prior.weight)
        bends = bends and self._entries <= KEPT_ENTRIES
        keep = bends and (keep or self._entries <= CHEAP_ENTRIES)
        used, damping = 0, -1.0
        while True:
            found = run(
                arrays,
                start,
                self.plans,
                self.sigma,
                limits,
                prior,
                evaluations=evaluations - used,
                tolerance=tolerance,
                keep=keep,
                bends=bends,
                damping=damping,
            )
            used += found.used
            start, damping = found.point, found.damping
            if found.how != NEEDS_COLUMNS or used >= evaluations:
                break
            keep = True
        self.evaluations += used
        self._last = summed(
            self.problem, found, self.sigma, self.plans, has_prior=prior is not None
        )
        self._weighted = dict(self.sigma)
        normal = self(found.point)
        unsolved = found.how == SINGULAR
        return Minimum(found.point, normal, used, found.offset, damping), unsolved


def _same(a: Sequence[Division | None], b: Sequence[Division | None]) -> bool:
    return all(
        p is q or (p is not None and q is not None and p.same_as(q))
        for p, q in zip(a, b, strict=True)
    )
