"""Small parts of the sentences in which a diagnosis is told."""

from __future__ import annotations

import math
from collections.abc import Sequence

from softid.diagnosis.verdict.equivalence import classes_of
from softid.diagnosis.verdict.naming import EXPLAINED, carries_over_whole, explains_enough
from softid.diagnosis.verdict.unlisted_names import UNLISTED
from softid.diagnosis_results import CARRIED, NOTABLE, Cause, Doubt, NotNoise, Remainder
from softid.effects import EFFECTS, confusable_with
from softid.interval_words import value_in_words
from softid.results import ParameterEstimate
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

PREDICTORS = "the motion, the input and the time"
"""What a residual is predicted from."""

TOLD_VARIATION = 0.01
"""A variation is told with its size from this share on."""

UNLIKE_NOISE = {
    NotNoise.GROWS_WITH_SPEED: "it is larger where the motion is quick",
    NotNoise.STRAYS: "it strays too far",
    NotNoise.SPECTRUM: "it comes in waves",
}
"""What speaks against noise that wanders slowly."""

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
    Doubt.DISPLACES: "moves as the actuator itself does, of whose own motion nothing is left",
    Doubt.ACTS_BEHIND: "acts behind that motion, as a nonlinear sensor does",
    Doubt.DWARFED: "may be what the law of a larger cause leaves, as small as it is",
    Doubt.ONE_STEP: "is not told from other slow or nonlinear laws by a single step",
    Doubt.FAST_NOISE: "would have taken fast noise away, which is there",
    Doubt.MENDS: "may be a piece of one law of another form, for more than noise is left beside it",
}
"""Why a description is no cause, after its title; the others are told by sentences of their own."""

OF_INPUT = 0.1
"""Share of the power of what is left from which on the noise of the input is told."""

LOUDER = 0.05
"""A rest is called noise with a reserve when its power is so much above that of the noise."""

MOST_VARIABLES = 2
"""Most variables that a sentence names."""

MOST_PARAMETERS = 3
"""Most parameters that a sentence names."""

FEWEST_DIGITS = 3
"""Significant digits of a value in a sentence, unless its interval asks for more."""


def variables_left(remainder: Remainder) -> list[str]:
    """The variables that predict most of what is left; none where chance does as well."""
    if not remainder.predictable:
        return []
    ranked = sorted(remainder.by.items(), key=lambda item: -item[1])
    return [k for k, share in ranked if share > NOTABLE][:MOST_VARIABLES]


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


def listed(parts: Sequence[str], *, last: str = " and ") -> str:
    """Parts joined as in a sentence."""
    return last.join(filter(None, (", ".join(parts[:-1]), parts[-1]))) if parts else ""


def told_apart(parts: Sequence[str]) -> str:
    """Parts of which one is told from the others.

    Examples
    --------
    >>> told_apart(["a", "b"]), told_apart(["a", "b", "c"])
    ('a from b', 'a, b and c apart')
    """
    return " from ".join(parts) if len(parts) < 3 else f"{listed(parts)} apart"


def lowered(text: str) -> str:
    """The text with a small first letter."""
    return text[:1].lower() + text[1:]


def sentence(text: str) -> str:
    """The text with a capital letter and a full stop."""
    return f"{text[:1].upper()}{text[1:]}."


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


def structure_of_rest(remainder: Remainder) -> str:
    """How much of what is left is predicted, beside what chance reaches."""
    share, limit = percent(remainder.structure_share), percent(max(remainder.structure_limit, 0.0))
    if remainder.structure_share <= max(remainder.structure_limit, 0.0):
        return f"no more of it follows from {PREDICTORS} than chance would make of noise"
    if share == percent(0.0):
        return f"less than 1 % of its power follows from {PREDICTORS}, though more than by chance"
    return f"{share} of its power follows from {PREDICTORS}, where chance reaches {limit}"


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


def unsteady(cause: Cause) -> str:
    """That the size of a cause is not the same throughout; nothing where it is.

    Parameters
    ----------
    cause
        A cause or a description.
    """
    if cause.variation is None:
        return ""
    spread = cause.variation.spread
    size = f"by about {percent(spread)}" if spread > TOLD_VARIATION else "a little"
    return (
        f"The size of {lowered(cause.title)} is not the same throughout: it varies {size} "
        f"with {VARIABLE_WORDS[cause.variation.by]}, so its law is not exactly this one."
    )


def nature_of_rest(remainder: Remainder) -> str:
    """What is left: slow noise, a steady line, or noise, and how much louder than the known noise.

    Parameters
    ----------
    remainder
        What is left.
    """
    if remainder.colour_s is not None:
        return (
            "is more than the noise between neighbouring samples but has the marks of slow noise "
            f"with a correlation time of {remainder.colour_s:.2g} s"
            f"{with_open_moments(remainder.open_jumps)}: it is steady, normal and no larger where "
            f"the motion is quick{_of_input(remainder)}. No long rest shows the noise alone, so a "
            "slow misfit could hide in it"
        )
    if remainder.is_a_line:
        return f"is no noise: {percent(remainder.line_share)} of its power is one steady line"
    told = f"looks like noise{with_open_moments(remainder.open_jumps)}{_of_input(remainder)}"
    if remainder.excess <= LOUDER:
        return told
    what = known_noise(remainder) or "noise in its fastest part"
    return f"{told}, though its power is {percent(remainder.excess)} above that of {what}"


def _of_input(remainder: Remainder) -> str:
    """Which part of what is left the input makes; nothing where that is little."""
    if remainder.input_noise <= OF_INPUT:
        return ""
    whose = "what is not known" if remainder.input_course > 0.0 else "that"
    return f", a part of it {whose} of the input ({percent(min(remainder.input_noise, 1.0))})"


def known_noise(remainder: Remainder) -> str | None:
    """What told the noise, where it was not the residual itself."""
    if remainder.noise_from_rounding:
        return "the rounding of the reading"
    return "the noise of the rests" if remainder.noise_from_rest else None


def what_is_unknown(remainder: Remainder) -> str:
    """The first sentence where no cause is named: slow noise is possible where nothing excludes it.

    Parameters
    ----------
    remainder
        What is left.
    """
    may_be_noise = not (
        remainder.noise_is_known
        or remainder.predictable
        or remainder.against_noise
        or remainder.explained_share > 0.0
        or remainder.is_a_line
    )
    opening = (
        "Something is missing, or the noise is slow" if may_be_noise else "Something is missing"
    )
    return f"{opening}, and none of the effects tried can be named for it."


def what_it_may_be(remainder: Remainder) -> str:
    """What a residual may be that is larger than the fast noise and follows from nothing.

    Parameters
    ----------
    remainder
        What is left, where no rest shows the noise.
    """
    if remainder.against_noise is None:
        return (
            "a law with a memory, a disturbance or slow noise, for no long rest shows how large "
            "that noise is"
        )
    return (
        "a law with a memory or a disturbance rather than slow noise, for "
        f"{UNLIKE_NOISE[remainder.against_noise]}; a rest of 30 s would show that noise"
    )


def with_open_moments(count: int) -> str:
    """End of a sentence: that something holds once the moments of jumps are free; else empty.

    Parameters
    ----------
    count
        Number of jumps.
    """
    if count == 0:
        return ""
    what, verb = ("moment of a jump", "is") if count == 1 else (f"moments of {count} jumps", "are")
    return f", once the {what} of the input between two samples {verb} left open"
