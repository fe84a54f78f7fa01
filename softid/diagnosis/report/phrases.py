"""Small parts of the sentences in which a diagnosis is told."""

from __future__ import annotations

import math
from collections.abc import Sequence

from softid.diagnosis.verdict.equivalence import classes_of
from softid.diagnosis.verdict.naming import EXPLAINED, carries_over_whole, explains_enough
from softid.diagnosis.verdict.unlisted_names import UNLISTED
from softid.diagnosis_results import CARRIED, Cause, Doubt, Remainder
from softid.effects import EFFECTS, confusable_with
from softid.interval_words import value_in_words
from softid.results import ParameterEstimate
from softid.sentences import listed, lowered, sentence
from softid.uncertainty.profile import CI_METHOD as PROFILE

VARIABLE_WORDS = {
    "x": "the position",
    "v": "the speed",
    "p": "the input",
    "rate of p": "the rate of the input",
    "lagged p": "the input a while before",
    "t": "the time",
    "x and v": "position and speed together",
}
"""What `Remainder.by` names, within a sentence."""

VARIATIONS = {
    "x": "more positions over the whole range",
    "v": "slower and faster moves",
    "p": "more levels of the input",
    "rate of p": "slower and faster changes of the input",
    "lagged p": "holds of several lengths",
    "x and v": "every position passed at several speeds",
}
"""What would show a dependence on each of the `VARIABLE_WORDS` better."""

TOLD_VARIATION = 0.01
"""A variation is told with its size from this share on."""

DOUBTS = {
    Doubt.GAINS_NOTHING: "does not lower the error on what is held out by 1 %",
    Doubt.MAY_GAIN_NOTHING: "is not confirmed by what is held out, where the interval of its gain "
    "holds a loss",
    Doubt.DOES_NOT_OCCUR: "leaves no trace in what is held out, so what it gains is not known: "
    "hold out a log that has it, too",
    Doubt.UNKNOWN_SIZE: "gains little, and not even the order of magnitude of its size is known",
    Doubt.TOO_SLOW: "may be slower than these logs can tell",
    Doubt.TOO_QUICK: "is over within a tenth of a sampling interval, whose course is not on record",
    Doubt.MAY_BE_ZERO: "may as well have a size of zero",
    Doubt.CANCELS: "nearly cancels another of these laws: both leave the shape of a third",
    Doubt.DISPLACES: "has taken over the time constants of the actuator, which has none left",
    Doubt.ACTS_BEHIND: "acts behind the whole motion, as a nonlinear sensor does",
    Doubt.DWARFED: "may be what the law of a larger cause leaves, as small as it is",
    Doubt.ONE_STEP: "is not told from other slow or nonlinear laws by a single step",
    Doubt.FAST_NOISE: "would have taken fast noise away, which is there",
    Doubt.MENDS: "may be a piece of one law of another form, for more than noise is left beside it",
}
"""Why a description is no cause, after its title; the others are told by sentences of their own."""

MOST_PARAMETERS = 3
"""Most parameters that a sentence names."""

FEWEST_DIGITS = 3
"""Significant digits of a value in a sentence, unless its interval asks for more."""


def title_of(key: str) -> str:
    """The heading of an effect within a sentence."""
    if key not in EFFECTS:
        return UNLISTED.get(key, key)
    return lowered(EFFECTS[key].title)


def titles_of(effects: Sequence[str], *, last: str = " and ") -> str:
    """The headings of several effects within a sentence."""
    return listed([title_of(name) for name in effects], last=last)


def neighbours_of(key: str) -> tuple[str, ...]:
    """Names of the effects that one is easily confused with."""
    return confusable_with(EFFECTS[key]()) if key in EFFECTS else ()


def named_whole(cause: Cause, *, linear: bool) -> str:
    """The heading, or all members of the class that no log of such a model can split."""
    for known in classes_of([cause.key], linear=linear):
        return listed(known.members, last=" or ")
    return lowered(cause.title)


def told_apart(parts: Sequence[str]) -> str:
    """Parts of which one is told from the others.

    Examples
    --------
    >>> told_apart(["a", "b"]), told_apart(["a", "b", "c"])
    ('a from b', 'a, b and c apart')
    """
    return " from ".join(parts) if len(parts) < 3 else f"{listed(parts)} apart"


def percent(value: float) -> str:
    """A share in per cent."""
    return f"{100.0 * value:.0f} %"


def percent_below(value: float, bound: float) -> str:
    """A share in per cent, with a decimal where it would read like the bound that it is below."""
    told = percent(value)
    if value >= bound or told != percent(bound):
        return told
    return f"{math.floor(1000.0 * value) / 10.0:.1f} %"


def percent_range(interval: tuple[float, float]) -> str:
    """An interval of shares in per cent; a lower end below −1 is as good as none."""
    low = f"{100.0 * interval[0]:z.0f}" if interval[0] >= -1.0 else "unknown up"
    return f"{low} to {100.0 * interval[1]:z.0f} %"


