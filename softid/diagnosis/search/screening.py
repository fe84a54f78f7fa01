"""Which effects could explain what the fit leaves: signatures against the residual."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import (
    COARSE,
    FINE,
    Candidate,
    extend,
    limited_plans,
    named_values,
    prior_about,
    standing_at,
    start_unknowns,
)
from softid.diagnosis.refit.parallel import in_parallel
from softid.diagnosis.refit.rough_copy import rough_copy
from softid.diagnosis.residual.projection import Span, project_out, span_of
from softid.effects.base import Effect, Scale
from softid.fitters.problem import Problem

Array = npt.NDArray[np.float64]

FOLLOWED = 1e-6
"""Directions of the Jacobian that are weaker than this share of the strongest are not followed: the
unknowns would have to go so far along them that no linear model holds."""

FRACTIONS = (1.0, 0.4, 0.1)
"""Fractions of a proposed start that are tried, with and without the base moved along."""

ALIKE = 1e-9
"""Of two starts whose sums of squares differ by less the first is taken, and rounding picks none:
the shift may move the sensor's zero alone, which is at its best in both."""

KEPT = 0.5
"""No smaller fraction is tried of a start that keeps half of what its signature promises."""

INERTIA_SHARES = (1.0, 0.1, 0.01)
"""Shares of the base's inertia with which an effect that takes time begins."""

SMALLEST_AMPLITUDE = 0.05
"""Smallest factor by which a start's amplitude is scaled to what the residual asks for."""

LARGEST_AMPLITUDE = 5.0
"""Largest of these factors: a signature is a straight line, and says little so far out."""

LOST = 1e6
"""A response so many times the output's own scale away is lost. Beyond 1e16 the sensor's zero would
even take all of it away, rounding the measured output to nothing, and leave a sum of zero."""


@dataclass(frozen=True, eq=False)
class Signature:
    """What one start of one effect would change, seen against the residual.

    Attributes
    ----------
    effect
        The effect.
    values
        Parameter → value from which a refit starts, its amplitude scaled to the residual.
    drop
        (r·s)²/(s·s), the drop of the sum of squares that it promises.
    shift
        By how much the unknowns of what is extended move to make room for it, shape (U,).
    """

    effect: Effect
    values: Mapping[str, float]
    drop: float
    shift: Array


@dataclass(frozen=True, eq=False)
class Residual:
    """Residual and Jacobian of a fit, with what the Jacobian spans taken out.

    Attributes
    ----------
    rows
        Residual in units of the channels' weights, shape (n,).
    span
        What the Jacobian spans, as far as the unknowns can follow.
    simulated
        Simulated outputs in the same units and order, with the steps of the signatures, shape (n,).
    """

    rows: Array
    span: Span
    simulated: Array


def residual_of(problem: Problem, unknowns: Array, sigma: Mapping[str, float]) -> Residual:
    """Linearise a fit where it stands.

    Parameters
    ----------
    problem, unknowns
        The fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    fine, coarse = (limited_plans(problem, unknowns, most) for most in (FINE, COARSE))
    blocks = list(problem.blocks(unknowns, derivatives=True, plans=fine))
    rough = problem.blocks(unknowns, derivatives=False, plans=coarse)
    rows = np.concatenate([b.residual / sigma[b.channel] for b in blocks])
    jacobian = np.concatenate(
        [b.jacobian / sigma[b.channel] for b in blocks if b.jacobian is not None]
    )
    roughly = np.concatenate([b.residual / sigma[b.channel] for b in rough])
    return Residual(rows, span_of(jacobian, FOLLOWED), _measured(problem, sigma) - roughly)


def _measured(problem: Problem, sigma: Mapping[str, float]) -> Array:
    return np.concatenate(
        [
            segment.outputs[name][segment.used[name]] / sigma[name]
            for segment in problem.segments
            for name in problem.outputs
        ]
    )


def screen(
    fitted: Candidate,
    effects: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> list[Signature]:
    """Signatures of every start of every effect, seen on a `rough_copy`, the most promising first.

    Parameters
    ----------
    fitted
        The base, or a candidate that already has effects.
    effects
        Effects that it does not have.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    fitted, sigma = rough_copy(fitted, scale, sigma)
    residual = residual_of(fitted.problem, fitted.minimum.point, sigma)
    measured = _measured(fitted.problem, sigma)
    reach = 0.5 * fitted.problem.reach()
    starts = [(effect, values) for effect in effects for values in effect.starts(scale)]

    def look(start: tuple[Effect, Mapping[str, float]]) -> Signature | None:
        effect, values = start
        problem = extend(fitted.problem, (effect,), scale)
        named = named_values(effect, values)
        z = start_unknowns(problem, fitted.problem, fitted.minimum.point, named)
        with np.errstate(all="ignore"):
            plans = limited_plans(problem, z, COARSE)
            blocks = problem.blocks(z, derivatives=False, plans=plans)
            rows = [b.residual / sigma[b.channel] for b in blocks]
            whole = measured - np.concatenate(rows) - residual.simulated
            change = project_out(residual.span.basis, whole)
            power = float(change @ change)
        if not np.isfinite(power) or power <= 0.0:
            return None
        along = float(residual.rows @ change)
        share, drop = along / power, along**2 / power
        if not effect.changes_sign and share < 0.0:
            share, drop = SMALLEST_AMPLITUDE, 0.0
        scaled, factor = _scaled(effect, values, share)
        shift = -factor * (residual.span.combinations @ (residual.span.basis.T @ whole))
        return Signature(effect, scaled, drop, np.clip(shift, -reach, reach))

    return sorted(filter(None, in_parallel(look, starts)), key=lambda s: -s.drop)


