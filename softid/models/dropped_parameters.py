"""Which choice of a model's options drops one of its parameters."""

from __future__ import annotations

import typing
from dataclasses import fields, replace

from softid.errors import UsageError
from softid.models.base import Model


def option_that_drops(model: Model, parameter: str) -> tuple[str, str] | None:
    """Option and choice with which a model holds a parameter at zero.

    Where several choices do, the one that drops the fewest others; None where none does, or the
    model holds the parameter already.

    Parameters
    ----------
    model
        The model with its options.
    parameter
        Name of one of its parameters.

    Examples
    --------
    >>> from softid.models import MODELS
    >>> option_that_drops(MODELS["oscillator"](), "Q")
    ('spring', 'none')
    """
    free = model.parameters().free
    if parameter not in free:
        return None
    found: list[tuple[int, str, str]] = []
    for option, choice in _choices(model):
        try:
            declared = replace(model, **{option: choice}).parameters()
        except UsageError:  # the choice does not go with the other options
            continue
        if declared[parameter].fixed and declared[parameter].value == 0.0:
            found.append((len(set(free) - set(declared.free)), option, choice))
    return min(found)[1:] if found else None


def _choices(model: Model) -> list[tuple[str, str]]:
    """Every option with each of its words."""
    hints = typing.get_type_hints(type(model))
    return [
        (f.name, choice)
        for f in fields(model)
        if typing.get_origin(hints[f.name]) is typing.Literal
        for choice in typing.get_args(hints[f.name])
    ]
