"""What a user should know about how a diagnosis was made."""

from __future__ import annotations

from collections.abc import Sequence

from softid.diagnosis.phrases import listed
from softid.effects import EFFECTS
from softid.errors import Issue


def restriction(effects: Sequence[str]) -> tuple[Issue, ...]:
    """What a search among some effects cannot say; nothing for the whole catalogue.

    Parameters
    ----------
    effects
        Keys of the effects that were considered; empty for all.
    """
    left_out = [key for key in EFFECTS if effects and key not in effects]
    if not left_out:
        return ()
    return (
        Issue(
            "few-effects",
            "warning",
            f"only {listed(list(effects))} {'was' if len(effects) == 1 else 'were'} considered: "
            "another effect may explain the logs as well or better",
            "diagnose again without --effects",
        ),
    )


def averaged_over(count: int) -> tuple[Issue, ...]:
    """That the logs were averaged, which hides what is faster than a mean; nothing if not.

    Parameters
    ----------
    count
        Samples in a mean.
    """
    if count == 1:
        return ()
    return (
        Issue(
            "averaged",
            "info",
            f"every {count} samples were averaged into one: a time constant of the motion is "
            "longer than thirty of the means",
            None,
        ),
    )
