"""A model refitted to parts of its logs, of which another may be true, or to changed ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate, advance, begun
from softid.errors import IdentificationError
from softid.fitters.problem import Problem
from softid.log import Log

Array = npt.NDArray[np.float64]

EXACT = 1000
"""Most steps in a sampling interval: as many as the law asks for, since noise is what is left."""

REFIT_EVALUATIONS = 40
"""Simulations with derivatives of a refit to a part of what the base was fitted to."""

SETTLED_SHARE = 0.99
"""A refit goes on under a lighter prior while a run leaves less than this share of the squares."""


def refitted(
    known: Candidate, sigma: Mapping[str, float], logs: Sequence[Log], evaluations: int
) -> Candidate:
    """A model refitted to other logs, from where it stands and from a guess.

    A term that has vanished where it stands, on a logarithmic scale, finds no way back.

    Parameters
    ----------
    known
        The model without effects; zeros and initial states come from the logs.
    sigma, evaluations
        As in `advance`.
    logs
        What it is fitted to.

    Raises
    ------
    IdentificationError
        The logs have no more samples than there are unknowns.
    """
    problem = Problem(known.problem.model, known.problem.parameters, logs)
    if problem.n_samples <= problem.size:
        raise IdentificationError(
            f"{problem.n_samples} samples cannot tell {problem.size} unknowns",
            where=", ".join(log.place for log in logs),
        )
    guesses = problem.model.guess(problem.plain_segments, problem.outputs[0])
    starts = [known.parameters, *(guess.values_dict() for guess in guesses[:1])]
    begins = [begun(known, known.effects, problem, problem.unknowns(start)) for start in starts]
    return best_settled(begins, sigma, evaluations)


def refitted_to_changed(
    known: Candidate, sigma: Mapping[str, float], logs: Sequence[Log], evaluations: int
) -> Candidate | None:
    """A model with its effects refitted to its logs after a small change, from where it stands.

    Parameters
    ----------
    known, sigma, evaluations
        As in `refitted`.
    logs
        The changed logs.

    Returns
    -------
    Candidate or None
        None where its unknowns differ with that, or the response is not finite.
    """
    problem = Problem(known.problem.model, known.problem.parameters, logs)
    if problem.size != known.problem.size:
        return None
    begin = replace(known, problem=problem, minimum=replace(known.minimum, damping=None))
    again = advance(begin, sigma, evaluations)
    return again if np.isfinite(again.squares) else None


def best_settled(
    begins: Sequence[Candidate], sigma: Mapping[str, float], evaluations: int
) -> Candidate:
    """The best end of refits, each of which goes on while the prior gets lighter with the residual.

    Parameters
    ----------
    begins
        One candidate at several starts.
    sigma, evaluations
        As in `advance`.
    """

    def settled(one: Candidate) -> Candidate:
        before = np.inf
        while one.squares < SETTLED_SHARE * before:
            before = one.squares
            one = advance(one, sigma, evaluations, substeps=EXACT)
        return one

    return min(map(settled, begins), key=lambda end: end.squares)


def white_standard_errors(one: Candidate) -> Array:
    """Of all unknowns on the scale of the search, as if the noise were white, shape (U,).

    Parameters
    ----------
    one
        A model at its optimum.
    """
    variance = one.squares / max(one.problem.n_samples - one.problem.size, 1)
    inverse = np.linalg.pinv(one.minimum.normal.matrix, hermitian=True)
    errors: Array = np.sqrt(np.maximum(variance * np.diag(inverse), np.finfo(float).tiny))
    return errors
