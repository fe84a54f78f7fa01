"""What an output-error fit minimises: weighted squares of the residual, with a weak prior."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.fitters.levenberg_marquardt import (
    CURVATURE_STEP,
    Minimum,
    NormalEquations,
    minimise,
    next_point,
    offset_within,
)
from softid.fitters.normal_equations import (
    SUMMED_ENTRIES,
    Linearised,
    linearise,
    means_of,
    second_derivative,
)
from softid.fitters.problem import Problem
from softid.models.division import Division
from softid.models.products import ALL_COLUMNS, NO_COLUMNS, Keep

Array = npt.NDArray[np.float64]

SCOUT_EVALUATIONS = 30
"""Evaluations of a run that only has to tell good starts from bad ones; a judgement. A run of no
more is rough: it keeps the division of the steps with which it began."""

DRAFT_EVALUATIONS = 60
"""Evaluations of a draft, twice those of a scout: it is compared with other drafts, or begins next
to its optimum."""

RESTING_OFFSET = 1e-3
"""`attainable_offset` at which a run ends: a thousandth of a standard error. A fit asks for fifty
times as much, which leaves room for runs that rounding stops in between."""

MAX_PLANS = 6
"""Divisions of the steps that one run goes through at most. Each optimum may call for another one,
and two may call for each other by turns: then the last stays."""

LAST_STEP_OFFSET = 0.1
"""`attainable_offset` from which the next step of a run over many samples is taken for the last,
since near the optimum each leaves a hundredth of it or less: it ends under the division of the
steps that belongs there, and with the columns, which cost a half more, if they are to be kept."""

LAST_STEP = 1e-4
"""`attainable_offset` from which a last step is worth to be taken; below, it is rounding."""

PRIOR_REACHES = 4.0
"""Standard deviation of the prior in units of each unknown's plausible move: a factor of e⁸ = 3000
for a parameter on a logarithmic scale."""

CHEAP_ENTRIES = 50_000
"""Largest Jacobian that is kept at every evaluation: it stays in the processor's cache. Of a larger
one the columns are kept where they are asked for at the end."""

LONGEST_KEPT = 300_000
"""Samples up to which the last evaluation keeps its residuals and the means of its columns: they
save the errors an evaluation, and take the memory of the log and a third."""


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
        self._asked = np.empty(0)  # where the last was asked for, before its zeros moved
        self._weighted: dict[str, float] = {}
        self._accelerates = True
        self._planned: tuple[Array, list[Division | None]] | None = None

    def __call__(self, z: Array) -> NormalEquations:
        """Cost ½Σ(r/σ)² and its normal equations at ``z`` with every zero moved to its optimum."""
        return self._with_prior(self._at(z))

    def _with_prior(self, found: NormalEquations) -> NormalEquations:
        if self.prior is None or not np.isfinite(found.cost):
            return found
        return replace(
            found,
            cost=found.cost + self.prior.cost(found.point),
            gradient=found.gradient - self.prior.weight * (found.point - self.prior.centre),
            matrix=found.matrix + np.diag(self.prior.weight),
        )

    def _at(self, z: Array, *, columns: bool = False) -> Linearised:
        """The normal equations without the prior; the last ones are kept, to begin a run with.

        Columns are kept where that is cheap and a step may bend, and where they are asked for;
        where they would be too many, their means and the residuals; of the longest logs nothing.
        """
        keep = self._kept(columns=columns)
        last = self._last
        if (
            last is not None
            and self.plans is not None
            and last.plans is not None
            and z.tobytes() in (last.point.tobytes(), self._asked.tobytes())
            and self.sigma == self._weighted
            and _same(self.plans, last.plans)
            and (last.kept or keep != ALL_COLUMNS)
            and (last.has_residuals or not keep.residual)
        ):
            return last
        self.evaluations += 1
        found = linearise(self.problem, z, self.sigma, plans=self.plans, keep=keep)
        self._last, self._asked, self._weighted = found, z, dict(self.sigma)
        return found

    def _kept(self, *, columns: bool) -> Keep:
        if not (columns or self._accelerates):
            return NO_COLUMNS
        if self._entries <= (SUMMED_ENTRIES if columns else CHEAP_ENTRIES):
            return ALL_COLUMNS
        if columns and self.problem.n_samples <= LONGEST_KEPT:
            return means_of(self.problem, residual=True)
        return NO_COLUMNS

    @property
    def _entries(self) -> int:
        return self.problem.n_samples * self.problem.size

    def with_columns(self, found: Minimum) -> Minimum:
        """The end of a run with the columns at every sample, unless they are too many to keep.

        They take an evaluation, which also takes the last step that the normal equations promise.
        """
        normal = found.normal
        if not isinstance(normal, Linearised) or normal.kept or not np.isfinite(normal.cost):
            return found
        if self._entries > SUMMED_ENTRIES:
            return found
        self.plans = None if normal.plans is None else list(normal.plans)
        limits = *self.problem.bounds(), self.problem.reach()
        kept: NormalEquations | None = None
        if found.offset > LAST_STEP:
            kept = self._with_prior(self._at(next_point(found, *limits), columns=True))
        if kept is None or not kept.cost <= found.normal.cost:
            kept = self._with_prior(self._at(found.point, columns=True))
        self.plans = None
        return replace(found, point=kept.point, normal=kept, offset=offset_within(kept, *limits))

    def begin_with(self, known: NormalEquations) -> None:
        """Go on from where an earlier run ended, if that was one of the same problem.

        Parameters
        ----------
        known
            Its normal equations, under whatever weights and prior.
        """
        if isinstance(known, Linearised) and known.problem is self.problem:
            self._last, self._asked = known.weighted(self.sigma), known.point
            self._weighted = dict(self.sigma)

    def adopt(self, other: Objective) -> None:
        """Go on from another one's last evaluation, of the same problem."""
        if other.problem is self.problem:
            self._last, self._asked, self._weighted = other._last, other._asked, other._weighted
            self._planned = other._planned

    def _plans(self, z: Array) -> list[Division | None]:
        """Steps at ``z``; zeros and initial states, which follow the parameters, change none."""
        free = z[: len(self.problem.free)]
        if self._planned is None or free.tobytes() != self._planned[0].tobytes():
            self._planned = free.copy(), self.problem.plans(z)
        return self._planned[1]

    def set_prior(self, centre: Array, at: Minimum) -> None:
        """Hold unseen directions near ``centre``, with the residual variance found at ``at``."""
        variance = 2.0 * at.normal.cost / max(at.normal.n - self.problem.size, 1)
        weight = variance / (PRIOR_REACHES * self.problem.reach()) ** 2
        weight[len(self.problem.free) :] = 0.0
        self.prior = Prior(centre, weight)

    def second_derivative(self, z: Array, step: Array, normal: NormalEquations) -> Array | None:
        """Jᵀ∂²ŷ/∂v² along ``step``, or None where a Jacobian that no kernel sums was not kept."""
        if not isinstance(normal, Linearised) or not (normal.kept or normal.affine):
            return None
        self.evaluations += 1 if normal.kept else 2
        return second_derivative(
            self.problem, normal, z, step, self.sigma, plans=self.plans, fraction=CURVATURE_STEP
        )

    def solve(
        self,
        start: Array,
        evaluations: int,
        *,
        tolerance: float = RESTING_OFFSET,
        accelerates: bool = True,
        damping: float | None = None,
    ) -> Minimum:
        """Minimise from a start, planning the substeps anew until the plan stays.

        Parameters
        ----------
        start
            Unknowns, shape (U,).
        evaluations
            Limit of evaluations of each run.
        tolerance
            As in `minimise`; a rough one needs no second plan.
        accelerates
            Whether long steps have a geodesic acceleration.
        damping
            That of a run that goes on; None begins anew.
        """
        limits = *self.problem.bounds(), self.problem.reach()
        lower, upper, _ = limits
        rough = evaluations <= SCOUT_EVALUATIONS or tolerance > RESTING_OFFSET

        def run(point: Array, aim: float, damping: float | None) -> Minimum:
            along = self.second_derivative if accelerates else None
            return minimise(
                self,
                point,
                *limits,
                evaluations=evaluations,
                tolerance=aim,
                second_derivative=along,
                damping=damping,
            )

        self._accelerates = accelerates
        point = np.clip(start, lower, upper)
        self.plans = self._plans(point)
        sums_first = not rough and self._entries > CHEAP_ENTRIES
        found = run(point, max(tolerance, LAST_STEP_OFFSET) if sums_first else tolerance, damping)
        for _ in range(0 if rough else MAX_PLANS - 1):
            on_the_way = sums_first and tolerance < found.offset <= LAST_STEP_OFFSET
            point = next_point(found, *limits) if on_the_way else found.point
            plans = self._plans(point)
            same = _same(plans, self.plans)
            if same and not on_the_way:
                break
            self.plans = plans
            there = self._with_prior(self._at(point, columns=True))  # most often the last one
            back = on_the_way and same and not there.cost <= found.normal.cost
            sums_first = sums_first and not back
            found = run(found.point if back else there.point, tolerance, None)
        self.plans = None
        return found


def _same(a: Sequence[Division | None], b: Sequence[Division | None]) -> bool:
    return all(
        p is q or (p is not None and q is not None and p.same_as(q))
        for p, q in zip(a, b, strict=True)
    )
