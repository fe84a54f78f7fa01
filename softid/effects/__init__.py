"""The effects, by key. A new effect is one file and one line in `softid.effects.catalogue`."""

from softid.effects.base import Effect, InputEffect, OutputEffect, StateEffect
from softid.effects.building import effect_of, effects_of, model_of, proposed_effects
from softid.effects.catalogue import EFFECTS, confusable_with
from softid.effects.extension.extended_model import (
    ExtendedModel,
    belongs_to,
    extended_name,
    own_values,
)
from softid.effects.registration import register_effect
from softid.effects.scale import Scale

__all__ = [
    "EFFECTS",
    "Effect",
    "ExtendedModel",
    "InputEffect",
    "OutputEffect",
    "Scale",
    "StateEffect",
    "belongs_to",
    "confusable_with",
    "effect_of",
    "effects_of",
    "extended_name",
    "model_of",
    "own_values",
    "proposed_effects",
    "register_effect",
]
