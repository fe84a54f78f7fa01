"""A base that leaves a drift and a bow of the reading, and chains of causes of that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search.forward_selection import FURTHER, Chain, Link, converged, next_link
from softid.effects.base import Effect
from softid.effects.scale import Scale


def base_with(*, rate: float = 0.0, size: float = 0.0, power: int = 2) -> tuple[Candidate, Scale]:
    """The fit of what adds rate·t + size·(t/T)^power to its reading, with noise of 0.01."""
    time_s = linear_log().time_s
    added = rate * time_s + size * (time_s / time_s[-1]) ** power
    problem = linear_problem([linear_log(noise=0.01, added=added)])
    z = problem.unknowns(TRUTH)
    return converged(standing(problem, z), SIGMA), scale_of(problem, z)


def chained(base: Candidate, scale: Scale, effects: Sequence[Effect]) -> Chain:
    """A chain of given causes in a given order, whatever would have been found."""
    links: list[Link] = []
    now = base
    for effect in effects:
        link = next_link(now, [effect], scale, SIGMA, FURTHER)
        assert link is not None
        now = converged(link.chosen.plain, SIGMA)
        links.append(replace(link, found=now))
    return Chain(tuple(links), None, now)
