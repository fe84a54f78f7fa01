"""Why causes are tied, and what to record next."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

from softid.diagnosis.report.phrases import VARIATIONS, title_of, titles_of
from softid.diagnosis.report.rest_phrases import variables_left
from softid.diagnosis.report.splits import split_in_words, why_tied_here
from softid.diagnosis.residual.disturbances import CODES
from softid.diagnosis.search.contenders import INDISTINCT
from softid.diagnosis.verdict.equivalence import (
    LIKELIER,
    LINEAR_FILTERS,
    PRESLIDING,
    REPLACED,
    TWO_LAGS,
    TWO_LATE,
    TWO_RESONANCES,
    EquivalenceClass,
)
from softid.diagnosis.verdict.law_rivals import GIVES_WAY
from softid.diagnosis.verdict.laws_alike import LAWS_ALIKE, LOWER_END
from softid.diagnosis_results import Alternative, Cause, Diagnosis, Doubt, Remainder, Verdict
from softid.effects import EFFECTS
from softid.effects.scale import Scale
from softid.models import MODELS
from softid.results import FitResult
from softid.sentences import listed, lowered

MOST_TIED = 4
"""Most causes of a tie that a sentence names, the last among them, which may stand for others; the
record has all."""

BEST_OF_UNEQUAL = "The best, though it leads by less than all of them leave unexplained"
"""Beginning of a tie whose causes do not explain the logs equally well."""

WORTH_DOUBTS = 0.5
"""What is doubtful about a description, and what it is not told from, is said where it takes away
so much of the misfit."""

SPLITS = ". What splits them: "
"""Words between why causes are tied and what to record."""

SEVERAL_STEPS = "record several steps, up and down and to several levels, each held as long"
"""What tells the parameters of a model and its causes, where a single step does not."""


def is_linear(base: FitResult) -> bool:
    """Whether a model is linear with constant coefficients, whatever the input."""
    return MODELS[base.model.name].is_linear


def is_linear_beside(laws: Iterable[Cause], own: Collection[str], *, linear: bool) -> bool:
    """Whether a model is linear but for some of its causes, so that operations commute there.

    Parameters
    ----------
    laws
        All causes and descriptions.
    own
        Names of those that are left out.
    linear
        Whether the base model is linear.
    """
    others = (EFFECTS[law.key] for law in laws if law.effect not in own and law.key in EFFECTS)
    return linear and all(effect.is_linear for effect in others)


def with_presliding(
    ties: Sequence[Alternative], causes: Sequence[Cause], scale: Scale
) -> tuple[Alternative, ...]:
    """Ties of a hysteresis and dry friction with the law that both follow, where that makes them.

    Parameters
    ----------
    ties
        Ties, in numbers.
    causes
        The causes and descriptions of the same diagnosis.
    scale
        Sizes of the base fit.
    """
    gives_way = any(
        p.name == "hysteresis_zs" and p.value <= GIVES_WAY * scale.x_span
        for cause in causes
        for p in cause.parameters
    )
    both = set(PRESLIDING.effects)
    why = f"{PRESLIDING.why}{SPLITS}{PRESLIDING.splits}."
    return tuple(
        replace(tie, why=why) if gives_way and set(tie.effects) == both else tie for tie in ties
    )


def why_tied(
    alternative: Alternative,
    *,
    linear: bool,
    extended: FitResult | None = None,
    held: frozenset[str] = frozenset(),
) -> str:
    """Why causes are not told apart, and what would do it.

    Parameters
    ----------
    alternative
        The causes.
    linear
        Whether the model is linear but for these.
    extended
        The model with the causes: where their times may be the actuator's, its own are told.
    held
        Experiments that the logs hold, from `held_experiments`.
    """
    known = law_that_ties(alternative, linear=linear)
    if known is not None:
        own = own_times(known, extended) if extended is not None else ()
        here = f", here {listed(own)}" if own else ""
        return f"{known.why}{here}{SPLITS}{known.splits}."
    return why_tied_here(alternative.keys, held, alike=are_alike(alternative))


def with_reasons(found: Diagnosis, held: frozenset[str] = frozenset()) -> tuple[Alternative, ...]:
    """The ties of a diagnosis with why they are; words that one has already stay.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    held
        As in `why_tied`.
    """
    laws, linear = (*found.causes, *found.descriptive), is_linear(found.base)

    def reason(tie: Alternative) -> str:
        beside = is_linear_beside(laws, tie.effects, linear=linear)
        return tie.why or why_tied(tie, linear=beside, extended=found.extended, held=held)

    return tuple(replace(tie, why=reason(tie)) for tie in found.alternatives)


def told_as_tied(
    alternative: Alternative,
    title: str,
    *,
    linear: bool,
    earlier: Sequence[Alternative] = (),
    leaves_noise: bool = True,
) -> str:
    """The causes of a tie and what makes it, up to the values that the first would have.

    Parameters
    ----------
    alternative, linear
        As in `why_tied`.
    title
        Heading of the first.
    earlier
        Ties that are told before it: one law may stand in the place of all causes.
    leaves_noise
        Whether all causes leave no more than that: what explains more beside another misfit need
        not be likelier.
    """
    named, first = _first_and_last(alternative.keys), lowered(title)
    known = law_that_ties(alternative, linear=linear)
    *others, last = alternative.keys
    if known in LIKELIER and any(last == tie.keys[-1] for tie in earlier):
        return f"that law again, or {titles_of(others, last=' or ')}. As {first} it"
    is_likelier = leaves_noise and known in LIKELIER
    which = "most likely the last" if is_likelier else "and the logs do not say which"
    why, splits, _ = alternative.why.partition(SPLITS)
    if known is not None:
        reason = f"{why or known.why}. As {first} it"
    elif splits:
        reason = f"{why}. As {first} it"
    else:
        best = "The best by a little" if are_alike(alternative) else BEST_OF_UNEQUAL
        reason = f"{best}, {first},"
    return f"one of these, {which}: {named}. {reason}"


def _first_and_last(keys: Sequence[str]) -> str:
    """The causes of a tie as a sentence takes them: the first of many, their number, the last."""
    left_out = len(keys) - MOST_TIED
    if left_out < 2:
        return titles_of(keys, last=" or ")
    named = listed([title_of(key) for key in keys[: MOST_TIED - 1]], last=", ")
    return f"{named}, {left_out} more or {title_of(keys[-1])}"


def own_places(tie: Alternative, extended: FitResult) -> tuple[str, ...]:
    """What of a linear actuator may change places with what a cause of a tie has; else nothing.

    Parameters
    ----------
    tie
        The causes.
    extended
        The model with them.
    """
    known = law_that_ties(tie, linear=True)
    return () if known is None else own_times(known, extended)


def own_times(known: EquivalenceClass, extended: FitResult) -> tuple[str, ...]:
    """What of an actuator may change places with what a cause has, as numbers with units.

    Parameters
    ----------
    known
        `TWO_LAGS` or `TWO_RESONANCES`; nothing for any other class.
    extended
        The model with the cause.
    """
    own = {name: value for name, (value, _) in extended.derived.items()}
    tau, frequency = own.get("time_constant"), own.get("natural_frequency")
    damping = own.get("damping_ratio")
    if known is TWO_RESONANCES and frequency and damping is not None:
        return f"{1.0 / frequency:.4g} s", f"{damping:.4g}"
    if known is not TWO_LAGS or tau is None:
        return ()
    if not frequency or damping is None:
        return (f"{tau:.4g} s",)
    if damping < 1.0:
        return ()
    slow = (damping + math.sqrt(damping**2 - 1.0)) / (2.0 * math.pi * frequency)
    return f"{slow:.4g} s", f"{tau - slow:.4g} s"


def are_alike(alternative: Alternative) -> bool:
    """Whether the causes of a tie explain the logs equally well.

    Parameters
    ----------
    alternative
        The causes.
    """
    return max(alternative.delta_bic.values(), default=0.0) < INDISTINCT


def law_that_ties(alternative: Alternative, *, linear: bool) -> EquivalenceClass | None:
    """What no log of this model can split, where that makes the tie; else None.

    Parameters
    ----------
    alternative, linear
        As in `why_tied`.
    """
    tied = set(alternative.effects)
    if tied.issuperset(TWO_LATE.effects) and not are_alike(alternative):
        return TWO_LATE
    is_lower = alternative.keys[0].endswith(".lower")
    for known in LAWS_ALIKE:
        if tied.issuperset(known.effects) and (is_lower or known is not LOWER_END):
            return known
    for known in REPLACED:
        if tied.intersection(known.effects):
            return known
    if not linear:
        return None
    return next((known for known in LINEAR_FILTERS if set(known.effects) <= tied), None)


def remedy_of_disturbance(found: Diagnosis) -> str | None:
    """What to do about a disturbance, where nothing else describes the misfit or what is left.

    Parameters
    ----------
    found
        The diagnosis.
    """
    is_all = found.verdict is Verdict.UNKNOWN and not found.descriptive
    if not (is_all or found.remainder.is_a_line):
        return None
    return next((issue.remedy for issue in found.issues if issue.code in CODES), None)


def what_next(
    verdict: Verdict,
    *,
    alternatives: Sequence[Alternative],
    remainder: Remainder,
    laws: Sequence[Cause] = (),
    linear: bool = False,
    in_blocks: bool = False,
    held: frozenset[str] = frozenset(),
) -> str | None:
    """What to record next; None when nothing is open.

    Parameters
    ----------
    verdict, alternatives, remainder
        As in `Diagnosis`.
    laws
        Its causes and descriptions.
    linear
        Whether the base model is linear.
    in_blocks
        Whether blocks of the fitted logs judge.
    held
        Experiments that the logs hold, from `held_experiments`.
    """
    if any(law.doubt is Doubt.ONE_STEP for law in laws):
        return SEVERAL_STEPS
    come_first = verdict is not Verdict.UNKNOWN or (
        remainder.explained_share >= WORTH_DOUBTS and not variables_left(remainder)
    )
    for alternative in alternatives if come_first else ():
        beside = is_linear_beside(laws, alternative.effects, linear=linear)
        known = law_that_ties(alternative, linear=beside)
        if known is not None:
            return f"record {known.splits}"
        if SPLITS in alternative.why:
            return f"record {alternative.why.partition(SPLITS)[2].removesuffix('.')}"
        split = split_in_words(alternative.keys, held)
        if split is not None:
            return split
    if remainder.misses_held_out and not remainder.structured:
        return _to_judge(laws, in_blocks=in_blocks)
    if verdict is Verdict.UNKNOWN and not remainder.structured:
        if any(law.doubt is Doubt.TOO_SLOW for law in laws):
            return "record several times as long, with holds and a rest that last"
        return "record more levels and more moves, which would show how sure the description is"
    if verdict is Verdict.UNKNOWN or verdict is Verdict.PARTIAL:
        return _to_see_more(remainder)
    return None


def _to_judge(laws: Sequence[Cause], *, in_blocks: bool) -> str:
    """What to hold out where the fitted samples are explained and those held out are not."""
    if in_blocks:
        return "record the same once more, from a rest, and hold that log out"
    anew = [law.key for law in laws if law.key in EFFECTS and EFFECTS[law.key].begins_with_log]
    if anew:
        begin = "begins" if len(anew) == 1 else "begin"
        return (
            f"hold out none, so that blocks of these logs judge: {titles_of(anew)} {begin} "
            "anew with every log here, and what is held out may have begun otherwise"
        )
    return "fit what is held out together with the rest, for it shows what the rest hardly does"


def _to_see_more(remainder: Remainder) -> str:
    """What varies that which is left follows."""
    left = variables_left(remainder)
    rest = "" if remainder.noise_is_known else ", and with a rest of 30 s that shows the noise"
    if left == ["t"]:
        return f"record the same for longer, to see how it goes on{rest}"
    varied = [VARIATIONS[name] for name in left if name in VARIATIONS]
    if varied:
        return f"repeat these logs with {listed(varied)}{rest}"
    return f"record the same path once slowly and once fast{rest}"
