"""The effects, by key. A new effect is one file and one line in `EFFECTS`."""

from softid.effects.ageing import Ageing
from softid.effects.asymmetric_damping import AsymmetricDamping
from softid.effects.base import (
    Effect,
    InputEffect,
    OutputEffect,
    Scale,
    StateEffect,
)
from softid.effects.contact import Contact
from softid.effects.coulomb_friction import CoulombFriction, StribeckFriction
from softid.effects.creep import Creep
from softid.effects.extended import ExtendedModel
from softid.effects.hysteresis import Hysteresis
from softid.effects.pressure_mass import PressureMass
from softid.effects.quadratic_damping import QuadraticDamping
from softid.effects.sensor_drift import SensorDrift
from softid.effects.softening import Softening
from softid.effects.static_curve import StaticCurve
from softid.effects.stiffening import Stiffening

EFFECTS: dict[str, type[Effect]] = {
    effect().key: effect
    for effect in (
        StaticCurve,
        Stiffening,
        Contact,
        QuadraticDamping,
        AsymmetricDamping,
        CoulombFriction,
        StribeckFriction,
        Hysteresis,
        Creep,
        Softening,
        Ageing,
        PressureMass,
        SensorDrift,
    )
}

__all__ = [
    "EFFECTS",
    "Effect",
    "ExtendedModel",
    "InputEffect",
    "OutputEffect",
    "Scale",
    "StateEffect",
]
