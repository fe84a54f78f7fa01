"""The simpler model to continue with when the samples cannot show a term."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from softid.models.base import Model
from softid.results import ModelSpec

TOO_LATE = 30.0
"""A spring that would bring the motion back in more lengths of the longest log is none: by the end
of that its force is a thirtieth of the damping's."""

SWING_LEVELS = 9
"""Inputs over the fitted range at which the swing is looked at."""


def simpler_model(
    model: Model,
    values: Mapping[str, float],
    period_s: float,
    input_range: tuple[float, float],
    longest_s: float,
) -> tuple[Model, str] | None:
    """A limit of the model in which a term is dropped that cannot be seen, and why.

    The model's own limit goes by how long the inertia lasts. Weakly damped it lasts, but when it
    swings more than once in two samples everywhere, the samples show an alias of any frequency: a
    staircase sampled once a second was fitted with a mass that was not there. A spring that would
    bring the motion back only long after the logs have ended is none: what pushes a drive about
    passes for one, and what is missing has to lean on it.

    Parameters
    ----------
    model
        The model as fitted.
    values
        Parameter name → fitted value.
    period_s
        Median sampling interval.
    input_range
        Smallest and largest input that was fitted.
    longest_s
        Length of the longest log.
    """
    theta = np.array([values[name] for name in model.parameters().names])
    return (
        model.limit(theta, period_s, input_range)
        or _aliased(model, values, period_s, input_range)
        or _springless(model, values, longest_s)
    )


def _springless(
    model: Model, values: Mapping[str, float], longest_s: float
) -> tuple[Model, str] | None:
    """Without its spring, where a model that may do without one returns too late for the logs."""
    spec = model.spec()
    if spec.options.get("spring") != "linear" or not values["Q"] > 0.0:
        return None
    returns_s = values["N"] / values["Q"]
    if returns_s <= TOO_LATE * longest_s:
        return None
    return _with_options(spec, spring="none"), (
        f"the motion would come back in {returns_s:.2g} s, and the logs end after {longest_s:.2g} s"
    )


def _aliased(
    model: Model,
    values: Mapping[str, float],
    period_s: float,
    input_range: tuple[float, float],
) -> tuple[Model, str] | None:
    spec = model.spec()
    if spec.options.get("order") != "second":
        return None
    slowest_hz = float("inf")
    for level in np.linspace(*input_range, SWING_LEVELS).tolist():
        found = model.speeds(values, level)
        swing_hz, ratio = found.natural_frequency_hz, found.damping_ratio
        if swing_hz is None or ratio is None or ratio >= 1.0:
            return None
        slowest_hz = min(slowest_hz, swing_hz)
    shown_hz = 0.5 / period_s
    if slowest_hz <= shown_hz:
        return None
    return _with_options(spec, order="first"), (
        f"the motion would swing at {slowest_hz:.2g} Hz, and more than {shown_hz:.2g} Hz cannot be "
        "seen at this sampling interval"
    )


def _with_options(spec: ModelSpec, **options: str) -> Model:
    from softid.effects import model_of  # twenty modules, which few fits need

    return model_of(replace(spec, options=dict(spec.options) | options))
