"""The effects, by key. A new effect is one file and one line in `EFFECTS`."""

from softid.effects.base import (
    Effect,
    InputEffect,
    OutputEffect,
    Scale,
    StateEffect,
)
from softid.effects.clock_rate import ClockRate
from softid.effects.creep import Creep
from softid.effects.dead_zone import DeadZone
from softid.effects.delay import Delay
from softid.effects.extended import ExtendedModel
from softid.effects.line_resonance import LineResonance
from softid.effects.pneumatic_lag import PneumaticLag, SeparatePneumaticLag
from softid.effects.sensor_clipping import (
    BothSensorClipping,
    LowerSensorClipping,
    SensorClipping,
)
from softid.effects.sensor_drift import SensorDrift
from softid.effects.sensor_lag import SensorLag
from softid.effects.sensor_warmup import SensorWarmup
from softid.effects.valve_flow import ValveFlow

INPUT: tuple[type[Effect], ...] = (
    Delay,
    PneumaticLag,
    SeparatePneumaticLag,
    LineResonance,
    ValveFlow,
    DeadZone,
)
STATE: tuple[type[Effect], ...] = (Creep,)
OUTPUT: tuple[type[Effect], ...] = (
    SensorDrift,
    SensorWarmup,
    SensorLag,
    SensorClipping,
    LowerSensorClipping,
    BothSensorClipping,
    ClockRate,
)
EFFECTS: dict[str, type[Effect]] = {effect().key: effect for effect in (*INPUT, *STATE, *OUTPUT)}

__all__ = [
    "EFFECTS",
    "Effect",
    "ExtendedModel",
    "InputEffect",
    "OutputEffect",
    "Scale",
    "StateEffect",
]
