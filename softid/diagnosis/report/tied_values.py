"""Parameters that another cause of a tie would make others."""

from __future__ import annotations

from collections.abc import Sequence

from softid.diagnosis.report.joint_causes import less_sure, outside_intervals
from softid.diagnosis.report.phrases import lowered, title_of, titles_of
from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis_results import Diagnosis

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
    found = _with_own_parameters(found)
    assert found.extended is not None
    tied = {name for tie in found.alternatives for name in tie.effects}
    for link in links:
        if link.added.name not in tied:
            continue
        rivals = [
            row
            for row in link.extending
            if len(row.plain.effects) == size
            and link.added_by(row).name in tied - {link.added.name}
            and link.added_by(row).name in link.rivals
        ]
        for row in rivals:
            moved = outside_intervals(found.extended.parameters, row.plain.parameters)
            other = title_of(link.added_by(row).key)
            found = less_sure(
                found,
                moved,
                f"it is another one with {other}, which these logs do not tell from the cause",
                TIED_REMEDY,
            )
    return found


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
