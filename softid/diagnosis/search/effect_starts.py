"""Where a refit with one more effect begins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import (
    COARSE_STEPS,
    Candidate,
    begun,
    limited_plans,
    prior_about,
    standing_at,
)
from softid.diagnosis.refit.extension import (
    extend,
    named_values,
    start_unknowns,
    within_bounds_of,
)
from softid.diagnosis.search.screening import Signature
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.fitters.problem import Problem

Array = npt.NDArray[np.float64]

FRACTIONS = (1.0, 0.4, 0.1)
"""Fractions of a proposed start that are tried, with and without the base moved along."""

EQUAL_SQUARES = 1e-9
"""Of two starts whose sums of squares differ by less the first is taken, and rounding picks none:
the shift may move the sensor's zero alone, which is at its best in both."""

KEPT_PROMISE = 0.5
"""No smaller fraction is tried of a start that keeps half of what its signature promises."""

INERTIA_SHARES = (1.0, 0.1, 0.01)
"""Shares of the base's inertia with which an effect that takes time begins."""

LIGHT = 0.1
"""Share of the base's inertia with which an effect begins that begins slow."""

LOST = 1e6
"""A response so many times the output's own scale away is lost. Beyond 1e16 the sensor's zero would
even take all of it away, rounding the measured output to nothing, and leave a sum of zero."""


def candidate_from(
    fitted: Candidate,
    signature: Signature,
    scale: Scale,
    sigma: Mapping[str, float],
    variance: float,
) -> Candidate:
    """A candidate at the best of a few fractions of the start that a signature proposes.

    A signature is linear; where the motion bends it, a shorter step along it is better.

    Parameters
    ----------
    fitted
        The base, or a candidate that already has effects.
    signature
        The effect to add and its values.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    variance
        Variance of the weighted residual, for the prior.
    """
    problem = extend(fitted.problem, (signature.effect,), scale)
    point = fitted.minimum.point
    lower, upper = fitted.problem.bounds()
    best, least = None, np.inf
    for fraction in FRACTIONS if signature.effect.amplitudes else FRACTIONS[:1]:
        values = dict(signature.values)
        for name in signature.effect.amplitudes:
            values[name] *= fraction
        named = named_values(signature.effect, values)
        for moved in (point + fraction * signature.shift, point):
            inside = np.clip(moved, lower, upper)
            start = start_unknowns(problem, fitted.problem, inside, named)
            squares = squares_at(problem, start, sigma)
            if best is None or squares < (1.0 - EQUAL_SQUARES) * least:
                best, least = start, squares
        if fitted.squares - least > KEPT_PROMISE * signature.drop:
            break
    assert best is not None
    return _placed(fitted, signature.effect, problem, best, variance)


def forms_of(
    fitted: Candidate,
    first: Candidate,
    effect: Effect,
    scale: Scale,
    variance: float,
    *,
    known: Mapping[str, float] | None = None,
) -> list[Candidate]:
    """Candidates with another form of a law, where a first form stands.

    What only the other form has begins at each of its own starts: which of them leaves least there
    does not tell which leads to the best place.

    Parameters
    ----------
    fitted
        The base, or a candidate that already has effects.
    first
        The same with the first form of the law.
    effect
        The other form.
    scale
        Sizes of the base fit.
    variance
        Variance of the weighted residual, for the prior.
    known
        Values of the other form, if they follow from those of the first.
    """
    problem = extend(fitted.problem, (effect,), scale)
    begin, point = first.problem, first.minimum.point
    places = dict.fromkeys(
        tuple(start_unknowns(problem, begin, point, named_values(effect, values)).tolist())
        for values in ([known] if known else effect.starts(scale))
    )
    return [_placed(fitted, effect, problem, np.array(z), variance) for z in places]


