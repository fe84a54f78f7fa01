"""Cost and normal equations of an output-error problem, summed without a Jacobian where possible.

Every output channel of every segment contributes a piece, with products G and weights T of its
columns (`softid.fitters.pieces`). Then JᵀJ = Tᵀ G T and Jᵀr = Tᵀ G t, t making up the residual. A
sensor zero moves to its optimum by changing t, no sample being visited again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.fitters.blocks import Block
from softid.fitters.levenberg_marquardt import NormalEquations
from softid.fitters.pieces import Piece, piece_of_block, piece_of_products
from softid.fitters.problem import Problem
from softid.kernels.affine_blocks import N_COLUMNS
from softid.kernels.equation_sums import add_equations
from softid.models.division import Division
from softid.models.products import NO_COLUMNS, Keep, Products
from softid.segment import Segment

Array = npt.NDArray[np.float64]
IndexArray = npt.NDArray[np.intp]

KEPT_ENTRIES = 8_000_000
"""Largest Jacobian that is kept whole (64 MB) where it is made anyway."""

WIDEST_MEANS = 2
"""Every log brings a zero of its own, so that rows of many logs are long; averages over so many
times the samples make up for that, and no more, for they would miss too much."""

SUMMED_ENTRIES = 100_000
"""Largest Jacobian that is kept where a kernel sums its products (1 MB): a larger one would take
several times the log's own memory."""


@dataclass(frozen=True, eq=False)
class Linearised(NormalEquations):
    """Normal equations with the pieces that they were summed from.

    Attributes
    ----------
    pieces
        One per segment and channel, in the order of `Problem.blocks`.
    plans
        Steps per segment that were taken, None where they were planned anew.
    problem
        What was simulated.
    """

    pieces: tuple[Piece, ...]
    plans: Sequence[Division | None] | None
    problem: Problem

    @property
    def affine(self) -> bool:
        """Whether zeros and initial states stand linearly in all outputs."""
        return all(piece.summed for piece in self.pieces)

    @property
    def kept(self) -> bool:
        """Whether the columns of all pieces are there."""
        return all(piece.kept for piece in self.pieces)

    @property
    def has_means(self) -> bool:
        """Whether means of the columns of all pieces over stretches of samples are there."""
        return all(piece.counts is not None for piece in self.pieces)

    @property
    def has_residuals(self) -> bool:
        """Whether the residuals of all pieces are there."""
        return all(piece.has_residuals for piece in self.pieces)

    def at_used(self, piece: Piece, values: Array) -> Array:
        """Those of values at every sample, or of rows of them, that a piece uses."""
        used = self.problem.segments[piece.segment].used[piece.channel]
        return values if used.all() else values[used]

    def blocks(self, *, derivatives: bool) -> list[Block]:
        """Residuals at the used samples, and Jacobians if asked, where they were kept."""
        blocks = []
        for piece in self.pieces:
            residual, jacobian = self.at_used(piece, piece.residuals), None
            if derivatives:
                assert piece.columns is not None
                weights = piece.by(np.arange(self.problem.size))
                jacobian = self.at_used(piece, piece.columns.T @ weights)
            blocks.append(Block(piece.channel, piece.segment, residual, jacobian))
        return blocks

    def weighted(self, sigma: Mapping[str, float]) -> Linearised:
        """What `linearise` would find at the point, without a prior; nothing is simulated."""
        with np.errstate(all="ignore"):
            return _summed_at_best_zeros(self.problem, self.point, self.pieces, sigma, self.plans)

    def with_zeros_of(self, z: Array) -> Linearised:
        """The same pieces at ``z``, which differs in its sensor zeros only; nothing is summed."""
        if not self.problem.zeros:
            return replace(self, point=z)
        move = z - self.point
        pieces = (piece.less(move[_zero_of(self.problem, piece)]) for piece in self.pieces)
        return replace(self, point=z, pieces=tuple(pieces))


