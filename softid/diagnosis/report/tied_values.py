"""Parameters that another cause of a tie would make others."""

from __future__ import annotations

from collections.abc import Sequence

from softid.diagnosis.report.joint_causes import less_sure, outside_intervals
from softid.diagnosis.report.phrases import title_of
from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis_results import Diagnosis


def with_tied_values(found: Diagnosis, links: Sequence[Link], size: int) -> Diagnosis:
    """The diagnosis with what leaves its interval when another cause of a tie takes its place.

    An interval holds for the cause that was simulated. Only rivals that were refitted beside all
    other causes are asked.

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
                "record what tells the causes of the tie apart",
            )
    return found