def _scaled(
    effect: Effect, values: Mapping[str, float], share: float
) -> tuple[dict[str, float], float]:
    """Start values with the amplitude as large as the residual asks for, and by what factor."""
    size = np.clip(abs(share), SMALLEST_AMPLITUDE, LARGEST_AMPLITUDE)
    factor = float(np.copysign(size, share))
    scaled = dict(values)
    for name in effect.amplitudes:
        scaled[name] = factor * scaled[name]
    return scaled, factor if effect.amplitudes else 1.0


def candidate_from(
    fitted: Candidate,
    signature: Signature,
    scale: Scale,
    sigma: Mapping[str, float],
    variance: float,
) -> Candidate:
    """A candidate at the best of a few fractions of the start that a signature proposes.

    A signature is a straight line; where the motion bends it, a shorter step along it is better.

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
            squares = _squares(problem, start, sigma)
            if best is None or squares < (1.0 - ALIKE) * least:
                best, least = start, squares
        if fitted.squares - least > KEPT * signature.drop:
            break
    assert best is not None
    return _placed(fitted, signature.effect, problem, best, variance)


def form_of(
    fitted: Candidate,
    first: Candidate,
    effect: Effect,
    scale: Scale,
    sigma: Mapping[str, float],
    variance: float,
    *,
    known: Mapping[str, float] | None = None,
) -> Candidate:
    """A candidate with another form of a law, where a first form stands.

    Parameters
    ----------
    fitted
        The base, or a candidate that already has effects.
    first
        The same with the first form of the law.
    effect
        The other form; what only it has begins at the best of its own starts.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    variance
        Variance of the weighted residual, for the prior.
    known
        Values of the other form, if they follow from those of the first.
    """
    problem = extend(fitted.problem, (effect,), scale)
    starts = [
        start_unknowns(problem, first.problem, first.minimum.point, named_values(effect, values))
        for values in ([known] if known else effect.starts(scale))
    ]
    best = min(starts, key=lambda z: _squares(problem, z, sigma))
    return _placed(fitted, effect, problem, best, variance)


def candidate_at(
    place: Candidate,
    effect: Effect,
    values: Mapping[str, float],
    scale: Scale,
    sigma: Mapping[str, float],
) -> tuple[float, Candidate]:
    """The sum of squares at one start of an effect over a base that stands anywhere, and there.

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
    squares = _squares(problem, start, sigma)
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
    inertia = fitted.problem.model.inertia_parameter
    at = [k for k, name in enumerate(fitted.problem.free) if name == inertia]
    starts = []
    for share in INERTIA_SHARES if at else INERTIA_SHARES[:1]:
        point = fitted.minimum.point.copy()
        point[at] += np.log(share)
        for values in effect.starts(scale):
            named = named_values(effect, values)
            starts.append(start_unknowns(problem, fitted.problem, point, named))
    best = min(starts, key=lambda z: _squares(problem, z, sigma))
    return _placed(fitted, effect, problem, best, variance)


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
    problem = extend(fitted.problem, (effect,), scale)
    z = start_unknowns(problem, whole.problem, whole.minimum.point, {})
    variance = whole.squares / max(problem.n_samples - problem.size, 1)
    prior = prior_about(problem, z, problem.free, variance)
    placed = standing_at(z, whole.minimum, prior, whole.squares)
    return Candidate((*fitted.effects, effect), problem, placed, prior)


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


def _squares(problem: Problem, z: Array, sigma: Mapping[str, float]) -> float:
    """Weighted sum of squares with every zero at its best; infinite where the response is lost."""
    plans = limited_plans(problem, z, COARSE)
    with np.errstate(all="ignore"):
        blocks = list(problem.blocks(z, derivatives=False, plans=plans))
        if not all(np.all(np.abs(b.residual) < LOST * sigma[b.channel]) for b in blocks):
            return np.inf
        _, blocks = problem.with_best_zeros(z, blocks)
        total = sum(float(b.residual @ b.residual) / sigma[b.channel] ** 2 for b in blocks)
    return total if np.isfinite(total) else np.inf