def means_of(problem: Problem, *, residual: bool = False) -> Keep:
    """Means of columns over so many samples that they take no more memory than the logs do.

    Parameters
    ----------
    problem
        What to fit.
    residual
        As in `Keep`.
    """
    rows, channels = sum(s.time_s.size for s in problem.segments), len(problem.outputs)
    width = min(max(N_COLUMNS, problem.size), WIDEST_MEANS * N_COLUMNS)
    stretch = -(-rows * channels * width // min(KEPT_ENTRIES, rows * (2 + channels)))
    return Keep(stretch, residual)


def linearise(
    problem: Problem,
    z: Array,
    sigma: Mapping[str, float],
    *,
    plans: Sequence[Division | None] | None = None,
    keep: Keep = NO_COLUMNS,
) -> Linearised:
    """Cost ½Σ(r/σ)² and its normal equations with every sensor zero moved to its optimum.

    Parameters
    ----------
    problem
        What to fit.
    z
        Unknowns, shape (U,).
    sigma
        Output channel → σ.
    plans
        Steps per segment, held still by an optimiser; None plans anew.
    keep
        As in `Model.products`; where no kernel sums the products, the columns are there anyway at
        every sample, and all are kept, or the residual if they are too many.
    """
    with np.errstate(all="ignore"):
        pieces = _pieces(problem, z, plans, keep=keep)
        return _summed_at_best_zeros(problem, z, pieces, sigma, plans)


def _zero_of(problem: Problem, at: Piece | Block) -> int:
    """Where the sensor zero of a segment and channel stands among the unknowns."""
    return problem.zero_position(problem.owner[at.segment], at.channel)


def _summed_at_best_zeros(
    problem: Problem,
    z: Array,
    pieces: Sequence[Piece],
    sigma: Mapping[str, float],
    plans: Sequence[Division | None] | None,
) -> Linearised:
    """The normal equations with every zero at its optimum, which the residuals follow."""
    moved, pieces = _at_best_zeros(problem, z, pieces)
    cost, n = 0.0, 0
    gradient, matrix = np.zeros(problem.size), np.zeros((problem.size, problem.size))
    for piece in pieces:
        weight = 1.0 / sigma[piece.channel] ** 2
        columns = piece.gram, piece.jacobian, piece.residual
        squares, is_finite = add_equations(*columns, piece.moved_by, weight, gradient, matrix)
        cost += 0.5 * weight * max(squares, 0.0) if is_finite else np.inf
        n += piece.count
    if not np.isfinite(cost):
        cost, gradient, matrix = np.inf, np.zeros(problem.size), np.eye(problem.size)
    return Linearised(moved, cost, gradient, matrix, n, tuple(pieces), plans, problem)


def second_derivative(
    problem: Problem,
    at: Linearised,
    z: Array,
    step: Array,
    sigma: Mapping[str, float],
    *,
    plans: Sequence[Division | None] | None,
    fraction: float,
) -> Array | None:
    """Jᵀ∂²ŷ/∂v² for v = ``step``, or None where columns were not kept or it is not finite.

    Where a kernel sums the products, it also sums those with the response that differs.

    Parameters
    ----------
    problem, z, sigma, plans
        As in `linearise`.
    at
        The normal equations at ``z``.
    step
        Direction and length v, shape (U,).
    fraction
        Share of the step over which the second derivative is measured.
    """
    with np.errstate(all="ignore"):
        total = np.zeros(problem.size)
        blocks = problem.blocks(z + fraction * step, derivatives=False, plans=plans)
        for piece, there in zip(at.pieces, blocks, strict=True):
            found = _products_with(problem, at.point, piece, there.residual, plans)
            if found is None:
                return None
            mine = piece.moved_by
            straight = piece.gram @ (piece.residual - fraction * (piece.jacobian @ step[mine]))
            pulled = piece.jacobian.T @ (straight - found)
            total[mine] += 2.0 / (fraction * sigma[piece.channel]) ** 2 * pulled
    return total if np.isfinite(total).all() else None


def _products_with(
    problem: Problem,
    z: Array,
    piece: Piece,
    values: Array,
    plans: Sequence[Division | None] | None,
) -> Array | None:
    """Products of the columns and values at the used samples, shape (C,); None without columns."""
    segment = problem.segments[piece.segment]
    used = segment.used[piece.channel]
    if piece.columns is not None and piece.kept:
        return (piece.columns if used.all() else piece.columns[:, used]) @ values
    if not piece.summed:
        return None
    measured = segment.outputs[piece.channel].copy()
    measured[used] += values
    plan = plans[piece.segment] if plans is not None else None
    shifted = replace(segment, outputs={**segment.outputs, piece.channel: measured})
    place = piece.segment, piece.channel
    products = _products(problem, z, problem.theta(z), place, shifted, plan, keep=NO_COLUMNS)
    assert products is not None
    return products.gram[:, -1] - piece.gram @ piece.residual


def _pieces(
    problem: Problem, z: Array, plans: Sequence[Division | None] | None, *, keep: Keep
) -> list[Piece]:
    found: list[Piece] = []
    theta = problem.theta(z)
    if not np.isfinite(theta).all():
        blocks = problem.blocks(z, derivatives=True)
        return [piece_of_block(problem, block, keep=False) for block in blocks]
    chain = problem.chain(z, theta)
    for k in range(len(problem.segments)):
        plan = plans[k] if plans is not None else None
        summed = [
            _products(problem, z, theta, (k, name), problem.segments[k], plan, keep=keep)
            for name in problem.outputs
        ]
        if any(products is None for products in summed):
            blocks = problem.blocks(z, derivatives=True, plans=plans, only=k)
            few = problem.n_samples * problem.size <= KEPT_ENTRIES
            found.extend(piece_of_block(problem, block, keep=few) for block in blocks)
            continue
        for name, products in zip(problem.outputs, summed, strict=True):
            assert products is not None
            found.append(piece_of_products(problem, chain, k, name, products))
    return found


def _products(
    problem: Problem,
    z: Array,
    theta: Array,
    place: tuple[int, str],
    segment: Segment,
    plan: Division | None,
    *,
    keep: Keep,
) -> Products | None:
    """Those of the segment and channel of a ``place``, with the measured outputs of ``segment``."""
    number, channel = place
    zero = problem.zero_position(problem.owner[number], channel)
    return problem.model.products(
        theta,
        segment,
        channel,
        start=problem.start(z, number),
        relative=problem.has_equilibrium,
        plan=plan,
        zero=float(z[zero]) if problem.zeros else 0.0,
        keep=keep,
    )


def _at_best_zeros(
    problem: Problem, z: Array, pieces: Sequence[Piece]
) -> tuple[Array, Sequence[Piece]]:
    """Every zero at its optimum, the mean residual of its log and channel, and pieces there."""
    if not problem.zeros:
        return z, pieces
    sums: dict[int, tuple[float, float]] = {}
    places = [_zero_of(problem, piece) for piece in pieces]
    for place, piece in zip(places, pieces, strict=True):
        total, count = sums.get(place, (0.0, 0.0))
        left = float(piece.gram[-2] @ piece.residual)
        sums[place] = total + left, count + float(piece.gram[-2, -2])
    moved = z.copy()
    for place, (total, count) in sums.items():
        if count > 0.0 and math.isfinite(total):
            moved[place] += total / count
    rows = zip(places, pieces, strict=True)
    return moved, [piece.less(moved[place] - z[place]) for place, piece in rows]
