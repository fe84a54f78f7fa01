"""Which links of a chain may be named as causes, and which verdict follows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from softid.chi_square import chi_square_tail
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis.verdict.chain_consistency import may_hold_more
from softid.diagnosis_results import Cause, Doubt, Remainder, Verdict
from softid.effects import extended_name
from softid.effects.base import Effect
from softid.results import FitResult, ParameterEstimate

EXPLAINED = 0.93
"""Share of the misfit that the causes must explain when something is left."""

LEAST_EXPLAINED = 0.6
"""Measured logs hold small disturbances that no law takes away, which a drive without a spring even
adds up. Where the rest follows from nothing that moves, causes may be named from this explained
share on."""

DOMINANT = 0.3
"""Least share of the misfit that each cause takes away by itself where a rest follows from nothing
that moves."""

LEAST_JOINT_GAIN = 0.5
"""Least share of the error on what is held out that all causes take away together where a rest
follows from nothing that moves."""

LEAST_GAIN = 0.01
"""Share of the held-out error that a cause takes away at least, and a chain of them, too."""

SLIGHT_GAIN = 0.1
"""A cause that takes away less than this share of the held-out error gains slightly."""

BARELY = 0.1
"""Share of a gain to which the ends of its interval are known: a log of steps makes few blocks."""

UNKNOWN_SIZE = 30.0
"""A cause of slight gain is not named when the upper end of its size's interval is more than so
many times the lower one, or the lower one is not above zero: it is the last corner of a law that
another one fits. Nor is any other whose size trades so with a parameter that has run into its upper
bound: only that corner of its law is like what the log holds."""

NO_EFFECT = 0.05
"""Zero sizes that are no less likely than this are no effect."""

VARIES = 0.03
"""Share of what a cause takes away that letting its size vary takes away beside it from which on it
is another cause: its own size has settled between what the log asks for here and there."""

VARIES_BESIDE = 0.1
"""Share of what a cause takes away that letting its size vary takes away beside it from which on it
is another cause, where something else is left, whose law the size may follow a little."""

SAME_SIZE = 0.05
"""A size whose standard deviation throughout the logs is a smaller share of it is the same: beside
parameters that share a scale with it, as those of a muscle with another static curve do, next to
nothing is the cause's own, and any trace of another law would be much of that."""

SHORT_OF = 0.001
"""A value that is short of its upper bound by so small a share lies on it: where it hardly matters,
a fit ends a little before."""

LEAST_EIGENVALUE = 1e-14
"""Variances below this share of the largest are not told from it by the covariance's digits."""


def explains_enough(remainder: Remainder) -> bool:
    """Whether a chain leaves noise, or next to nothing of the misfit, on the fitted samples.

    Parameters
    ----------
    remainder
        What it leaves.
    """
    return not remainder.structured or remainder.explained_share > EXPLAINED


def carries_over_whole(remainder: Remainder) -> bool:
    """Whether next to nothing of the misfit is left on what is held out.

    Parameters
    ----------
    remainder
        What a chain leaves.
    """
    return not remainder.misses_held_out or remainder.held_out_share > EXPLAINED


def nameable(
    links: Sequence[Link],
    final: Candidate,
    remainder: Remainder,
    *,
    gain: float,
    of_tie: Remainder | None = None,
    is_another: Callable[[], bool] = lambda: False,
) -> tuple[bool, ...]:
    """Which links may be named as causes; the others are descriptions.

    What is held out may speak for another member of a tie, which then is the one to carry over. It
    does not speak against any where it is of another actuator and a chain leaves noise elsewhere.

    Parameters
    ----------
    links
        The chain.
    final
        The model with all of them.
    remainder
        What it leaves.
    gain
        Share by which the error on what is held out falls.
    of_tie
        The remainder with what the member of a tie leaves there that errs least; None without one.
    is_another
        Whether what is held out differs in a number of the actuator; asked where it is not
        explained whole.
    """
    carries_over = remainder.carries_over and carries_over_whole(of_tie or remainder)
    if links and not carries_over:
        return (not remainder.structured and is_another(),) * len(links)
    if explains_enough(remainder):
        return (True,) * len(links)
    if (
        remainder.predictable
        or remainder.explained_share <= LEAST_EXPLAINED
        or gain < LEAST_JOINT_GAIN
    ):
        return (False,) * len(links)
    squares = [*(link.left_before for link in links), final.squares]
    return tuple(before - after >= DOMINANT * squares[0] for before, after in pairwise(squares))


