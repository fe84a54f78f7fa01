"""Why a cause is believed."""

from __future__ import annotations

import math
from collections.abc import Sequence

from softid.diagnosis.report.error_texts import ErrorTexts
from softid.diagnosis.report.phrases import neighbours_of, title_of, titles_of
from softid.diagnosis_results import Alternative, Cause, Evidence
from softid.effects import EFFECTS
from softid.sentences import listed

MOST_CONFUSED = 3
"""Most effects that a sentence lists as easily confused; `softid effects NAME` lists all."""


def evidence_text(
    teller: ErrorTexts,
    cause: Cause,
    tie: Alternative | None,
    evidence: Sequence[Evidence],
    errors: str,
) -> str:
    """Why a cause is believed, and what it could be confused with, in one or two sentences.

    Parameters
    ----------
    teller
        Tells errors in the unit of the output.
    cause
        The cause.
    tie
        The tie that it is in; None for none.
    evidence
        Of all rounds.
    errors
        What the held-out error was before and after, as the continuation of a sentence.
    """
    told = f"Evidence: BIC falls by {cause.delta_bic:.0f}{errors}"
    if cause.holdout_rmse_without is not None:
        told += f"; without it the others leave {teller.size(cause.holdout_rmse_without)}"
    tied = {cause.effect, *(tie.effects if tie else ())}
    raced = [e for e in evidence if e.round == cause.round and e.effect.split(".")[0] not in tied]
    rivals = [(e.delta_bic, e.effect) for e in raced if e.delta_bic is not None]
    kind = " of another kind" if _has_other_forms(cause, evidence) else ""
    ahead = sorted({key for delta, key in rivals if delta > cause.delta_bic})
    if ahead:
        lower, their = ("lowers", "its") if len(ahead) == 1 else ("lower", "their")
        told += (
            f"; {titles_of(ahead)} {lower} it more, but only where {their} law becomes another, or "
            "not on what is held out"
        )
    elif rivals and max(rivals)[0] > 0.0:
        delta, key = max(rivals)
        told += (
            f"; the next best{kind}, {title_of(key)}, stays {cause.delta_bic - delta:.0f} behind"
        )
    elif rivals:
        told += f"; no effect{kind or ' besides it'} that stayed in the race lowers it"
    confused = [] if tie else neighbours_of(cause.key)
    if confused:
        known = {e.effect for e in raced} - {key.split(".")[0] for key in ahead}
        also = ", which explain these logs less well" if known.issuperset(confused) else ""
        told += f". It is easily confused with {_nearest_of(confused, rivals, cause.key)}{also}"
    return told + "."


def _nearest_of(confused: Sequence[str], rivals: Sequence[tuple[float, str]], key: str) -> str:
    """The effects that come nearest in the race, and how many there are beside them.

    Each is told in the form of the cause, if it has that one: what lies below is confused with the
    lower limit of a sensor.
    """
    reached: dict[str, float] = {}
    for delta, rival in rivals:
        plain = rival.split(".")[0]
        reached[plain] = max(delta, reached.get(plain, -math.inf))
    nearest = sorted(confused, key=lambda name: -reached.get(name, -math.inf))
    form = key.partition(".")[2]
    alike = {name: f"{name}.{form}" if f"{name}.{form}" in EFFECTS else name for name in nearest}
    told = [title_of(alike[name]) for name in nearest[:MOST_CONFUSED]]
    if (more := len(nearest) - len(told)) > 0:
        told.append(f"{more} more" if more > 1 else title_of(alike[nearest[-1]]))
    return listed(told)


def _has_other_forms(cause: Cause, evidence: Sequence[Evidence]) -> bool:
    """Whether another form of a cause's law was refitted beside it."""
    return any(
        e.round == cause.round
        and e.delta_bic is not None
        and e.effect.split(".")[0] == cause.effect
        and e.effect != cause.key
        for e in evidence
    )
