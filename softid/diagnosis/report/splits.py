"""What to record so that causes are told apart, beyond what the logs hold already."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from softid.diagnosis.report.held_excitation import is_held
from softid.diagnosis.report.phrases import title_of, titles_of
from softid.diagnosis.verdict.separations import (
    EXPERIMENTS,
    SEPARATIONS,
    splitting_experiment,
    why_unsplit,
)

WORTH_RECORDING = 1.0
"""Least difference of two causes, in units of the noise of 0.5 %, for which an experiment is
advised in the place of a better one that the logs hold: the noise itself."""

MOST_OTHERS = 2
"""Most causes that advice names beside the first; of more it says that there are others."""

BETWEEN = "; "
"""Words between the experiments that show one cause each."""


@dataclass(frozen=True)
class SplitAdvice:
    """What to record.

    Attributes
    ----------
    experiment
        In the words of the catalogue.
    is_again
        Whether the logs hold it already, and nothing else is known that would do.
    """

    experiment: str
    is_again: bool


def advised_split(keys: Sequence[str], held: frozenset[str]) -> SplitAdvice | None:
    """The experiment that tells causes apart and is not on record; that one again where all is.

    Parameters
    ----------
    keys
        Keys of the causes, the best first.
    held
        From `held_experiments`.

    Returns
    -------
    SplitAdvice or None
        None where no experiment is known.
    """
    split = splitting_experiment(keys)
    if split is None:
        return None
    wanted = split.experiment.split(BETWEEN)
    lacking = [one for one in wanted if not is_held(one, held)]
    if lacking:
        return SplitAdvice(BETWEEN.join(lacking), is_again=False)
    other = _next_best(keys, held)
    return SplitAdvice(other or wanted[0], is_again=other is None)


def split_in_words(keys: Sequence[str], held: frozenset[str]) -> str | None:
    """What to record, as advice.

    Parameters
    ----------
    keys, held
        As in `advised_split`.
    """
    advice = advised_split(keys, held)
    if advice is None:
        return None
    first, *others = keys
    rest = titles_of(others, last=" or ") if len(others) <= MOST_OTHERS else "the others"
    again = " once more, for longer or with less noise" if advice.is_again else ""
    return f"record {advice.experiment}{again}, to tell {title_of(first)} from {rest}"


def why_tied_here(keys: Sequence[str], held: frozenset[str], *, alike: bool) -> str:
    """Why causes are not told apart, and what would do it, in plain sentences.

    Parameters
    ----------
    keys, held
        As in `advised_split`.
    alike
        Whether they explain the logs equally well.
    """
    usual = why_unsplit(keys, alike=alike)
    split, advice = splitting_experiment(keys), advised_split(keys, held)
    if split is None or advice is None:
        return usual
    reason = usual.partition(". ")[0]
    if advice.is_again:
        return f"{reason}. What tells them apart best is in these logs, but too faintly."
    if advice.experiment == split.experiment:
        return usual
    return f"{reason}. What these logs lack and would help: {advice.experiment}."


def _next_best(keys: Sequence[str], held: frozenset[str]) -> str | None:
    """Where the best differs most from each of the others among what is not on record."""
    names = list(dict.fromkeys(key.split(".")[0] for key in keys))
    rows = [SEPARATIONS.get(frozenset((names[0], other))) for other in names[1:]]
    known = [row for row in rows if row is not None]
    if len(known) < len(rows):
        return None
    worst = [min(column) for column in zip(*known, strict=True)]
    ranked = sorted(zip(worst, EXPERIMENTS, strict=True), reverse=True)
    useful = (one for apart, one in ranked if apart >= WORTH_RECORDING and not is_held(one, held))
    return next(useful, None)
