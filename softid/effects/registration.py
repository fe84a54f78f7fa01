"""Effects of users' own: checked, then put into the table."""

from __future__ import annotations

import inspect
import keyword
from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from softid.effects.base import Effect, InputEffect, OutputEffect, StateEffect
from softid.effects.catalogue import EFFECTS
from softid.effects.scale import Scale
from softid.errors import UsageError
from softid.parameters import ParameterSet
from softid.sentences import listed

Kind = TypeVar("Kind", bound=type[Effect])

STAGES: tuple[type[Effect], ...] = (InputEffect, StateEffect, OutputEffect)
WORDS = ("title", "law", "meaning", "signature", "shown_by", "source")

SAMPLES = 200
"""Times at which an effect's law is tried, two seconds of the example: one period of a sine."""

EXAMPLE = Scale(
    u_low=0.0,
    u_high=200.0,
    x_low=0.0,
    x_high=1.5,
    v_max=3.0,
    force=1.0,
    y_low=0.0,
    y_high=1.5,
    period_s=0.01,
    duration_s=60.0,
    motion_s=0.5,
    travel=50.0,
    x_unit="rad",
    y_unit="rad",
)
"""Sizes of an ordinary log, for which an effect is tried."""


def register_effect(effect_class: Kind) -> Kind:
    """Add an effect of your own to the table, as a function or as a decorator.

    From then on it can extend a model, is a candidate of every diagnosis, and a params.json that
    holds it can be read. It lasts as long as the process.

    Parameters
    ----------
    effect_class
        A subclass of `InputEffect`, `StateEffect` or `OutputEffect` that can be made without
        arguments (``from softid.effects import OutputEffect``).

    Returns
    -------
    type
        The same class.

    Raises
    ------
    UsageError
        A word is missing, the key is taken by another class, a parameter has no finite bounds, a
        start is not complete, or the law cannot be applied to an ordinary log.

    Examples
    --------
    >>> from softid import Parameter, ParameterSet, register_effect
    >>> from softid.effects import EFFECTS, OutputEffect
    >>> @register_effect
    ... class SensorGlow(OutputEffect):
    ...     name, title, amplitude = "sensor_glow", "Sensor that glows", "k"
    ...     law, source = "y (1 + k y)", "own"
    ...     meaning, signature = "The sensor is nonlinear.", "A parabola against the output."
    ...     shown_by = "the full range"
    ...
    ...     def parameters(self, scale):
    ...         return ParameterSet((Parameter("k", 1e-3, f"1/{scale.y_unit}", 0.0, 0.1),))
    ...
    ...     def starts(self, scale):
    ...         return ({"k": 0.01 / scale.y_span},)
    ...
    ...     def apply(self, eta, time_s, y, scale):
    ...         return y * (1.0 + eta[0] * y)
    >>> EFFECTS.pop("sensor_glow") is SensorGlow
    True
    """
    effect = _made(effect_class)
    where = f"effect {effect_class.__name__}"
    _check_words(effect, where)
    known = EFFECTS.get(effect.key)
    if known is not None and not _same_place(known, effect_class):
        raise UsageError(
            "another effect has this name", where=where, value=effect.key, remedy="choose another"
        )
    declared = _check_parameters(effect, where)
    starts = _check_starts(effect, declared, where)
    _check_law(effect, starts, where)
    EFFECTS[effect.key] = effect_class
    return effect_class


def _same_place(known: type[Effect], new: type[Effect]) -> bool:
    """Whether it is the same class made anew, as in a notebook whose cell runs twice."""
    return (known.__module__, known.__qualname__) == (new.__module__, new.__qualname__)


def _made(effect_class: type[Effect]) -> Effect:
    if not (isinstance(effect_class, type) and issubclass(effect_class, STAGES)):
        raise UsageError(
            "this is not an effect",
            value=effect_class,
            remedy="make it a subclass of softid.effects.InputEffect, StateEffect or OutputEffect",
        )
    try:
        return effect_class()
    except TypeError as error:
        raise UsageError(
            f"it cannot be made ({error})",
            where=f"effect {effect_class.__name__}",
            remedy="define parameters, starts and step or apply, and give every field a default",
        ) from error


def _check_words(effect: Effect, where: str) -> None:
    missing = [name for name in ("name", "amplitude", *WORDS) if not hasattr(effect, name)]
    missing += [name for name in WORDS if name not in missing and not getattr(effect, name)]
    if missing:
        raise UsageError(
            f"{listed(missing)} must be said",
            where=where,
            remedy="set it as a class attribute; `softid effects delay` shows what it is for",
        )
    _check_name(effect, where)
    known = {key.split(".")[0] for key in EFFECTS} | {effect.name}
    for role, names in (("neighbour", effect.neighbours), ("drawn effect", effect.draws)):
        strange = [name for name in names if name not in known]
        if strange:
            raise UsageError(
                f"a {role} is no effect",
                where=where,
                value=strange[0],
                remedy=f"choose from {', '.join(sorted(known))}",
            )


