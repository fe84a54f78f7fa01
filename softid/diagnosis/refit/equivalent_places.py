"""Other places that explain about as much as where a candidate stands."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from softid.diagnosis.refit.candidates import Candidate, standing_at
from softid.diagnosis.refit.usual_law import usual_law
from softid.effects import extended_name
from softid.effects.base import Effect

LIGHTER = 0.1
"""What is left of an inertia when its time is given to a lag."""


def alternatives(candidate: Candidate) -> list[Candidate]:
    """The candidate with terms of the base in another form, which a search would not reach."""
    changes = [
        {name: p.value for name, p in change.items() if not p.fixed}
        for change in candidate.problem.model.alternatives(candidate.parameters)
    ]
    return [_moved(candidate, change) for change in changes]


def exchanged(candidate: Candidate) -> list[Candidate]:
    """The candidate with its lag in place of a slower pole of the law, if it has both.

    Poles in a row look alike in any order; which of them is the lag's, a search decides by where
    it began.
    """
    problem, late = candidate.problem, _late_effect(candidate)
    inertia = problem.model.inertia_parameter
    if inertia not in problem.free or late is None:
        return []
    usual = usual_law(candidate)
    if usual is None:
        return []
    effect, lag = late
    values, slowness = candidate.parameters, effect.slowness
    lag_s = values[lag] / slowness
    places = []
    if usual.inertia_s > lag_s:
        places.append({lag: slowness * usual.inertia_s, inertia: LIGHTER * usual.mass})
    if usual.poles_s is not None and usual.poles_s[0] > lag_s:
        slow_s, fast_s = usual.poles_s
        share = (lag_s + fast_s) / usual.damping_s
        place = {name: share * values[name] for name in problem.model.damping_parameters}
        inertia_left = lag_s * fast_s * usual.stiffness
        places.append(place | {lag: slowness * slow_s, inertia: inertia_left})
    return [_moved(candidate, place) for place in places]


def _late_effect(candidate: Candidate) -> tuple[Effect, str] | None:
    """Its first effect that is a lag or the like, and the name of its time; None without one."""
    for effect in candidate.effects:
        if effect.stage == "state" or effect.amplitude is None:
            continue
        name = extended_name(effect, effect.amplitude)
        if candidate.problem.parameters[name].unit == "s":
            return effect, name
    return None


def _moved(candidate: Candidate, change: Mapping[str, float]) -> Candidate:
    problem = candidate.problem
    z = candidate.minimum.point.copy()
    for k, name in enumerate(problem.free):
        if name in change:
            p = problem.parameters[name]
            inside = float(np.clip(change[name], p.lower, p.upper))
            z[k] = np.log(inside) if p.scale == "log" else inside
    minimum = standing_at(z, candidate.minimum, candidate.prior, candidate.squares)
    return replace(candidate, minimum=minimum)
