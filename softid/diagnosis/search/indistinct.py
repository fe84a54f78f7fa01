"""Causes that a misfit without an explanation, or another log, does not let apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.bic_ranking import Ranked
from softid.diagnosis.search.contenders import INDISTINCT
from softid.diagnosis.search.forward_selection import Link

MOST_SAMPLES = 100.0
"""What a wrong law leaves follows the motion, and is a hundred numbers at most however long the log
is: so many independent samples at most speak for one cause against another."""

NEARLY_AS_MUCH = 0.01
"""A rival explains nearly as much when its BIC is behind by so small a share of what the cause
gains: rounding, and what the input does between its samples, make as much of a difference."""

BETTER_ELSEWHERE = 0.97
"""Share of a cause's error on what is held out that a rival must stay below to be preferred
there."""


def with_rivals_held_out(
    link: Link, final: Candidate, held_out_rms: Callable[[Candidate], float]
) -> Link:
    """The link with causes that explain nearly as much, and clearly more of what is held out.

    A staircase hardly tells dry friction from a hysteresis, whose small loops another log shows.

    Parameters
    ----------
    link
        A round of the search.
    final
        The model with all causes; only what has as many is compared.
    held_out_rms
        Error of a model on what is held out.

    Returns
    -------
    Link
        With more rivals, the chosen cause first.
    """
    limit = link.chosen.bic + NEARLY_AS_MUCH * link.delta_bic
    near = [
        row
        for row in link.extending
        if row.bic < limit
        and len(row.candidate.effects) == len(final.effects)
        and link.added_by(row).name not in link.rivals
    ]
    if not near:
        return link
    most = BETTER_ELSEWHERE * held_out_rms(final)
    names = [link.added_by(row).name for row in near if held_out_rms(row.plain) < most]
    return replace(link, rivals=tuple(dict.fromkeys((*link.rivals, *names))))


def best_of_tie(
    links: Sequence[Link], final: Candidate, held_out_rms: Callable[[Candidate], float]
) -> Candidate:
    """The model that errs least on what is held out, of those that a tie lets pass.

    Parameters
    ----------
    links
        The rounds of a chain, with their rivals.
    final
        The model with all causes; only what has as many is compared.
    held_out_rms
        Error of a model on what is held out.
    """
    rivals = [
        row.plain
        for link in links
        for row in link.extending
        if len(row.candidate.effects) == len(final.effects)
        and link.added_by(row).name in link.rivals[1:]
    ]
    return min((final, *rivals), key=held_out_rms)


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
    names = [link.added_by(row).name for row in link.extending if _criterion(row) < limit]
    return replace(link, rivals=tuple(dict.fromkeys((*link.rivals, *names))))


def _criterion(row: Ranked) -> float:
    n, k = row.candidate.minimum.normal.n, row.candidate.problem.size
    counted = min(float(n), MOST_SAMPLES)
    return float(row.misfit * counted / n + k * np.log(counted))
