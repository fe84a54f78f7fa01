"""Richer and simpler forms of a law in a race."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from softid.diagnosis.refit.candidates import COARSE_STEPS, FINE_STEPS, Candidate
from softid.diagnosis.search.catching_up import SMALLEST_GAIN, best_of_each, gain
from softid.diagnosis.search.effect_starts import forms_of
from softid.diagnosis.search.rounds import FAR_ROUND, SECOND_ROUND, run_round, variance_of
from softid.diagnosis.search.screening import Signature
from softid.effects import confusable_with, own_values
from softid.effects.base import Effect
from softid.effects.scale import Scale

BY_ITSELF = 3.0
"""A richer form of a law runs by itself when it promises so many times what the plain one does: the
base may do all that the plain one can."""

OF_THE_BEST = 0.3
"""Share of what the best effect promises that a richer form of a law must promise to run by
itself."""

MANY_MORE = 3
"""A law with so many parameters more than another one can bend to what that one does."""


def by_themselves(signatures: Sequence[Signature], richer: Sequence[Effect]) -> set[str]:
    """Keys of the richer forms whose signature promises far more than that of the plain one.

    Parameters
    ----------
    signatures
        From `screen`.
    richer
        The richer forms.
    """
    promised: dict[str, float] = {}
    for signature in signatures:
        key = signature.effect.key
        promised[key] = max(promised.get(key, 0.0), signature.drop)
    most = max(promised.values(), default=0.0)
    return {
        effect.key
        for effect in richer
        if promised.get(effect.key, 0.0) > BY_ITSELF * promised.get(effect.name, 0.0)
        and promised[effect.key] > OF_THE_BEST * most
    }


def may_imitate(effect: Effect, other: Effect, scale: Scale) -> bool:
    """Whether an effect has so many more parameters than a neighbour that it may only imitate it.

    Parameters
    ----------
    effect, other
        The effect, and the one that it may stand for.
    scale
        Sizes of the base fit.
    """
    if other.name not in confusable_with(effect):
        return False
    return len(effect.parameters(scale)) >= len(other.parameters(scale)) + MANY_MORE


def is_richer(effect: Effect, plain: Effect, scale: Scale) -> bool:
    """Whether an effect is another form of the same law with further parameters.

    Parameters
    ----------
    effect, plain
        The effect, and the one that it may be a richer form of.
    scale
        Sizes of the base fit.
    """
    if effect.name != plain.name or effect.key == plain.key:
        return False
    return set(plain.parameters(scale).names) < set(effect.parameters(scale).names)


def is_twin(effect: Effect, other: Effect, scale: Scale) -> bool:
    """Whether two effects have the same parameters, one on the input and one on the reading.

    Parameters
    ----------
    effect, other
        The effects.
    scale
        Sizes of the base fit.
    """
    if {effect.stage, other.stage} != {"input", "output"}:
        return False
    return effect.parameters(scale).names == other.parameters(scale).names


def simpler_forms(
    fitted: Candidate,
    leaders: Sequence[Candidate],
    effects: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> list[Candidate]:
    """The plain form of every richer one, and what a law is like, from where the leaders stand.

    So is what a law may only imitate: a base that has bent to a dead zone hides it, and one beside
    a curve that takes the dead zone's place does not. In a linear model what an input and a reading
    do may be one, and each begins where the other is.

    Parameters
    ----------
    fitted
        What is extended.
    leaders
        The best candidates.
    effects
        Effects that may be added.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    variance = variance_of(fitted)
    placed = []
    for leader in leaders:
        added = leader.effects[-1]
        values = own_values(added, leader.parameters)
        like = added.simpler(values)
        for effect in effects:
            known = like[1] if like is not None and like[0] == effect.key else None
            if fitted.problem.model.is_linear and is_twin(added, effect, scale):
                known = values
            is_simpler = is_richer(added, effect, scale) or may_imitate(added, effect, scale)
            if known is not None or is_simpler:
                placed += forms_of(fitted, leader, effect, scale, variance, known=known)
    return run_round(placed, sigma, FAR_ROUND, FINE_STEPS)


def forms_that_gain(
    fitted: Candidate,
    plain: Sequence[Candidate],
    richer: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> list[Candidate]:
    """Richer forms after a round, from where the plain ones stand, that gain on them.

    Parameters
    ----------
    fitted
        What is extended.
    plain
        Candidates with plain forms.
    richer
        The richer forms.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    variance = variance_of(fitted)
    pairs = [
        (candidate.squares, form)
        for candidate in plain
        for effect in richer
        if is_richer(effect, candidate.effects[-1], scale)
        for form in forms_of(fitted, candidate, effect, scale, variance)
    ]
    tried = run_round([form for _, form in pairs], sigma, SECOND_ROUND, COARSE_STEPS)
    return best_of_each(
        [
            form
            for (squares, _), form in zip(pairs, tried, strict=True)
            if gain(squares, form) >= SMALLEST_GAIN
        ]
    )
