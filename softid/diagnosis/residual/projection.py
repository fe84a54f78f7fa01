"""Residuals and derivatives of a model at the samples that count, and what such columns span."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import FINE_STEPS, Candidate, limited_plans
from softid.diagnosis.refit.whitening import Place
from softid.diagnosis.residual.motion import residual_context
from softid.diagnosis.residual.structure import ResidualContext

Array = npt.NDArray[np.float64]

SEEN = 1e-10
"""Directions that are weaker than this share of the strongest are rounding."""

LEAST_DISTINCT = 1e-6
"""Columns of which others leave less than this share are rounding, and so are directions within
what they leave: to take out those others has cost digits."""


@dataclass(frozen=True, eq=False)
class Rows:
    """One output channel over one segment.

    Attributes
    ----------
    place
        Which.
    residual
        Measured minus simulated at the used samples, shape (m,).
    jacobian
        ∂(simulated)/∂(unknowns) there, shape (m, U).
    motion
        Motion and input at all samples.
    """

    place: Place
    residual: Array
    jacobian: Array
    motion: ResidualContext

    @property
    def channel(self) -> str:
        """The output channel."""
        return self.place.channel

    @property
    def used(self) -> npt.NDArray[np.bool_]:
        """Which samples are used, shape (n,)."""
        return self.place.used


def rows_of(candidate: Candidate) -> list[Rows]:
    """What a model leaves and how it bends, for every output channel and segment.

    Parameters
    ----------
    candidate
        A model where it stands.
    """
    problem, z = candidate.problem, candidate.minimum.point
    motions = residual_context(candidate)
    plans = limited_plans(problem, z, FINE_STEPS)
    found = []
    for block in problem.blocks(z, derivatives=True, plans=plans):
        assert block.jacobian is not None
        place, motion = Place.of(block, problem), motions[block.segment]
        found.append(Rows(place, block.residual, block.jacobian, motion))
    return found


def joined(rows: Sequence[Rows], values: Callable[[ResidualContext], Array]) -> Array:
    """A variable of the motion at the used samples of all rows, shape (m,).

    Parameters
    ----------
    rows
        The rows.
    values
        The variable, at all samples of one of them.
    """
    return np.concatenate([values(row.motion)[row.used] for row in rows])


def logs_of(rows: Sequence[Rows]) -> npt.NDArray[np.intp]:
    """Index of the log of each used sample of all rows, shape (m,).

    Parameters
    ----------
    rows
        The rows.
    """
    return np.concatenate([np.full(row.residual.size, row.place.log) for row in rows])


def slopes_of(candidate: Candidate) -> list[Array]:
    """Derivatives of the first output by the unknowns at the used samples of each segment.

    Parameters
    ----------
    candidate
        A model where it stands.
    """
    first = candidate.problem.outputs[0]
    return [rows.jacobian for rows in rows_of(candidate) if rows.channel == first]


@dataclass(frozen=True, eq=False)
class Span:
    """What columns span.

    Attributes
    ----------
    basis
        Orthonormal columns of the same span, shape (m, B).
    combinations
        What makes them of the given columns: columns @ combinations = basis, shape (C, B).
    """

    basis: Array
    combinations: Array


def span_of(columns: Array, smallest: float) -> Span:
    """The directions of columns that are not rounding, each column scaled to unit length first.

    Parameters
    ----------
    columns
        Of shape (m, C).
    smallest
        Share of the strongest direction below which one is left out.

    Examples
    --------
    >>> import numpy as np
    >>> columns = np.array([[3.0, 6.0, 0.0], [4.0, 8.0, 0.0]])
    >>> span = span_of(columns, 1e-10)
    >>> np.round(np.abs(span.basis), 3).tolist()
    [[0.6], [0.8]]
    >>> np.allclose(columns @ span.combinations, span.basis)
    True
    """
    size = np.linalg.norm(columns, axis=0)
    filled = size > 0.0
    left, singular, right = np.linalg.svd(columns[:, filled] / size[filled], full_matrices=False)
    seen = singular > smallest * singular.max(initial=0.0)
    combinations = np.zeros((size.size, int(seen.sum())))
    combinations[filled] = right[seen].T / singular[seen] / size[filled, None]
    return Span(left[:, seen], combinations)


def basis_of(columns: Array, smallest: float = SEEN) -> Array:
    """Orthonormal columns that span the given ones.

    Parameters
    ----------
    columns, smallest
        As in `span_of`.
    """
    return span_of(columns, smallest).basis


def project_out(basis: Array, columns: Array) -> Array:
    """Columns, or one, with what an orthonormal basis spans taken out.

    Parameters
    ----------
    basis
        Of shape (m, B).
    columns
        Of shape (m, C) or (m,).
    """
    projected: Array = columns - basis @ (basis.T @ columns)
    return projected


def added_basis(basis: Array, columns: Array) -> Array:
    """What columns add to an orthonormal basis: orthonormal and beside it.

    Parameters
    ----------
    basis
        Of shape (m, B).
    columns
        Of shape (m, C).
    """
    left = project_out(basis, columns)
    adds = np.linalg.norm(left, axis=0) > LEAST_DISTINCT * np.linalg.norm(columns, axis=0)
    return basis_of(left[:, adds], LEAST_DISTINCT)
