"""Chains in which a rival stands in the place of the last cause."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from softid.diagnosis.search.forward_selection import Chain


def with_rivals_in_place(chain: Chain) -> Iterator[Chain]:
    """The chain with each rival of its last cause in the place of that, which is a rival then.

    Of causes that explain the logs as well, the best by a little may be one whose numbers say too
    little, as the stiffness of a wall that is hardly touched, while those of another do not.

    Parameters
    ----------
    chain
        The chain.
    """
    if not chain.links:
        return
    *before, link = chain.links
    for row in link.extending:
        rival = link.added_by(row).name
        same = len(row.candidate.effects) == len(chain.final.effects)
        if row is link.chosen or not same or rival not in link.rivals[1:]:
            continue
        rivals = (rival, *(name for name in link.rivals if name != rival))
        taken = replace(link, chosen=row, rivals=rivals, found=row.plain)
        yield Chain((*before, taken), chain.last, row.plain)
