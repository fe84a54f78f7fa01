"""Other places that explain about as much as where a candidate stands."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from softid.diagnosis.refit.candidates import Candidate, standing_at
from softid.effects import extended_name
from softid.effects.base import Effect

LIGHTER = 0.1
"""What is left of an inertia when its time is given to a lag."""

LEAST_DAMPING_RATIO = 0.7
"""A law that is damped less swings, which no chain of lags does; noise and what the base gets wrong
let two equal poles look a little like it."""


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
    law = problem.model.motion_law(problem.theta(candidate.minimum.point))
    if inertia not in problem.free or late is None or law is None:
        return []
    effect, lag = late
    values, slowness = candidate.parameters, effect.slowness
    lag_s = values[lag] / slowness
    damping, stiffness, _ = law.coefficients(np.concatenate([s.input for s in problem.segments]))
    usual = _Usual(law.mass, max(float(np.median(damping)), 1e-300), float(np.median(stiffness)))
    places = []
    if usual.inertia_s > lag_s:
        places.append({lag: slowness * usual.inertia_s, inertia: LIGHTER * usual.mass})
    slow_s, fast_s = usual.poles_s
    if slow_s > lag_s:
        share = (lag_s + fast_s) / usual.damping_s
        place = {name: share * values[name] for name in problem.model.damping_parameters}
        inertia_left = lag_s * fast_s * usual.stiffness
        places.append(place | {lag: slowness * slow_s, inertia: inertia_left})
    return [_moved(candidate, place) for place in places]


class _Usual(NamedTuple):
    """A law with the median of its coefficients over the logs."""

    mass: float
    damping: float
    stiffness: float

    @property
    def inertia_s(self) -> float:
        """Time that the inertia takes, M/N."""
        return self.mass / self.damping

    @property
    def damping_s(self) -> float:
        """Time that the damping takes, N/K."""
        return self.damping / self.stiffness

    @property
    def poles_s(self) -> tuple[float, float]:
        """T₁ ≥ T₂ with N/K = T₁ + T₂ and M/K = T₁T₂; both zero where the law swings."""
        if self.stiffness <= 0.0:
            return 0.0, 0.0
        ratio = self.damping / (2.0 * np.sqrt(self.mass * self.stiffness))
        if ratio < LEAST_DAMPING_RATIO:
            return 0.0, 0.0
        apart = np.sqrt(max(1.0 - ratio**-2, 0.0))
        return 0.5 * self.damping_s * (1.0 + apart), 0.5 * self.damping_s * (1.0 - apart)


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
