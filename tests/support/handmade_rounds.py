"""Rounds of a search built by hand: effects, sums of squares and BIC, and nothing else."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from softid.diagnosis.search.bic_ranking import Ranked
from softid.diagnosis.search.forward_selection import Link
from softid.effects import effect_of

SAMPLES, UNKNOWNS = 10_000, 6


def candidate(
    keys: Sequence[str],
    squares: float = 100.0,
    *,
    offset: float = 0.0,
    values: Mapping[str, float] | None = None,
    at_bound: Sequence[str] = (),
    at_upper_bound: Sequence[str] = (),
    unknowns: int = UNKNOWNS,
) -> Any:
    """Something with effects and a sum of squares; infinite for one that ran away."""
    effects = tuple(effect_of(key) for key in keys)
    cost = 0.5 * squares if np.isfinite(squares) else np.inf
    return SimpleNamespace(
        is_pulled=False,
        effects=effects,
        keys=tuple(effect.key for effect in effects),
        squares=squares,
        parameters=defaultdict(float, values or {}),
        at_bound=frozenset((*at_bound, *at_upper_bound)),
        at_upper_bound=frozenset(at_upper_bound),
        minimum=SimpleNamespace(normal=SimpleNamespace(cost=cost, n=SAMPLES), offset=offset),
        problem=SimpleNamespace(size=unknowns, n_samples=SAMPLES + unknowns),
    )


def ranked(
    keys: Sequence[str],
    bic: float,
    squares: float = 100.0,
    *,
    values: Mapping[str, float] | None = None,
    at_bound: Sequence[str] = (),
    at_upper_bound: Sequence[str] = (),
    unknowns: int = UNKNOWNS,
) -> Ranked:
    """A row of a ranking; parameters without a value are zero."""
    made = candidate(
        keys,
        squares,
        values=values,
        at_bound=at_bound,
        at_upper_bound=at_upper_bound,
        unknowns=unknowns,
    )
    return Ranked(made, made, bic)


def link(fall: float, *, before: float = 100.0, after: float = 50.0, key: str = "delay") -> Link:
    """A round in which an effect lowers the BIC by so much."""
    base, chosen = ranked((), 0.0, before), ranked((key,), -fall, after)
    return Link(base, (chosen, base), chosen, (key,), (), before)


def link_of(key: str) -> Link:
    """The same of one form of an effect; it is known by the effect's name."""
    base, chosen = ranked((), 0.0), ranked((key,), -500.0)
    return Link(base, (chosen, base), chosen, (key.split(".")[0],), (), 100.0)


def bare_link(squares_before: float, *rivals: str) -> Any:
    """A link of which only the sum of squares and the rivals are looked at."""
    none: Any = None
    return Link(none, (), none, rivals or ("delay",), (), squares_before)