def gains_by(cause: Cause, whole: float) -> bool:
    """Whether a cause lowers the held-out error, beside those before it or beside all others.

    Where a motion integrates its force, the first of two causes may make the error larger by
    itself and yet be what the second cannot do without.

    Parameters
    ----------
    cause
        The cause with its held-out errors.
    whole
        That of the model with all causes.
    """
    most = 1.0 - LEAST_GAIN
    if cause.holdout_rmse_after <= most * cause.holdout_rmse_before:
        return True
    without = cause.holdout_rmse_without
    return without is not None and whole <= most * without


def may_gain_nothing(cause: Cause) -> bool:
    """Whether the interval of the gain holds a loss, and no other cause is known to need this one.

    That of a gain that is not slight must hold one larger than such an interval is known to.

    Parameters
    ----------
    cause
        The cause with its held-out errors.
    """
    if cause.gain_ci95 is None or cause.holdout_rmse_without is not None:
        return False
    gain = 1.0 - cause.holdout_rmse_after / cause.holdout_rmse_before
    return gain <= 0.0 or cause.gain_ci95[0] < (-BARELY * gain if gain > SLIGHT_GAIN else 0.0)


def asks_for_the_others(cause: Cause, effect: Effect) -> bool:
    """Whether what a cause gains beside those before it leaves its name open.

    What the others leave without it decides then.

    Parameters
    ----------
    cause
        The cause with its parameters and its held-out errors.
    effect
        Its effect.
    """
    if not gains_by(cause, np.inf) or may_gain_nothing(cause):
        return True
    return not effect.changes_sign and _is_slight(cause, np.inf) and _is_unknown(cause, effect)


def most_variation(remainder: Remainder) -> float:
    """How much letting its size vary may take away beside what a cause takes away.

    Parameters
    ----------
    remainder
        What all causes leave.
    """
    something_else = (
        remainder.structured or remainder.open_jumps > 0 or remainder.colour_s is not None
    )
    return VARIES_BESIDE if something_else else VARIES


def doubt_of(
    cause: Cause, effect: Effect, extended: FitResult, whole: float, *, varies: float = VARIES
) -> Doubt | None:
    """Why the numbers of a cause do not allow its name; None where they do.

    It must take away a hundredth of the held-out error at least, and surely something where it is
    judged by that alone, with a size that is the same throughout. Where its size may have either
    sign, an interval over zero is no effect, and a size at its bound stands for something else; so
    does a time of a relaxation: at its shortest it is a damper, and a drift at its longest, or if
    its interval reaches that; so does a place of which nothing is known; and so does a speed at
    which friction has come up when it is as large as the motion's own.
    Several sizes, such as the knots of a curve, are judged together: one of them may be as good as
    unknown beside the base's own parameters, or run into its bound with their common slope, and
    their shape well known.

    Parameters
    ----------
    cause
        The cause with its parameters and its held-out error.
    effect
        Its effect.
    extended
        The fit with all causes, for the covariance of the sizes.
    whole
        Held-out error of the model with all causes.
    varies
        From `most_variation`.
    """
    if not gains_by(cause, whole):
        return Doubt.GAINS_NOTHING
    if may_gain_nothing(cause):
        return Doubt.MAY_GAIN_NOTHING
    variation = cause.variation
    if variation is not None and variation.share > varies and variation.spread > SAME_SIZE:
        return Doubt.VARIES
    if not effect.changes_sign and _is_unknown(cause, effect):
        if _is_slight(cause, whole):
            return Doubt.UNKNOWN_SIZE
        sizes = {extended_name(effect, name) for name in effect.amplitudes}
        if any(_is_at_ceiling(p) for p in cause.parameters if p.name not in sizes):
            return Doubt.AT_BOUND
    return _doubt_of_values(cause, effect, extended)


DOUBTS_OF_BEING = (
    Doubt.GAINS_NOTHING,
    Doubt.MAY_GAIN_NOTHING,
    Doubt.DOES_NOT_OCCUR,
    Doubt.MAY_BE_ZERO,
    Doubt.UNKNOWN_SIZE,
    Doubt.TOO_QUICK,
)
"""Doubts whether there is anything in the actuator; the others are whether it is this."""


def may_be_chance(descriptions: Sequence[Cause]) -> bool:
    """Whether there may be nothing behind any of the descriptions.

    Parameters
    ----------
    descriptions
        What may not be named.
    """
    return all(cause.doubt in DOUBTS_OF_BEING for cause in descriptions)


