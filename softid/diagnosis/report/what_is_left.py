"""What a paragraph says of what is left: by the model, by descriptions, or by causes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from softid.diagnosis.report.ambiguity import WORTH_DOUBTS, are_alike
from softid.diagnosis.report.error_texts import ErrorTexts
from softid.diagnosis.report.phrases import (
    VARIABLE_WORDS,
    doubts_about,
    percent,
    percent_below,
    taken_by,
    title_of,
    titles_of,
)
from softid.diagnosis.report.rest_phrases import (
    BUT_A_LINE,
    PREDICTORS,
    known_noise,
    nature_of_rest,
    structure_of_rest,
    variables_left,
    what_is_unknown,
    what_it_may_be,
    with_open_moments,
)
from softid.diagnosis_results import NOTABLE, Alternative, Cause, Remainder
from softid.sentences import listed, lowered, sentence

NEXT_TO_NOTHING = 0.1
"""A description that takes away less of the misfit is not worth its name."""


@dataclass(frozen=True, eq=False)
class WhatIsLeft:
    """What is said of what is left.

    Attributes
    ----------
    teller
        Tells errors in the unit of the output.
    remainder
        What is left.
    alternatives
        Ties.
    is_told
        Whether a remark says what it is.
    has_line
        Whether a remark tells of a steady line in it.
    law
        What it does, as a law in no catalogue that takes most of it away; empty without one.
    """

    teller: ErrorTexts
    remainder: Remainder
    alternatives: Sequence[Alternative]
    is_told: bool
    has_line: bool
    law: str = ""

    @property
    def size(self) -> str:
        """The error that is left on the fitted samples."""
        return self.teller.size(self.remainder.rms)

    @property
    def nature(self) -> str:
        """What it looks like."""
        return nature_of_rest(self.remainder, has_line=self.has_line)

    def by_adequate(self, refused: Sequence[str]) -> list[str]:
        """Sentences where no effect explains more than chance.

        Parameters
        ----------
        refused
            Remarks on causes that explain more but cannot be claimed.
        """
        remainder = self.remainder
        chance = "None of the effects tried explains more of it than chance would."
        if refused:
            chance = "None of the effects tried can be claimed."
        if remainder.colour_s is not None:
            return [chance, f"What is left, {self.size} rms on the fitted samples, {self.nature}."]
        noise = (known_noise(remainder) or "noise") + (BUT_A_LINE if self.has_line else "")
        why = "it is no larger" if remainder.predictable else structure_of_rest(remainder)
        told = [
            chance,
            f"What is left, {self.size} rms on the fitted samples, looks like {noise}"
            f"{with_open_moments(remainder.open_jumps)}: {why}.",
        ]
        if not remainder.noise_is_known:
            told.append("No long rest shows the noise alone, so a slow misfit could hide in it.")
        return told

    def by_unknown(self, tried: Sequence[Cause], laws: Sequence[str]) -> list[str]:
        """Sentences where no cause is named.

        Parameters
        ----------
        tried
            The descriptions.
        laws
            Remarks on a law in no catalogue that accounts for most of the misfit: beside one,
            why descriptions that take away less are no causes is nobody's question.
        """
        remainder, told = self.remainder, [what_is_unknown(self.remainder)]
        told += map(sentence, laws)
        if tried and remainder.explained_share < NEXT_TO_NOTHING:
            share = percent(remainder.explained_share)
            told.append(
                f"No effect takes away more than {share} of the misfit of the fitted samples."
            )
        elif tried:
            if laws:
                return [*told, *self.beside_laws(tried)]
            names = listed([lowered(cause.title) for cause in tried])
            alone = f"The best description, {names}, takes"
            best = alone if len(tried) == 1 else f"The best descriptions, {names}, together take"
            told.append(f"{best} away {taken_by(remainder)}.")
            if remainder.explained_share >= WORTH_DOUBTS:
                told += doubts_about(tried)
                told += map(_not_told_apart, self.alternatives)
        if laws:
            return told
        if not remainder.structured:
            told.append(f"What is left on the fitted samples, {self.size} rms, {self.nature}.")
            return [*told, self.teller.more_held_out(remainder)]
        return [*told, self._more_than_noise()]

    def beside_laws(self, tried: Sequence[Cause]) -> list[str]:
        """What effects in the catalogue do beside laws in none, and what is against them.

        Parameters
        ----------
        tried
            The descriptions.
        """
        names = listed([lowered(cause.title) for cause in tried])
        takes = "takes" if len(tried) == 1 else "take"
        share, held_out = percent(self.remainder.explained_share), self.remainder.held_out_share
        held = percent(held_out) if held_out > 0.0 else "nothing"
        told = (
            f"Of the effects in the catalogue, {names} {takes} away {share} on the fitted samples, "
            f"and {held} on those held out."
        )
        return [told] if self.remainder.structured else [told, *doubts_about(tried)]

    def by_partial(self) -> list[str]:
        """The share that is explained, and what is left where that is more than noise."""
        remainder = self.remainder
        share = percent_below(remainder.explained_share, 1.0)
        explained = f"That is {share} of the misfit above the noise"
        if remainder.misses_held_out:
            explained += (
                f" on the fitted samples and {percent(remainder.held_out_share)} on those held out"
            )
        more = self.teller.more_held_out(remainder, is_tied=bool(self.alternatives))
        if remainder.structured:
            if remainder.misses_held_out:
                return [f"{explained}.", self._more_than_noise(), more]
            if remainder.explained_share >= 1.0 and remainder.predictable:
                return [self._more_than_noise(but="has no more power than the noise, yet ")]
            return [f"{explained}.", self._more_than_noise()]
        looks = f"What is left on the fitted samples, {self.size} rms, {self.nature}."
        return [f"{explained}.", looks, more]

    def by_named(self, instead: str = "") -> list[str]:
        """Sentences where causes leave noise.

        Parameters
        ----------
        instead
            What stands in the place of what is said of the held-out samples, if anything does.
        """
        looks = "does not follow from the motion" if self.is_told else self.nature
        told = f"What the fit leaves, {self.size} rms, {looks}."
        return [
            told,
            instead or self.teller.more_held_out(self.remainder, is_tied=bool(self.alternatives)),
        ]

    def _more_than_noise(self, but: str = "") -> str:
        """What is left, where that is more than noise, and what it may be unless that is told.

        What it follows is part of a law that takes it away.
        """
        remainder = self.remainder
        named = [VARIABLE_WORDS.get(name, name) for name in variables_left(remainder)]
        told = f"What is left, {self.size} rms on the fitted samples, {but}"
        if self.law:
            return f"{told}{self.law}."
        if remainder.predictable:
            told += f"is not noise: {structure_of_rest(remainder)}"
        elif remainder.is_a_line:
            told += self.nature
        elif remainder.structure_share > NOTABLE:
            share = percent(remainder.structure_share)
            told += (
                f"is larger than the noise; {share} of it follows from {PREDICTORS}, no more than "
                "chance would make of slow noise"
            )
        elif remainder.noise_is_known:
            told += "is larger than the noise"
            told += "" if self.is_told else ", but follows from no variable that was looked at"
        else:
            told += "is more than the noise between neighbouring samples"
            known = ", and follows from no variable that was looked at: "
            told += "" if self.is_told else known + what_it_may_be(remainder)
        return f"{told}; most of it from {listed(named)}." if named else f"{told}."


def _not_told_apart(tie: Alternative) -> str:
    first, *others = tie.keys
    rest = titles_of(others, last=" or ")
    if are_alike(tie):
        return f"These logs do not tell {title_of(first)} from {rest}."
    return (
        f"The lead of {title_of(first)} over {rest} is smaller than what all of them leave "
        "unexplained, so it does not say which."
    )
