"""The models, by name. A new model is one file and one line in `MODELS`."""

from softid.models import zhao2021, zhao2021_theory
from softid.models.base import Model, Response
from softid.models.muscle import Muscle
from softid.models.oscillator import Oscillator
from softid.models.polynomial import Polynomial
from softid.models.yeoh import Yeoh

MODELS: dict[str, type[Model]] = {
    Muscle.name: Muscle,
    Oscillator.name: Oscillator,
    Polynomial.name: Polynomial,
    Yeoh.name: Yeoh,
}

__all__ = [
    "MODELS",
    "Model",
    "Muscle",
    "Oscillator",
    "Polynomial",
    "Response",
    "Yeoh",
    "zhao2021",
    "zhao2021_theory",
]