def _check_name(effect: Effect, where: str) -> None:
    for part in (effect.name, *([effect.variant] if effect.variant else [])):
        if not part.isidentifier() or keyword.iskeyword(part) or part != part.lower():
            raise UsageError(
                "this is not a name in lower case",
                where=where,
                value=part,
                remedy="write it like pneumatic_lag",
            )
    others = {key.split(".")[0] for key in EFFECTS} - {effect.name}
    for other in sorted(others):
        if other.startswith(f"{effect.name}_") or effect.name.startswith(f"{other}_"):
            raise UsageError(
                f"parameters of {other} would look like its own",
                where=where,
                value=effect.name,
                remedy="choose a name that neither begins another's nor begins with one",
            )


def _check_parameters(effect: Effect, where: str) -> ParameterSet:
    declared = effect.parameters(EXAMPLE)
    if not declared:
        raise UsageError("it has no parameter", where=where, remedy="declare at least one")
    for p in declared.values():
        if not np.isfinite([p.lower, p.upper]).all() or p.lower == p.upper:
            raise UsageError(
                f"{p.name} has no finite bounds",
                where=where,
                value=(p.lower, p.upper),
                remedy="bound it, in terms of the scale that parameters() is given",
            )
    roles = {
        "amplitude": effect.amplitudes,
        "essential parameter": effect.essential,
        "parameter with a ceiling": effect.ceilings,
        "parameter with a floor": effect.floors,
        "parameter of the plain form": (effect.plain_at or ())[:1],
    }
    for role, names in roles.items():
        strange = [name for name in names if name not in declared]
        if strange:
            raise UsageError(
                f"the {role} is none of its parameters",
                where=where,
                value=strange[0],
                remedy=f"choose from {', '.join(declared.names)}, or "
                + ("set amplitude = None" if role == "amplitude" else "leave it out"),
            )
    return declared


def _check_starts(effect: Effect, declared: ParameterSet, where: str) -> list[np.ndarray]:
    starts = effect.starts(EXAMPLE)
    if not starts:
        raise UsageError("it has no start", where=where, remedy="return at least one from starts()")
    for start in starts:
        if set(start) != set(declared.names):
            raise UsageError(
                "a start does not give each parameter one value",
                where=where,
                value=dict(start),
                remedy=f"give {', '.join(declared.names)}",
            )
        for name, value in start.items():
            if not declared[name].lower <= value <= declared[name].upper:
                raise UsageError(
                    f"a start of {name} is outside its bounds",
                    where=where,
                    value=value,
                    remedy=f"keep it within {declared[name].lower:g} and {declared[name].upper:g}",
                )
    return [np.array([start[name] for name in declared], np.float64) for start in starts]


def _check_law(effect: Effect, starts: Sequence[np.ndarray], where: str) -> None:
    """Apply the law at every start to a slow sine over the whole range."""
    time_s = EXAMPLE.period_s * np.arange(SAMPLES, dtype=np.float64)
    wave = 0.5 - 0.5 * np.cos(2.0 * np.pi * time_s / time_s[-1])
    if isinstance(effect, StateEffect):
        _check_step(effect, starts, where)
        return
    assert isinstance(effect, InputEffect | OutputEffect)
    span = EXAMPLE.u_span if isinstance(effect, InputEffect) else EXAMPLE.y_span
    for eta in starts:
        found = np.asarray(effect.apply(eta, time_s, span * wave, EXAMPLE))
        if found.shape != time_s.shape or not np.isfinite(found).all():
            raise UsageError(
                "apply() must return one finite number for each time",
                where=where,
                value=found.shape,
                remedy="return an array of the shape of time_s",
            )


def _check_step(effect: StateEffect, starts: Sequence[np.ndarray], where: str) -> None:
    from softid.kernels.terms import TERM_SIZE

    if not isinstance(inspect.getattr_static(type(effect), "step"), staticmethod):
        raise UsageError("step takes no self", where=where, remedy="write @staticmethod above it")
    for eta in starts:
        whole = np.array([*eta, *effect.constants(EXAMPLE)])
        out = np.zeros(TERM_SIZE)
        middle = 0.5 * (EXAMPLE.x_low + EXAMPLE.x_high)
        effect.step(middle, 0.5 * EXAMPLE.v_max, 0.0, 0.5 * EXAMPLE.u_high, 1.0, whole, out)
        if not np.isfinite(out).all():
            raise UsageError(
                "step() gave a number that is not finite",
                where=where,
                value=out.tolist(),
                remedy="check its law at the values of starts()",
            )
    try:
        effect.address()
    except Exception as error:
        # Any Python may be in it, and numba has many ways to refuse.
        raise UsageError(
            f"step() cannot be compiled ({' '.join(str(error).split())[:200]})",
            where=where,
            remedy="use numbers, the places of softid.kernels.terms and the module math only",
        ) from error
