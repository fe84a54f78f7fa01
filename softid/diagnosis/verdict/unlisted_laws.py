"""Laws in no catalogue that are refitted in the place of a named drift, before it is believed.

What changes with time moves the output by much the same, wherever it acts. These laws are in no
race: beside every other effect they would make ties of what a log tells apart.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.refit.candidates import (
    Candidate,
    advance,
    begun,
    extend,
    named_values,
    start_unknowns,
)
from softid.diagnosis.refit.parallel import in_parallel
from softid.diagnosis.search.bic_ranking import rank
from softid.diagnosis.search.effect_starts import squares_at
from softid.diagnosis.search.forward_selection import INDISTINCT, Link
from softid.diagnosis.verdict.equivalence import DRIFTS
from softid.effects.base import Effect, InputEffect, Scale, StateEffect
from softid.kernels.terms import FORCE
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LARGEST = 0.8
"""Bound of what has changed by the end of the longest log, as a share of the force or the input."""

START = 0.1
"""Start of that, either way."""

REFITTING = 40
"""Evaluations from where a drift stood to the optimum of what is put in its place."""


@dataclass(frozen=True)
class ConstantRate(Effect):
    """What all of them have in common: one parameter, the rate, of either sign."""

    neighbours: ClassVar[tuple[str, ...]] = DRIFTS
    shown_by: ClassVar[str] = "rests at several levels at the beginning and at the end"
    source: ClassVar[str] = "a constant rate"
    amplitude: ClassVar[str] = "rate"
    changes_sign: ClassVar[bool] = True

    @abstractmethod
    def largest(self, scale: Scale) -> tuple[float, str]:
        """The rate that changes as much as there is within the longest log, and its unit."""

    def parameters(self, scale: Scale) -> ParameterSet:
        """The rate."""
        largest, unit = self.largest(scale)
        bound, start = LARGEST * largest, START * largest
        rate = Parameter(
            "rate", start, unit, -bound, bound, meaning="rate of change", source=self.source
        )
        return ParameterSet((rate,))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Either way."""
        rate = START * self.largest(scale)[0]
        return ({"rate": rate}, {"rate": -rate})


@dataclass(frozen=True)
class LoadDrift(ConstantRate, StateEffect):
    """A load that changes at a constant rate, + f t."""

    name: ClassVar[str] = "load_drift"
    title: ClassVar[str] = "Load that changes"
    law: ClassVar[str] = "+ f t"
    meaning: ClassVar[str] = "What the actuator carries grows or shrinks at a constant rate."
    signature: ClassVar[str] = "The residual grows with time, most where the actuator is soft."
    remedy: ClassVar[str] = "weigh the load before and after"

    def largest(self, scale: Scale) -> tuple[float, str]:
        """The elastic force within the log."""
        return scale.force / scale.duration_s, f"{scale.force_unit}/s"

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Resisting force f t."""
        out[FORCE] += eta[0] * t


@dataclass(frozen=True)
class PressureGainDrift(ConstantRate, InputEffect):
    """A pressure that falls behind the recorded one more and more, u (1 + g t)."""

    name: ClassVar[str] = "pressure_gain_drift"
    title: ClassVar[str] = "Pressure that falls behind"
    law: ClassVar[str] = "arriving u = u (1 + g t)"
    meaning: ClassVar[str] = "A leak grows, or the gain of the pressure gauge drifts."
    signature: ClassVar[str] = "The residual grows with time and with the pressure."
    remedy: ClassVar[str] = "look for a leak, calibrate the gauge"

    def largest(self, scale: Scale) -> tuple[float, str]:
        """All of the pressure within the log."""
        return 1.0 / scale.duration_s, "1/s"

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Multiply by 1 + g t."""
        del scale
        arriving: Array = u * (1.0 + eta[0] * time_s)
        return arriving


@dataclass(frozen=True)
class PressureDrift(ConstantRate, InputEffect):
    """A pressure whose zero drifts, u + d t."""

    name: ClassVar[str] = "pressure_drift"
    title: ClassVar[str] = "Drift of the pressure's zero"
    law: ClassVar[str] = "arriving u = u + d t"
    meaning: ClassVar[str] = "The zero of the pressure gauge drifts at a constant rate."
    signature: ClassVar[str] = "The residual grows with time, most where the output is steep."
    remedy: ClassVar[str] = "read the gauge vented before and after"

    def largest(self, scale: Scale) -> tuple[float, str]:
        """The range of the pressure within the log."""
        return scale.u_span / scale.duration_s, f"{scale.u_unit}/s"

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Add d t."""
        del scale
        arriving: Array = u + eta[0] * time_s
        return arriving


UNLISTED_LAWS: tuple[type[StateEffect | InputEffect], ...] = (
    LoadDrift,
    PressureGainDrift,
    PressureDrift,
)


def with_unlisted_rivals(
    links: Sequence[Link], is_named: Sequence[bool], final: Candidate, base: BaseFit
) -> list[Link]:
    """The links; those of drifts with what explains the logs as well in place of all of them.

    In a linear model each of these laws is a line on the output or a gain of it, which its class of
    equivalence tells.

    Parameters
    ----------
    links
        The chain.
    is_named
        Which of them may be named.
    final
        The model with all causes.
    base
        What the chain begins with.
    """
    pairs = list(zip(links, is_named, strict=True))
    drifts = {link.added.name for link, named in pairs if named} & set(DRIFTS)
    if not drifts or final.problem.model.is_linear:
        return list(links)
    others = in_parallel(lambda law: _in_place_of(drifts, law(), final, base), UNLISTED_LAWS)
    ranked = rank([final, *others], base.sigma)
    known = next(row.bic for row in ranked if row.candidate.keys == final.keys)
    alike = [row for row in ranked if row.bic < known + INDISTINCT]
    rivals = [row.candidate.effects[-1].name for row in alike if row.candidate.keys != final.keys]
    return [
        replace(link, rivals=(*link.rivals, *rivals)) if link.added.name in drifts else link
        for link in links
    ]


def _in_place_of(drifts: set[str], law: Effect, final: Candidate, base: BaseFit) -> Candidate:
    """The model with a law in the place of drifts, refitted."""
    scale, known = base.scale, final.problem
    effects = (*(effect for effect in final.effects if effect.name not in drifts), law)
    problem = extend(base.candidate.problem, effects, scale)
    starts = [
        start_unknowns(problem, known, final.minimum.point, named_values(law, values))
        for values in law.starts(scale)
    ]
    z = min(starts, key=lambda start: squares_at(problem, start, base.sigma))
    return advance(begun(final, effects, problem, z), base.sigma, REFITTING)
