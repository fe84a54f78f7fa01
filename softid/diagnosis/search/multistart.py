"""Candidates that do not begin where the base stands, for one that is no place to begin.

A base that was fitted to a misfit may have gone far to make room for it: a term of it vanishes, or
another part of its curve lies in the range. What is added there finds no way back. The start values
of the base know nothing of that; and where an effect changes the input, they are searched anew with
the input that arrives.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from softid.diagnosis.refit.candidates import COARSE_STEPS, Candidate, advance, standing_at
from softid.diagnosis.refit.rough_copy import over_samples_of, rough_copy
from softid.diagnosis.search.effect_starts import candidate_at
from softid.diagnosis.search.racing import refined
from softid.effects.base import Effect, InputEffect, OutputEffect
from softid.effects.scale import Scale
from softid.fitters.problem import Problem
from softid.intersample import HELD
from softid.parallel import in_parallel
from softid.segment import Segment

BASE_STARTS = 3
"""Best start values of the base that are tried with every start of an effect."""

STARTS = 2
"""Most promising combinations of a start of the base and one of an effect that are led on."""

LEADING_SAMPLES = 3000
"""Samples that lead the candidates where a log cannot be averaged."""

OVER_ALL = 5
"""Evaluations over all samples that follow those over averages."""

VANISHED = 1e-3
"""A term has vanished when a factor of e in it changes the output by less than this share of the
misfit's power: no step of an optimiser brings it back."""


FAR_OFF = 7.0
"""A base is astray where a parameter lies a factor of e⁷ = 1100 or more from all start values. Two
levels of the input leave a valley of curves, along which a cause that is missing drives it."""


def is_astray(base: Candidate) -> bool:
    """Whether a base is no place to begin: a term of it has vanished, or it has run far away.

    Parameters
    ----------
    base
        The base fit, without effects.
    """
    return has_vanished(base) or _has_run_away(base)


def _has_run_away(base: Candidate) -> bool:
    problem = base.problem
    scaled = [k for k, name in enumerate(problem.free) if problem.parameters[name].scale == "log"]
    if not scaled:
        return False
    guesses = problem.model.guess(problem.plain_segments, problem.outputs[0])[:BASE_STARTS]
    starts = [problem.free_unknowns(guess.values_dict()) for guess in guesses]
    ways = [float(np.abs(start - base.minimum.point)[scaled].max()) for start in starts]
    return min(ways, default=0.0) > FAR_OFF


def has_vanished(base: Candidate) -> bool:
    """Whether a term of the base has vanished, to make room for what it cannot explain."""
    problem = base.problem
    scaled = [problem.parameters[name].scale == "log" for name in problem.free]
    by_samples = np.diag(base.minimum.normal.matrix) - base.prior.weight
    felt = by_samples[: len(scaled)][scaled]
    return bool(np.any(felt < VANISHED * base.squares))


def usual_places(base: Candidate) -> list[Candidate]:
    """The base at its start values, which know nothing of the way that it has gone.

    Parameters
    ----------
    base
        The base fit, without effects.
    """
    return list(_places(base, base.problem.plain_segments))


def multistart_candidates(
    base: Candidate, effects: Sequence[Effect], scale: Scale, sigma: Mapping[str, float]
) -> list[Candidate]:
    """The base with each effect from start values of the base, those that came far.

    Parameters
    ----------
    base
        The base fit, without effects.
    effects
        The catalogue.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    rough, rough_sigma = rough_copy(base, scale, sigma)
    if rough is base:
        rough = _sparse(base)
    usual = usual_places(rough)

    def placed(effect: Effect) -> list[Candidate]:
        found = (
            [] if isinstance(effect, InputEffect) else [(v, usual) for v in effect.starts(scale)]
        )
        chosen = _best(found, effect, scale, rough_sigma)
        if isinstance(effect, InputEffect | OutputEffect) and _comes_first(effect, scale):
            own = [
                (values, driven(rough, effect, values, scale)) for values in effect.starts(scale)
            ]
            chosen += _best(own, effect, scale, rough_sigma)
        return chosen

    led = refined([c for found in in_parallel(placed, effects) for c in found], rough, rough_sigma)
    if rough is base:
        return led

    def finished(candidate: Candidate) -> Candidate:
        whole = over_samples_of(candidate, base, scale)
        return advance(whole, sigma, OVER_ALL, substeps=COARSE_STEPS)

    return in_parallel(finished, led)


def _sparse(base: Candidate) -> Candidate:
    """The base over every k-th sample of long logs that cannot be averaged."""
    step = base.problem.n_samples // LEADING_SAMPLES
    if step < 2 or any(log.intersample in HELD for log in base.problem.logs):
        return base
    logs = [log.every(step) for log in base.problem.logs]
    sparse = Problem(base.problem.model, base.problem.parameters, logs)
    return replace(base, problem=sparse) if sparse.size == base.problem.size else base


def _comes_first(effect: Effect, scale: Scale) -> bool:
    """Whether start values are searched anew: a late sensor is to them what a late input is."""
    return isinstance(effect, InputEffect) or effect.takes_time(scale)


def _best(
    starts: Iterable[tuple[Mapping[str, float], Sequence[Candidate]]],
    effect: Effect,
    scale: Scale,
    sigma: Mapping[str, float],
) -> list[Candidate]:
    """The best of an effect's starts at the places that belong to each."""
    tried = [
        candidate_at(place, effect, values, scale, sigma)
        for values, places in starts
        for place in places
    ]
    best = sorted(tried, key=lambda pair: pair[0])[:STARTS]
    return [candidate for squares, candidate in best if np.isfinite(squares)]


def driven(
    base: Candidate, effect: InputEffect | OutputEffect, values: Mapping[str, float], scale: Scale
) -> list[Candidate]:
    """The base at start values for what arrives behind an effect.

    Parameters
    ----------
    base
        The base fit, without effects.
    effect, values
        The effect, and its parameters there.
    scale
        Sizes of the base fit.
    """
    eta = effect.parameters(scale).with_values(values).values_vector()
    arriving = [
        replace(s, input=effect.apply(eta, s.since_s, s.input, scale))
        for s in base.problem.plain_segments
    ]
    return list(_places(base, arriving))


def _places(base: Candidate, segments: Sequence[Segment]) -> Iterator[Candidate]:
    """The base at the best start values for given segments."""
    problem = base.problem
    for start in problem.model.guess(segments, problem.outputs[0])[:BASE_STARTS]:
        point = problem.unknowns(start.values_dict())
        place = standing_at(point, base.minimum, base.prior, base.squares)
        yield replace(base, minimum=place)