def candidate_at(
    place: Candidate,
    effect: Effect,
    values: Mapping[str, float],
    scale: Scale,
    sigma: Mapping[str, float],
) -> tuple[float, Candidate]:
    """The sum of squares at one start of an effect added to the base, and the candidate there.

    Parameters
    ----------
    place
        The base, at unknowns that need not be an optimum.
    effect
        The effect to add.
    values
        Its parameters.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    problem = extend(place.problem, (effect,), scale)
    named = named_values(effect, values)
    start = start_unknowns(problem, place.problem, place.minimum.point, named)
    squares = squares_at(problem, start, sigma)
    known = squares if np.isfinite(squares) else place.squares
    variance = known / max(problem.n_samples - problem.size, 1)
    return squares, _placed(place, effect, problem, start, variance, squares=known)


def late_candidate(
    fitted: Candidate, effect: Effect, scale: Scale, sigma: Mapping[str, float], variance: float
) -> Candidate:
    """A candidate at the best of an effect's own starts, with the inertia as it is or lighter.

    A base that was fitted to a late response is late itself, by too large an inertia: far from
    where it belongs, a signature says little.

    Parameters
    ----------
    fitted
        The base, or a candidate that already has effects.
    effect
        The effect to add, one that `takes_time`.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    variance
        Variance of the weighted residual, for the prior.
    """
    problem = extend(fitted.problem, (effect,), scale)
    has_inertia = fitted.problem.model.inertia_parameter in fitted.problem.free
    starts = [
        _lighter_start(fitted, problem, share, named_values(effect, values))
        for share in (INERTIA_SHARES if has_inertia else INERTIA_SHARES[:1])
        for values in effect.starts(scale)
    ]
    best = min(starts, key=lambda z: squares_at(problem, z, sigma))
    return _placed(fitted, effect, problem, best, variance)


def slow_candidate(fitted: Candidate, effect: Effect, scale: Scale, variance: float) -> Candidate:
    """A candidate at the slowest of an effect's own starts, with a lighter inertia.

    What is far slower than the base makes that stand for what it is not: no start is a good one
    then, and the way from the slowest is long, but it leads there.

    Parameters
    ----------
    fitted
        The base, or a candidate that already has effects.
    effect
        The effect to add, one that `takes_time`.
    scale
        Sizes of the base fit.
    variance
        Variance of the weighted residual, for the prior.
    """
    problem = extend(fitted.problem, (effect,), scale)
    slowest = named_values(effect, effect.starts(scale)[-1])
    start = _lighter_start(fitted, problem, LIGHT, slowest)
    return _placed(fitted, effect, problem, start, variance)


def _lighter_start(
    fitted: Candidate, problem: Problem, share: float, named: Mapping[str, float]
) -> Array:
    """Unknowns with values added, and with a share of the inertia."""
    point = fitted.minimum.point.copy()
    inertia = fitted.problem.model.inertia_parameter
    point[[k for k, name in enumerate(fitted.problem.free) if name == inertia]] += np.log(share)
    return start_unknowns(problem, fitted.problem, point, named)


def with_effect(fitted: Candidate, whole: Candidate, effect: Effect, scale: Scale) -> Candidate:
    """A candidate with an effect added where a model that has it stands.

    Parameters
    ----------
    fitted
        What is extended.
    whole
        The same with the effect, which may have been added before the others.
    effect
        The effect.
    scale
        Sizes of the base fit.
    """
    problem = within_bounds_of(extend(fitted.problem, (effect,), scale), whole.problem)
    z = start_unknowns(problem, whole.problem, whole.minimum.point, {})
    return begun(whole, (*fitted.effects, effect), problem, z)


def _placed(
    fitted: Candidate,
    effect: Effect,
    problem: Problem,
    best: Array,
    variance: float,
    *,
    squares: float | None = None,
) -> Candidate:
    """The candidate at a start; until it is refitted it is as good as what it extends, or as said.

    The prior holds what was known where that was fitted.
    """
    centre = best.copy()
    known = fitted.problem.free_by_name(fitted.minimum.point)
    for k, name in enumerate(problem.free):
        centre[k] = known.get(name, centre[k])
    prior = prior_about(problem, centre, fitted.problem.free, variance)
    begin = replace(fitted.minimum, evaluations=0, offset=np.inf)
    placed = standing_at(best, begin, prior, fitted.squares if squares is None else squares)
    return Candidate((*fitted.effects, effect), problem, placed, prior)


def squares_at(problem: Problem, z: Array, sigma: Mapping[str, float]) -> float:
    """Weighted sum of squares with every zero at its best; infinite where the response is lost."""
    plans = limited_plans(problem, z, COARSE_STEPS)
    with np.errstate(all="ignore"):
        blocks = list(problem.blocks(z, derivatives=False, plans=plans))
        if not all(np.all(np.abs(b.residual) < LOST * sigma[b.channel]) for b in blocks):
            return np.inf
        _, blocks = problem.with_best_zeros(z, blocks)
        total = sum(float(b.residual @ b.residual) / sigma[b.channel] ** 2 for b in blocks)
    return total if np.isfinite(total) else np.inf
