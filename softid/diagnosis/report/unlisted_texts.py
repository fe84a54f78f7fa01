"""What is said of laws in no catalogue that account for a misfit."""

from __future__ import annotations

from softid.diagnosis.report.held_excitation import is_held
from softid.diagnosis.report.phrases import percent
from softid.diagnosis.verdict.beyond_catalogue import BeyondCatalogue
from softid.diagnosis.verdict.unlisted_laws import OF_LINEAR
from softid.diagnosis.verdict.unlisted_loads import SwingingLoad
from softid.diagnosis.verdict.unlisted_names import UNLISTED
from softid.diagnosis.verdict.unlisted_pneumatics import RateLimit
from softid.diagnosis.verdict.unlisted_positions import PositionInertia
from softid.diagnosis.verdict.unlisted_readings import SwingingPart
from softid.effects.base import Effect
from softid.errors import Issue
from softid.sentences import listed, lowered

UNLISTED_LAW, LIKE_UNLISTED_LAW = "unlisted-law", "like-unlisted-law"
"""Codes of the remark that a law in no catalogue accounts for a misfit, or for most of it."""

LAW_BESIDE = "unlisted-law-beside"
"""Code of the remark that one accounts for what causes or descriptions leave."""

SWINGING = (SwingingLoad, SwingingPart)
"""Laws of which the period is told."""

MOST_LAWS = 3
"""Most laws of no catalogue that a sentence names."""

WHAT_IS_LEFT = "what is left "
"""How that remark begins."""


def unlisted_issue(
    found: BeyondCatalogue,
    *,
    of_rest: bool = False,
    is_tied: bool = False,
    held: frozenset[str] = frozenset(),
) -> Issue:
    """Laws in no catalogue that account for a misfit, in words.

    Parameters
    ----------
    found
        The laws.
    of_rest
        Whether they were asked about what causes leave, and not about the whole misfit.
    is_tied
        Whether the best is told as what may stand in the place of a cause already.
    held
        Experiments that the logs hold, from `held_experiments`.
    """
    causes = listed([lowered(effect.title) for effect in found.beside])
    together = f"{causes} together with " if causes and not of_rest else ""
    take = "take" if together else "takes"
    what = WHAT_IS_LEFT if of_rest else "what is missing "
    what += "speaks for " if is_tied else f"behaves like {together}a law in no catalogue, "
    whole = UNLISTED_LAW if found.is_whole else LIKE_UNLISTED_LAW
    return Issue(
        LAW_BESIDE if of_rest else whole,
        "info",
        f"{what}{_laws_of(found)}, which {take} away {percent(found.share)} of "
        f"{'it' if of_rest else 'the misfit'} above the noise, and "
        f"{percent(found.held_out_share)} on what is held out",
        _to_see_it(found.laws[0], held),
    )


def _to_see_it(law: Effect, held: frozenset[str]) -> str:
    """Where a law in no catalogue would show: in an experiment, or on the rig if that was done."""
    elsewhere = f"{law.remedy}, or " if isinstance(law, OF_LINEAR) else ""
    if is_held(law.shown_by, held):
        return f"settle it on the rig, for these logs hold {law.shown_by} already: {law.remedy}"
    return f"{elsewhere}record {law.shown_by}, where it would show"


def _laws_of(found: BeyondCatalogue) -> str:
    """The laws in words, with the size of the first."""
    first, *others = [UNLISTED[law.name] for law in found.laws[:MOST_LAWS]]
    return listed([f"{first}{_size_of(found)}", *others], last=" or ")


def _size_of(found: BeyondCatalogue) -> str:
    """The size of the first law, where it has a single one, or the period of what swings."""
    if isinstance(found.laws[0], SWINGING):
        return f" (once in {next(value for value, unit in found.sizes if unit == 's'):.3g} s)"
    if len(found.sizes) != 1:
        return ""
    ((value, unit),) = found.sizes
    if unit == "1":
        what = "over" if isinstance(found.laws[0], PositionInertia) else "of"
        return f" ({100.0 * value:.2g} % {what} the range)"
    of_what = " for the whole range" if isinstance(found.laws[0], RateLimit) else ""
    return f" ({value:.3g} {unit}{of_what})"
