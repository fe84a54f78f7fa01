"""Residuals and derivatives of a model at the samples that count, as columns over all segments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import FINE, Candidate, limited_plans
from softid.diagnosis.residual.motion import residual_context
from softid.diagnosis.residual.structure import ResidualContext

Array = npt.NDArray[np.float64]

SEEN, DISTINCT = 1e-10, 1e-6
"""Directions that are weaker than this share of the strongest, or of what they are without what
others explain of them, are rounding."""


@dataclass(frozen=True, eq=False)
class Rows:
    """One output channel over one segment.

    Attributes
    ----------
    channel
        The output channel.
    residual
        Measured minus simulated at the used samples, shape (m,).
    jacobian
        ∂(simulated)/∂(unknowns) there, shape (m, U).
    used
        Which samples are used, shape (n,).
    log
        Index of the log.
    motion
        Motion and input at all samples.
    """

    channel: str
    residual: Array
    jacobian: Array
    used: npt.NDArray[np.bool_]
    log: int
    motion: ResidualContext


def rows_of(candidate: Candidate) -> list[Rows]:
    """What a model leaves and how it bends, for every output channel and segment.

    Parameters
    ----------
    candidate
        A model where it stands.
    """
    problem, z = candidate.problem, candidate.minimum.point
    motions = residual_context(candidate)
    plans = limited_plans(problem, z, FINE)
    found = []
    for block in problem.blocks(z, derivatives=True, plans=plans):
        assert block.jacobian is not None
        segment = problem.segments[block.segment]
        used = segment.samples_of(segment.used[block.channel])
        owner, motion = problem.owner[block.segment], motions[block.segment]
        found.append(Rows(block.channel, block.residual, block.jacobian, used, owner, motion))
    return found


def basis_of(columns: Array, smallest: float = SEEN) -> Array:
    """Orthonormal columns that span the given ones.

    Parameters
    ----------
    columns
        Of shape (m, C).
    smallest
        Share of the strongest direction below which one is rounding.
    """
    size = np.linalg.norm(columns, axis=0)
    scaled: Array = columns[:, size > 0.0] / size[size > 0.0]
    if scaled.shape[1] == 0:
        return scaled
    left, singular, _ = np.linalg.svd(scaled, full_matrices=False)
    basis: Array = left[:, singular > smallest * singular[0]]
    return basis


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
    basis, columns
        As in `beside`, with ``columns`` of shape (m, C).
    """
    left = project_out(basis, columns)
    adds = np.linalg.norm(left, axis=0) > DISTINCT * np.linalg.norm(columns, axis=0)
    return basis_of(left[:, adds], DISTINCT)