def values_of(parameters: Sequence[ParameterEstimate]) -> str:
    """The first parameters with their intervals; those that only count together as so many."""
    open_ones = [p for p in parameters if _is_open_within(p) and p.ci_method != PROFILE]
    together = len(open_ones) > 1
    shown = [p for p in parameters if not (together and p in open_ones)]
    told = [_value(p) for p in shown[:MOST_PARAMETERS]]
    if (more := len(shown) - len(told)) > 0:
        told.append(f"{more} more parameter{'s' if more > 1 else ''}")
    if together:
        told.append(
            f"{len(open_ones)} values of which none is known by itself, for the model's own curve "
            "can make up for each"
        )
    return listed(told) if told else "parameters that could not be told"


def _is_open_within(p: ParameterEstimate) -> bool:
    """Whether the interval of a value reaches both of its bounds."""
    if p.ci95 is None or p.lower is None or p.upper is None:
        return False
    return p.ci95[0] <= p.lower and p.ci95[1] >= p.upper


def _value(p: ParameterEstimate) -> str:
    name = p.name
    for key in sorted(EFFECTS, key=len, reverse=True):
        name = p.name.removeprefix(f"{key}_")
        if name != p.name:
            break
    if _is_open_within(p):
        unit = "" if p.unit == "1" else f" {p.unit}"
        return (
            f"{name}, which is not known within its bounds of {p.lower:.3g} to {p.upper:.3g}{unit}"
        )
    bound = ", at its bound" if p.at_bound else ""
    return f"{name} = {value_in_words(p, fewest_digits=FEWEST_DIGITS)}{bound}"


TOO_LITTLE = (
    "which is too little for a name: a cause that leaves some of the misfit unexplained is named "
    f"only if it takes away {percent(EXPLAINED)} or more of it"
)
"""Why a description that takes away much is no cause."""


def taken_by(remainder: Remainder) -> str:
    """How much of the misfit goes, and why that names no cause."""
    fitted, held_out = remainder.explained_share, remainder.held_out_share
    taken = f"{percent_below(fitted, EXPLAINED)} of the misfit above the noise"
    if not remainder.carries_over and (fitted > CARRIED or held_out < CARRIED * fitted):
        held = percent(held_out)
        return f"{taken} on the fitted samples but {held} on those held out: it does not carry over"
    if not carries_over_whole(remainder):
        held = percent_below(held_out, EXPLAINED)
        return f"{taken} on the fitted samples and {held} on those held out, {TOO_LITTLE}"
    if not remainder.carries_over or not explains_enough(remainder):
        return f"{taken}, {TOO_LITTLE}"
    return f"{taken}, but not surely enough for a name"


def given_up(dropped: Sequence[str]) -> str:
    """What does not carry over from log to log; nothing where all does.

    Parameters
    ----------
    dropped
        From `dropped_from`.
    """
    if not dropped:
        return ""
    verb, them = ("does", "it") if len(dropped) == 1 else ("do", "them")
    return (
        f"Its {listed(dropped)} {verb} not carry over to logs that are left out, so what follows "
        f"extends the model without {them}."
    )


def doubts_about(causes: Sequence[Cause]) -> list[str]:
    """Why descriptions are no causes, in sentences; what is true of all of them is said once.

    Parameters
    ----------
    causes
        The descriptions.
    """
    reasons = {DOUBTS.get(cause.doubt) if cause.doubt is not None else None for cause in causes}
    (reason, *others) = reasons or {None}
    if len(causes) > 1 and not others and reason is not None:
        return [sentence(f"each of them {reason}")]
    return [told for told in map(doubt_about, causes) if told]


def doubt_about(cause: Cause) -> str:
    """Why a description is no cause, in a sentence; none where that lies in what it leaves.

    Parameters
    ----------
    cause
        The description.
    """
    reason = DOUBTS.get(cause.doubt) if cause.doubt is not None else None
    told = sentence(f"{lowered(cause.title)} {reason}") if reason else ""
    varies = unsteady(cause)
    return varies if cause.doubt is Doubt.VARIES else told or at_bounds(cause) or varies


def at_bounds(cause: Cause) -> str:
    """That a description ends at a bound, which is why it is no more than one.

    Parameters
    ----------
    cause
        The description.
    """
    stuck = [p.name.removeprefix(f"{cause.effect}_") for p in cause.parameters if p.at_bound]
    if not stuck:
        return ""
    verb, its = ("ends", "its bound") if len(stuck) == 1 else ("end", "their bounds")
    return (
        f"The {listed(stuck)} of {lowered(cause.title)} {verb} at {its}, so something else may "
        "stand behind it."
    )


def unsteady(cause: Cause, size_of_it: str | None = None) -> str:
    """That the size of a cause is not the same throughout; nothing where it is.

    A spread that leaves a cause its name may come of noise that is not known well enough.

    Parameters
    ----------
    cause
        A cause or a description.
    size_of_it
        What the size is called; None for the name of the cause.
    """
    if cause.variation is None:
        return ""
    spread = cause.variation.spread
    size = f"by about {percent(spread)}" if spread > TOLD_VARIATION else "a little"
    differs = "is not" if cause.doubt is Doubt.VARIES else "may not be"
    return sentence(
        f"{size_of_it or f'the size of {lowered(cause.title)}'} varies {size} with "
        f"{VARIABLE_WORDS[cause.variation.by]}, so its law {differs} exactly this one"
    )
