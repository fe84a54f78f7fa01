"""The effects, by key. A new effect is one file and one line in `EFFECTS`."""

from softid.effects.base import (
    Effect,
    InputEffect,
    OutputEffect,
    Scale,
    StateEffect,
)
from softid.effects.creep import Creep
from softid.effects.extended import ExtendedModel
from softid.effects.sensor_drift import SensorDrift

EFFECTS: dict[str, type[Effect]] = {effect().key: effect for effect in (Creep, SensorDrift)}

__all__ = [
    "EFFECTS",
    "Effect",
    "ExtendedModel",
    "InputEffect",
    "OutputEffect",
    "Scale",
    "StateEffect",
]
