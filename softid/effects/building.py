"""A model built again from its name, its options and its effects."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches

from softid.effects.base import Effect
from softid.effects.catalogue import EFFECTS
from softid.effects.extension.extended_model import ExtendedModel
from softid.effects.scale import Scale
from softid.errors import UsageError, entry_named
from softid.models import MODELS, Model
from softid.results import ModelSpec


def model_of(spec: ModelSpec) -> Model:
    """The model that a specification describes, extended by its effects if it has any.

    Parameters
    ----------
    spec
        Name and options of the model, keys of the effects, and the scale that these go by.

    Returns
    -------
    Model
        One whose ``spec()`` is equal to ``spec``.

    Raises
    ------
    UsageError
        There is no such model or effect, or the scale is not complete.

    Examples
    --------
    >>> model_of(ModelSpec("oscillator", {"order": "first"})).parameters().free
    ('N', 'Q')
    """
    model = entry_named(spec.name, MODELS, unknown="there is no such model")
    base: Model = model(**spec.options)
    if not spec.effects:
        return base
    effects = tuple(effect_of(key) for key in spec.effects)
    try:
        scale = Scale(**spec.scale)  # type: ignore[arg-type]
    except TypeError as error:
        raise UsageError(
            f"the effects' scale is not complete ({error})",
            remedy="take the scale from the fit that the effects were made for",
        ) from error
    return ExtendedModel(base, effects, scale)


def effect_of(key: str) -> Effect:
    """The effect of a key.

    Raises
    ------
    UsageError
        There is none; the error proposes the nearest.
    """
    if key not in EFFECTS:
        raise UsageError(
            "there is no such effect",
            value=key,
            remedy=f"{proposed_effects(key)}; one of your own must be registered first, with "
            "softid.register_effect",
        )
    return EFFECTS[key]()


def proposed_effects(name: str) -> str:
    """What to say to whoever named an effect that there is not: the nearest, and where all are."""
    close = get_close_matches(name.lower(), EFFECTS, n=3, cutoff=0.5)
    if name:
        close += [known for known in EFFECTS if name.lower() in known and known not in close]
    proposal = f"did you mean {' or '.join(close)}? " if close else ""
    return f"{proposal}`softid effects` lists all"


def effects_of(keys: Sequence[str] = ()) -> tuple[Effect, ...]:
    """The effects of some keys; without any, all of the table.

    Raises
    ------
    UsageError
        A key is none.
    """
    return tuple(effect_of(key) for key in (keys or EFFECTS))
