"""The models, by name. A new model is one file and one line in `MODELS`."""

from softid.models.actuator_geometry import load_actuator
from softid.models.base import Model, Response
from softid.models.equilibrium import Equilibrium
from softid.models.muscle import Muscle
from softid.models.oscillator import Oscillator
from softid.models.polynomial import Polynomial

MODELS: dict[str, type[Model]] = {
    Muscle.name: Muscle,
    Oscillator.name: Oscillator,
    Polynomial.name: Polynomial,
    Equilibrium.name: Equilibrium,
}

__all__ = [
    "MODELS",
    "Equilibrium",
    "Model",
    "Muscle",
    "Oscillator",
    "Polynomial",
    "Response",
    "load_actuator",
]
