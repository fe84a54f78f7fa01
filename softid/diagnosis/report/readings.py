"""Limits and places of causes as the logs read them, with the sensor zeros."""

from __future__ import annotations

import math

import numpy as np

from softid.diagnosis.report.phrases import FEWEST_DIGITS
from softid.diagnosis_results import Cause, Diagnosis
from softid.effects import EFFECTS
from softid.effects.base import Effect, StateEffect
from softid.errors import Issue
from softid.interval_words import number_in_words
from softid.models.base import Model
from softid.results import FitResult, ParameterEstimate
from softid.sentences import listed

TOLD_READING = "told-reading"
"""Code of the remark that says at which reading a cause acts."""

LEAST_ZERO = 0.01
"""Share of the range of the first output from which a sensor zero makes a difference, though the
value is not known so well."""

MOST_LOGS = 3
"""The readings in more logs are not told."""


def reading_issues(found: Diagnosis, model: Model) -> tuple[Issue, ...]:
    """Readings at which causes act whose parameters are stored without the sensor zeros.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    model
        What its causes extend, which says what an output reads where the motion is.
    """
    if found.extended is None:
        return ()
    causes = (*found.causes, *found.descriptive)
    told = (_told(cause, found.extended, model) for cause in causes if cause.key in EFFECTS)
    return tuple(issue for issue in told if issue is not None)


def _told(cause: Cause, extended: FitResult, model: Model) -> Issue | None:
    effect = EFFECTS[cause.key]
    first = extended.outputs[0]
    row = next(s for s in extended.statistics if s.channel == first)
    low, high = extended.fitted_range[first]
    logs = {s.log for s in extended.statistics if s.in_sample}
    zeros = {n.log: n.zero[first] for n in extended.nuisances if n.log in logs and first in n.zero}
    largest = max(map(abs, zeros.values()), default=0.0)
    if len(zeros) > MOST_LOGS:
        return None
    of = {f"{cause.effect}_{name}": name for name in effect.readings}
    parts = []
    for p in cause.parameters:
        name = of.get(p.name)
        if name is None or p.unit != row.unit:
            continue
        at = _without_zero(effect, model, first, p.value)
        if at == p.value and largest < min(LEAST_ZERO * (high - low), _half_width(p)):
            continue
        where = [
            f"{_in_words(at + zero, p, row.display_factor)} {row.display_unit} in {log}"
            for log, zero in zeros.items()
        ]
        parts.append(f"{name} is a reading of {listed(where)}")
    if not parts:
        return None
    return Issue(TOLD_READING, "info", f"{cause.key}: {'; '.join(parts)}")


def _without_zero(effect: type[Effect], model: Model, output: str, value: float) -> float:
    """What an output reads at a limit of it, or at a place of the motion, without a sensor zero."""
    if not issubclass(effect, StateEffect):
        return value
    return float(model.observed(np.array([value]), output)[0][0])


def _in_words(reading: float, p: ParameterEstimate, factor: float) -> str:
    """A reading with as many digits as the parameter has by itself."""
    return number_in_words(reading * factor, p, fewest_digits=FEWEST_DIGITS)


def _half_width(p: ParameterEstimate) -> float:
    """Half of the interval of a value; infinite without one."""
    return 0.5 * (p.ci95[1] - p.ci95[0]) if p.ci95 is not None else math.inf