def _doubt_of_values(cause: Cause, effect: Effect, extended: FitResult) -> Doubt | None:
    """What speaks against a cause among the values of its parameters."""
    names = {extended_name(effect, name) for name in effect.amplitudes if effect.changes_sign}
    sizes = [p for p in cause.parameters if p.name in names]
    ceilings, floors = (
        {extended_name(effect, name) for name in names}
        for names in (effect.ceilings, effect.floors)
    )
    essential = {extended_name(effect, name) for name in effect.essential}
    held = [p for p in cause.parameters if p.name in essential]
    bounded = any(p.at_bound for p in (held if len(sizes) > 1 else (*sizes, *held)))
    bounded = bounded or any(_is_anywhere(p) for p in held)
    low = [p for p in cause.parameters if p.name in floors]
    bounded = bounded or any(p.at_bound or _reaches_lower(p) for p in low)
    if any(p.unit == "s" and (_reaches_upper(p) or _is_at_ceiling(p)) for p in held):
        return Doubt.TOO_SLOW
    if bounded or any(_is_at_ceiling(p) for p in cause.parameters if p.name in ceilings):
        return Doubt.AT_BOUND
    zero = _covers_zero(sizes[0]) if len(sizes) == 1 else _cover_zero_together(sizes, extended)
    return Doubt.MAY_BE_ZERO if zero else None


def _is_slight(cause: Cause, whole: float) -> bool:
    """Whether a cause gains little on what is held out, beside those before it or all others."""
    most, without = 1.0 - SLIGHT_GAIN, cause.holdout_rmse_without
    if without is not None and whole <= most * without:
        return False
    return cause.holdout_rmse_after > most * cause.holdout_rmse_before


def _is_unknown(cause: Cause, effect: Effect) -> bool:
    """Whether not even the order of magnitude of its size is known."""
    names = {extended_name(effect, name) for name in effect.amplitudes}
    intervals = [p.ci95 for p in cause.parameters if p.name in names and p.ci95 is not None]
    return any(high > UNKNOWN_SIZE * max(low, 0.0) for low, high in intervals)


def _is_at_ceiling(parameter: ParameterEstimate) -> bool:
    """Whether a value lies on its upper bound."""
    value, upper = parameter.value, parameter.upper
    return upper is not None and 0.0 < upper < np.inf and value >= (1.0 - SHORT_OF) * upper


def _reaches_upper(parameter: ParameterEstimate) -> bool:
    """Whether the interval of a value holds its upper bound."""
    interval, upper = parameter.ci95, parameter.upper
    return interval is not None and upper is not None and interval[1] >= upper


def _reaches_lower(parameter: ParameterEstimate) -> bool:
    """Whether the interval of a value holds its lower bound."""
    interval, lower = parameter.ci95, parameter.lower
    return interval is not None and lower is not None and interval[0] <= lower


def _is_anywhere(parameter: ParameterEstimate) -> bool:
    """Whether the interval of a value holds both of its bounds."""
    return _reaches_lower(parameter) and _reaches_upper(parameter)


def _covers_zero(parameter: ParameterEstimate) -> bool:
    return parameter.ci95 is not None and parameter.ci95[0] <= 0.0 <= parameter.ci95[1]


def _cover_zero_together(sizes: Sequence[ParameterEstimate], extended: FitResult) -> bool:
    """Whether zero lies in the 95 % region of Wald, z' C⁻¹ z, of all sizes at once."""
    if not sizes:
        return False
    rows = [extended.free.index(p.name) for p in sizes if p.name in extended.free]
    if extended.covariance is None or len(rows) < len(sizes):
        return all(_covers_zero(p) for p in sizes)
    z = np.array([p.value for p in sizes])
    variances, axes = np.linalg.eigh(extended.covariance[np.ix_(rows, rows)])
    least = max(LEAST_EIGENVALUE * float(variances[-1]), np.finfo(float).tiny)
    distance = float(np.sum((axes.T @ z) ** 2 / np.maximum(variances, least)))
    return chi_square_tail(distance, len(sizes)) > NO_EFFECT


def verdict_of(
    links: Sequence[Link],
    is_named: Sequence[bool],
    remainder: Remainder,
    causes: Sequence[Cause] = (),
) -> Verdict:
    """The answer that the links and the remainder allow.

    A cause whose size is not the same throughout is one in part only where more than noise may be
    left.

    Parameters
    ----------
    links
        The chain.
    is_named
        Which of them may be named.
    remainder
        What it leaves.
    causes
        Its causes with their variations, one for every link; without them none is known to vary.
    """
    if not links:
        return Verdict.UNKNOWN if remainder.leaves_something else Verdict.ADEQUATE
    if not any(is_named):
        return Verdict.UNKNOWN
    if any(len(link.rivals) > 1 for link, named in zip(links, is_named, strict=True) if named):
        return Verdict.AMBIGUOUS
    told = list(zip(causes, is_named, strict=True)) if causes else []
    varies = any(cause.variation is not None and stays for cause, stays in told)
    is_in_part = remainder.leaves_something or (varies and may_hold_more(remainder))
    return Verdict.PARTIAL if is_in_part else Verdict.NAMED
