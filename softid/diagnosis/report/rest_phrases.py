"""What is left by a model, in the words of a sentence: noise, a line, or more than either."""

from __future__ import annotations

from softid.diagnosis.report.phrases import percent
from softid.diagnosis_results import NOTABLE, NotNoise, Remainder

PREDICTORS = "the motion, the input and the time"
"""What a residual is predicted from."""

UNLIKE_NOISE = {
    NotNoise.GROWS_WITH_SPEED: "it is larger where the motion is quick",
    NotNoise.STRAYS: "it strays too far",
    NotNoise.SPECTRUM: "it comes in waves",
}
"""What speaks against noise that wanders slowly."""

OF_INPUT = 0.1
"""Share of the power of what is left from which on the noise of the input is told."""

LOUDER = 0.05
"""A rest is called noise with a reserve when its power is so much above that of the noise."""

BUT_A_LINE = " but for a steady line"
"""What is said of noise where a remark tells of a line in it."""

MOST_VARIABLES = 2
"""Most variables that a sentence names."""


def variables_left(remainder: Remainder) -> list[str]:
    """The variables that predict most of what is left; none where chance does as well."""
    if not remainder.predictable:
        return []
    ranked = sorted(remainder.by.items(), key=lambda item: -item[1])
    return [k for k, share in ranked if share > NOTABLE][:MOST_VARIABLES]


def structure_of_rest(remainder: Remainder) -> str:
    """How much of what is left is predicted, beside what chance reaches."""
    share, limit = percent(remainder.structure_share), percent(max(remainder.structure_limit, 0.0))
    if remainder.structure_share <= max(remainder.structure_limit, 0.0):
        return f"no more of it follows from {PREDICTORS} than chance would make of noise"
    if share == percent(0.0):
        return f"less than 1 % of its power follows from {PREDICTORS}, though more than by chance"
    return f"{share} of its power follows from {PREDICTORS}, where chance reaches {limit}"


def nature_of_rest(remainder: Remainder, *, has_line: bool = False) -> str:
    """What is left: slow noise, a steady line, or noise, and how much louder than the known noise.

    Parameters
    ----------
    remainder
        What is left.
    has_line
        Whether a remark tells of a steady line in it: that has no correlation time, and is not
        normal.
    """
    if remainder.colour_s is not None and has_line:
        return (
            "is more than the noise between neighbouring samples, and a steady line is in it; it "
            f"is no larger where the motion is quick{_of_input(remainder)}. No long rest shows the "
            "noise alone, so a slow misfit could hide in it"
        )
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
    told = "looks like noise" + (BUT_A_LINE if has_line else "")
    told += f"{with_open_moments(remainder.open_jumps)}{_of_input(remainder)}"
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
    or_else = ""
    if may_be_noise:
        or_else = ", or the noise is slow"
    elif remainder.misses_held_out and not remainder.structured:
        or_else = ", or parameters are off that the fitted logs hardly tell"
    return f"Something is missing{or_else}, and none of the effects tried can be named for it."


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
