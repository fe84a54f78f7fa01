"""Why causes are tied, and what to record next."""

from __future__ import annotations

from collections.abc import Sequence

from softid.diagnosis.report.phrases import VARIATIONS, title_of, titles_of, variables_left
from softid.diagnosis.search.forward_selection import INDISTINCT
from softid.diagnosis.verdict.equivalence import (
    HELD_INPUT,
    LINEAR_FILTERS,
    LOWER_END,
    OWN_DAMPING,
    PRESLIDING,
    REPLACED,
    THINNING,
    EquivalenceClass,
    splitting_experiment,
    why_unsplit,
)
from softid.diagnosis_results import Alternative, Remainder, Verdict
from softid.models import MODELS
from softid.results import FitResult


def is_linear(base: FitResult) -> bool:
    """Whether a model's coefficients stay whatever the input does."""
    return MODELS[base.model.name].is_linear


def why_tied(alternative: Alternative, *, linear: bool) -> str:
    """Why causes are not told apart, and what would do it.

    Parameters
    ----------
    alternative
        The causes.
    linear
        Whether the base model is linear.
    """
    known = law_that_ties(alternative, linear=linear)
    if known is not None:
        return f"{known.why}. What splits them: {known.splits}."
    return why_unsplit(alternative.keys, alike=_are_alike(alternative))


def _are_alike(alternative: Alternative) -> bool:
    return max(alternative.delta_bic.values(), default=0.0) < INDISTINCT


def law_that_ties(alternative: Alternative, *, linear: bool) -> EquivalenceClass | None:
    """What no log of this model can split, where that makes the tie; else None.

    Parameters
    ----------
    alternative, linear
        As in `why_tied`.
    """
    if _is_presliding(alternative):
        return PRESLIDING
    tied = set(alternative.effects)
    for known in (OWN_DAMPING, LOWER_END, HELD_INPUT, THINNING):
        if tied.issuperset(known.effects):
            return known
    for known in REPLACED:
        if tied.intersection(known.effects):
            return known
    if not linear:
        return None
    return next((known for known in LINEAR_FILTERS if set(known.effects) <= tied), None)


def _is_presliding(alternative: Alternative) -> bool:
    """Whether it is the law, not the logs, that makes a tie."""
    return set(alternative.effects) == set(PRESLIDING.effects) and not _are_alike(alternative)


def what_next(
    verdict: Verdict,
    *,
    alternatives: Sequence[Alternative],
    remainder: Remainder,
    linear: bool = False,
) -> str | None:
    """What to record next; None when nothing is open.

    Parameters
    ----------
    verdict, alternatives, remainder
        As in `Diagnosis`.
    linear
        Whether the base model is linear.
    """
    for alternative in alternatives if verdict is not Verdict.UNKNOWN else ():
        known = law_that_ties(alternative, linear=linear)
        if known is not None:
            return f"record {known.splits}"
        split = splitting_experiment(alternative.keys)
        if split is not None:
            first, *others = alternative.keys
            rest = titles_of(others, last=" or ")
            return f"record {split.experiment}, to tell {title_of(first)} from {rest}"
    if remainder.misses_held_out and not remainder.structured:
        return "fit what is held out together with the rest, for it shows what the rest hardly does"
    if verdict is Verdict.UNKNOWN and not remainder.structured:
        return "record more levels and more moves, which would show how sure the description is"
    if verdict is Verdict.UNKNOWN or verdict is Verdict.PARTIAL:
        left = variables_left(remainder)
        rest = "" if remainder.noise_from_rest else ", and with a rest of 30 s that shows the noise"
        if left == ["t"]:
            return f"record the same for longer, to see how it goes on{rest}"
        varied = [VARIATIONS[name] for name in left if name in VARIATIONS]
        if varied:
            return f"repeat these logs with {' and '.join(varied)}{rest}"
        return f"record the same path once slowly and once fast{rest}"
    return None
