"""Causes of which each makes far more than both together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.extension import with_fewer_effects
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.fitters.problem import Problem

Array = npt.NDArray[np.float64]

CANCELS = 0.4
"""Two laws cancel where together they move the output by less than this share of what either of
them moves it: what is left of both is the shape of a third."""


def cancelling(final: Candidate, base: Candidate, scale: Scale) -> frozenset[str]:
    """Keys of the effects of a chain that nearly cancel another one of it.

    Two that have one form each may: an offset of a clock and its rate, which meet halfway.

    Parameters
    ----------
    final
        The model with all causes.
    base
        That without any.
    scale
        Sizes of the base fit.
    """
    whole = _residual(final, final.acting, base, scale)
    found: set[str] = set()
    for pair in combinations(final.acting, 2):
        if all(effect.has_one_form for effect in pair):
            continue
        left_out: list[Sequence[Effect]] = [(one,) for one in pair] + [pair]
        moved = []
        for without in left_out:
            kept = [e for e in final.acting if e not in without]
            moved.append(_rms(_residual(final, kept, base, scale) - whole))
        *each, both = moved
        if np.isfinite(moved).all() and both < CANCELS * min(each):
            found |= {effect.key for effect in pair}
    return frozenset(found)


def _residual(final: Candidate, effects: Sequence[Effect], base: Candidate, scale: Scale) -> Array:
    """What is left with some of the effects and all parameters as they are."""
    whole, point = final.problem, final.minimum.point
    alone = _at_rest_of(base.problem, whole.free_by_name(point))
    problem, z = with_fewer_effects(whole, point, alone, effects, scale)
    with np.errstate(all="ignore"):
        blocks = problem.blocks(z, derivatives=False)
        return np.concatenate([b.residual for b in blocks if b.channel == problem.outputs[0]])


def _at_rest_of(base: Problem, known: Mapping[str, float]) -> Problem:
    """The base, holding the input at which it rests where a model that frees it has it."""
    name = base.model.rest_parameter
    if name is None or name not in known or name in base.free:
        return base
    return Problem(base.model, base.parameters.with_fixed({name: known[name]}), base.logs)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
