"""Causes that a misfit without an explanation does not let apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softid.diagnosis.search.bic_ranking import Ranked
from softid.diagnosis.search.forward_selection import INDISTINCT, Link

MOST_SAMPLES = 100.0
"""What a wrong law leaves follows the motion, and is a hundred numbers at most however long the log
is: so many independent samples at most speak for one cause against another."""


def with_rivals_in_misfit(link: Link) -> Link:
    """The link with every cause that an unexplained misfit lets pass for the chosen one.

    The BIC counts the samples of whitened residuals. That is right for noise. Where structure is
    left, the same criterion is taken for ν samples: ν ln S + k ln ν with ν = min(n, 100).

    Parameters
    ----------
    link
        A round of the search, after which structure is left.

    Returns
    -------
    Link
        With more rivals, the chosen cause first.
    """
    limit = _criterion(link.chosen) + INDISTINCT
    known = len(link.before.candidate.effects)
    names = [
        link.added_by(row).name
        for row in link.ranked
        if len(row.candidate.effects) > known and _criterion(row) < limit
    ]
    return replace(link, rivals=tuple(dict.fromkeys((*link.rivals, *names))))


def _criterion(row: Ranked) -> float:
    n, k = row.candidate.minimum.normal.n, row.candidate.problem.size
    counted = min(float(n), MOST_SAMPLES)
    return float((row.bic - k * np.log(n)) * counted / n + k * np.log(counted))
