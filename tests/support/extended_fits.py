"""Results of extended models made by hand, so that their records and tables need no fit."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from handmade import fit_result
from textbook_effects import MUSCLE, OSCILLATOR, driven, sizes

from softid.effects import EFFECTS, ExtendedModel, Scale
from softid.log import Log
from softid.models import Muscle, Oscillator
from softid.models.base import Model
from softid.results import FitResult, ParameterEstimate

BASES: dict[str, tuple[Model, np.ndarray]] = {
    "muscle": (Muscle(x_unit="rad"), MUSCLE),
    "oscillator": (Oscillator(x_unit="rad", u_unit="kPa"), OSCILLATOR),
}


@cache
def log_of(base: str) -> Log:
    """The drive of the tests of effects, with an angle so that a log needs no more."""
    drive = driven(base)
    return Log.from_arrays(
        drive.time_s, {"pressure": drive.input, "angle": 0.1 * np.sin(drive.time_s)}, name="step_1"
    )


@cache
def scale_of(base: str) -> Scale:
    return replace(
        sizes(base, driven(base)), u_unit="kPa", x_unit="rad", y_unit="rad", force_unit="kPa"
    )


def estimate(name: str, value: float, unit: str, lower: float, upper: float) -> ParameterEstimate:
    low, high = (float(b) if np.isfinite(b) else None for b in (lower, upper))
    return ParameterEstimate(
        name, unit, value, None, None, None, low, high, False, None, False, "identified"
    )


def extended_fit(base: str, *keys: str) -> FitResult:
    """A result as a fit of the extended model would give it, each effect at its first start."""
    model, theta = BASES[base]
    scale = scale_of(base)
    effects = tuple(EFFECTS[key]() for key in keys)
    extended = ExtendedModel(model, effects, scale)
    values = dict(zip(model.parameters().names, theta.tolist(), strict=True))
    for effect in extended.effects:
        start = effect.starts(scale)[0]
        values |= {f"{effect.name}_{name}": value for name, value in start.items()}
    estimates = [
        estimate(name, values[name], p.unit, min(p.lower, values[name]), max(p.upper, values[name]))
        for name, p in extended.parameters().items()
    ]
    return replace(fit_result(), model=extended.spec(), parameters=tuple(estimates), derived={})
