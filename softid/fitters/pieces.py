"""One output channel over one segment as the normal equations see it.

Columns C (derivatives, one, residual) that are seldom seen, their products G = C Cᵀ, and the
weights T with which they make up the Jacobian, J = Cᵀ T.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.fitters.blocks import Block
from softid.fitters.problem import Problem
from softid.models.products import Products

Array = npt.NDArray[np.float64]
IndexArray = npt.NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Piece:
    """One output channel over one segment.

    Attributes
    ----------
    channel, segment
        Output channel, and index in `Problem.segments`.
    gram
        Products of the columns, the last two being one and the residual, shape (C, C).
    moved_by
        The unknowns that move it, in order: of the zeros and initial states only its own, shape
        (P,).
    jacobian
        Weights with which the columns make up ∂(simulated)/∂(those), shape (C, P).
    residual
        Weights with which they make up the residual, shape (C,).
    columns
        The columns at every sample, zero where it is not used, shape (C, n), or their means over
        the used samples of every stretch, shape (C, m); None where they were not kept.
    counts
        Number of used samples in every stretch, shape (m,); None where no means were kept.
    left
        The last column at every sample where the others are not, shape (n,), or None.
    summed
        Whether a kernel summed the products, which it does for an output on a line in a motion that
        is affine in its state.
    """

    channel: str
    segment: int
    gram: Array
    moved_by: IndexArray
    jacobian: Array
    residual: Array
    columns: Array | None
    counts: Array | None
    left: Array | None
    summed: bool = False

    def by(self, unknowns: IndexArray) -> Array:
        """The weights for unknowns of which some may not move it, shape (C, V).

        Parameters
        ----------
        unknowns
            Their indices, shape (V,).
        """
        weights = np.zeros((self.gram.shape[0], unknowns.size))
        mine, theirs = np.nonzero(self.moved_by[:, None] == unknowns)
        weights[:, theirs] = self.jacobian[:, mine]
        return weights

    def less(self, move: float) -> Piece:
        """The piece where its sensor zero is larger by so much.

        Parameters
        ----------
        move
            The difference, in the unit of the channel.
        """
        residual = self.residual.copy()
        residual[-2] -= move
        return replace(self, residual=residual)

    @property
    def kept(self) -> bool:
        """Whether the columns at every sample are there."""
        return self.columns is not None and self.counts is None

    @property
    def has_residuals(self) -> bool:
        """Whether the residual at every sample is there."""
        return self.kept or self.left is not None

    @property
    def unmoved(self) -> Array:
        """The residual at every sample without its move to the zero, shape (n,)."""
        last = self.columns[-1] if self.columns is not None and self.kept else self.left
        assert last is not None
        return last

    @property
    def residuals(self) -> Array:
        """The residual at every sample, anything where it is not used, shape (n,)."""
        found: Array = self.unmoved + self.residual[-2]  # all of them follow their zero
        return found

    @property
    def squares(self) -> tuple[float, int]:
        """Σr² and the number of residuals."""
        return max(float(self.residual @ self.gram @ self.residual), 0.0), self.count

    @property
    def count(self) -> int:
        """Number of residuals."""
        count = float(self.gram[-2, -2])
        return round(count) if math.isfinite(count) else 0


def piece_of_products(
    problem: Problem, chain: Array, segment: int, channel: str, products: Products
) -> Piece:
    """The piece of a segment and channel from products that a kernel summed.

    Parameters
    ----------
    problem
        What to fit.
    chain
        ∂θ/∂(free unknowns), shape (K, F).
    segment, channel
        Its place.
    products
        The products.
    """
    at = _moved_by(problem, segment, channel)
    inner, free, states = (
        len(products.by_theta),
        len(problem.free),
        problem.state_positions(segment),
    )
    jacobian, residual = np.zeros((len(products.gram), at.size)), np.zeros(len(products.gram))
    jacobian[:inner, :free] = products.by_theta @ chain
    if problem.zeros:
        jacobian[-2, free] = 1.0
    if states:
        jacobian[inner:-2, -len(states) :] = products.by_state[:, : len(states)]
    residual[-1] = 1.0
    kept = products.columns, products.counts, products.left
    return Piece(channel, segment, products.gram, at, jacobian, residual, *kept, summed=True)


def piece_of_block(problem: Problem, block: Block, *, keep: bool) -> Piece:
    """The piece of a segment and channel from its residuals and Jacobian.

    Parameters
    ----------
    problem, block
        What to fit, and these.
    keep
        Whether all columns are kept; the residual always is.
    """
    assert block.jacobian is not None
    used = problem.segments[block.segment].used[block.channel]
    at = _moved_by(problem, block.segment, block.channel)
    columns = np.empty((at.size + 2, block.residual.size))
    columns[:-2] = block.jacobian[:, at].T  # faster than among the rows of a transpose
    columns[-2] = 1.0
    columns[-1] = block.residual
    jacobian = np.eye(columns.shape[0], at.size)
    residual = np.zeros(columns.shape[0])
    residual[-1] = 1.0
    last = _spread(columns if keep else columns[-1:], used)
    kept = (last, None, None) if keep else (None, None, last[0].copy())
    return Piece(block.channel, block.segment, columns @ columns.T, at, jacobian, residual, *kept)


def _spread(rows: Array, used: npt.NDArray[np.bool_]) -> Array:
    """Rows of values at the used samples with zeros at the others, shape (C, n)."""
    if used.all():
        return rows
    spread = np.zeros((len(rows), used.size))
    spread[:, used] = rows
    return spread


def _moved_by(problem: Problem, segment: int, channel: str) -> IndexArray:
    """The unknowns that move an output channel over a segment, in order."""
    places = list(range(len(problem.free)))
    if problem.zeros:
        places.append(problem.zero_position(problem.owner[segment], channel))
    return np.array([*places, *problem.state_positions(segment)], np.intp)
