"""The models, by name. A new model is one file and one line in `MODELS`."""

from softid.models import zhao2021, zhao2021_theory
from softid.models.actuator_geometry import load_actuator
from softid.models.base import Model, Response
from softid.models.equilibrium import Equilibrium
from softid.models.muscle import Muscle
from softid.models.oscillator import Oscillator
from softid.models.polynomial import Polynomial
from softid.models.yeoh import Yeoh

MODELS: dict[str, type[Model]] = {
    Muscle.name: Muscle,
    Oscillator.name: Oscillator,
    Polynomial.name: Polynomial,
    Yeoh.name: Yeoh,
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
    "Yeoh",
    "load_actuator",
    "zhao2021",
    "zhao2021_theory",
]
