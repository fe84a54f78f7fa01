"""The effects, by key: a new effect is one file and one line in the table of its stage."""

from softid.effects.ageing import Ageing
from softid.effects.asymmetric_damping import AsymmetricDamping
from softid.effects.base import Effect
from softid.effects.clock_rate import ClockRate
from softid.effects.contact import Contact, LowerContact
from softid.effects.coulomb_friction import CoulombFriction, PressureFriction, StribeckFriction
from softid.effects.creep import Creep, SeriesCreep
from softid.effects.dead_zone import DeadZone
from softid.effects.delay import Delay
from softid.effects.hysteresis import BranchHysteresis, Hysteresis, PressureHysteresis
from softid.effects.line_resonance import LineResonance
from softid.effects.pneumatic_lag import (
    LevelPneumaticLag,
    PneumaticLag,
    SeparatePneumaticLag,
)
from softid.effects.pressure_mass import PressureMass
from softid.effects.quadratic_damping import PowerDamping, QuadraticDamping
from softid.effects.relaxation import Relaxation
from softid.effects.sensor_clipping import (
    BothSensorClipping,
    LowerSensorClipping,
    SensorClipping,
)
from softid.effects.sensor_drift import SensorDrift
from softid.effects.sensor_gain_drift import SensorGainDrift
from softid.effects.sensor_lag import SensorLag
from softid.effects.sensor_resonance import SensorResonance
from softid.effects.sensor_warmup import SensorWarmup
from softid.effects.smoothing import MeanSmoothing, PastSmoothing, Smoothing
from softid.effects.softening import Softening
from softid.effects.static_curve import StaticCurve
from softid.effects.stiffening import Stiffening
from softid.effects.valve_flow import SeparateValveFlow, ValveFlow

INPUT: tuple[type[Effect], ...] = (
    Delay,
    PneumaticLag,
    SeparatePneumaticLag,
    LevelPneumaticLag,
    LineResonance,
    ValveFlow,
    SeparateValveFlow,
    DeadZone,
)
STATE: tuple[type[Effect], ...] = (
    StaticCurve,
    Stiffening,
    Contact,
    LowerContact,
    QuadraticDamping,
    PowerDamping,
    AsymmetricDamping,
    CoulombFriction,
    StribeckFriction,
    PressureFriction,
    Hysteresis,
    BranchHysteresis,
    PressureHysteresis,
    Creep,
    Softening,
    Ageing,
    PressureMass,
)
OUTPUT: tuple[type[Effect], ...] = (
    SeriesCreep,
    Relaxation,
    SensorDrift,
    SensorGainDrift,
    SensorWarmup,
    SensorLag,
    SensorResonance,
    Smoothing,
    MeanSmoothing,
    PastSmoothing,
    SensorClipping,
    LowerSensorClipping,
    BothSensorClipping,
    ClockRate,
)
EFFECTS: dict[str, type[Effect]] = {effect().key: effect for effect in (*INPUT, *STATE, *OUTPUT)}


def confusable_with(effect: Effect) -> tuple[str, ...]:
    """Names of the effects that one can be confused with: its own neighbours, then whose it is.

    To be confused is mutual, though one of two may name the other alone, as a new effect does.

    Parameters
    ----------
    effect
        An effect, which need not be in the table.

    Examples
    --------
    >>> confusable_with(SensorLag())
    ('pneumatic_lag', 'delay', 'clock_rate', 'sensor_resonance', 'line_resonance', 'smoothing')
    """
    naming = [other.name for other in EFFECTS.values() if effect.name in other.neighbours]
    return tuple(dict.fromkeys((*effect.neighbours, *naming)))
