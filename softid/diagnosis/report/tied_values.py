"""Parameters that another cause of a tie would make others."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.parameter_doubts import less_sure, outside_intervals
from softid.diagnosis.report.phrases import title_of, titles_of
from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis_results import Diagnosis
from softid.sentences import lowered

TIED_REMEDY = "record what tells the causes of the tie apart"


def with_tied_values(found: Diagnosis, links: Sequence[Link], size: int) -> Diagnosis:
    """The diagnosis with what leaves its interval when another cause of a tie takes its place.

    An interval holds for the cause that was simulated, and that of its own parameters for nothing
    else. Only rivals that were refitted beside all other causes are asked.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    links
        The named links of its chain.
    size
        Number of its effects.
    """
    if found.extended is None:
        return found
    told = found.extended.parameters
    found = _with_own_parameters(found)
    for name, model in _models_with_others(found, links, size):
        found = less_sure(
            found,
            outside_intervals(told, model.parameters),
            f"it is another one with {title_of(name)}, which these logs do not tell from the cause",
            TIED_REMEDY,
        )
    return found


def _models_with_others(
    found: Diagnosis, links: Sequence[Link], size: int
) -> Iterator[tuple[str, Candidate]]:
    """What else is in a tie, and the model with it in the place of a cause."""
    tied = {name for tie in found.alternatives for name in tie.effects}
    for link in links:
        if link.added.name not in tied:
            continue
        others = tied.intersection(link.rivals) - {link.added.name}
        for row in link.extending:
            added = link.added_by(row)
            if len(row.plain.effects) == size and added.name in others:
                yield added.key, row.plain
        yield from ((name, model) for name, model in link.replaced if name in others)


def _with_own_parameters(found: Diagnosis) -> Diagnosis:
    """The diagnosis with the parameters of tied causes, which another cause does not even have."""
    pairs = [
        (cause, tie)
        for tie in found.alternatives
        for cause in found.causes
        if cause.effect in tie.effects
    ]
    for cause, tie in pairs:
        others = [key for key in tie.keys if key.partition(".")[0] != cause.effect]
        found = less_sure(
            found,
            [p.name for p in cause.parameters],
            f"it holds for {lowered(cause.title)} only, which these logs do not tell from "
            f"{titles_of(others, last=' or ')}",
            TIED_REMEDY,
        )
    return found
