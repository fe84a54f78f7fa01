"""softid: from a log of a soft pneumatic actuator to a model that can be trusted."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from softid.diagnosis import diagnose
    from softid.diagnosis_results import Diagnosis
    from softid.effects import register_effect
    from softid.errors import (
        IdentificationError,
        InputError,
        Issue,
        MissingExtraError,
        OutputError,
        SoftidError,
        UsageError,
    )
    from softid.identification import bootstrap_parameters, fit, profile_parameter
    from softid.log import Log, LogSet
    from softid.models import (
        MODELS,
        Equilibrium,
        Model,
        Muscle,
        Oscillator,
        Polynomial,
        Yeoh,
        load_actuator,
    )
    from softid.parameters import Parameter, ParameterSet
    from softid.prediction import simulate
    from softid.quality import inspect
    from softid.readers import load
    from softid.records import SavedModel, load_params, save_diagnosis, save_fit, save_validation
    from softid.results import FitResult, FitStatus, Simulation, Validation
    from softid.synthesis import load_recipe, synthesize
    from softid.validation import self_check, validate

_HOME = {
    "Diagnosis": "softid.diagnosis_results",
    "diagnose": "softid.diagnosis",
    "register_effect": "softid.effects",
    "IdentificationError": "softid.errors",
    "InputError": "softid.errors",
    "Issue": "softid.errors",
    "MissingExtraError": "softid.errors",
    "OutputError": "softid.errors",
    "SoftidError": "softid.errors",
    "UsageError": "softid.errors",
    "bootstrap_parameters": "softid.identification",
    "fit": "softid.identification",
    "profile_parameter": "softid.identification",
    "Log": "softid.log",
    "LogSet": "softid.log",
    "MODELS": "softid.models",
    "Equilibrium": "softid.models",
    "load_actuator": "softid.models",
    "Model": "softid.models",
    "Muscle": "softid.models",
    "Oscillator": "softid.models",
    "Polynomial": "softid.models",
    "Yeoh": "softid.models",
    "Parameter": "softid.parameters",
    "ParameterSet": "softid.parameters",
    "simulate": "softid.prediction",
    "inspect": "softid.quality",
    "load": "softid.readers",
    "SavedModel": "softid.records",
    "load_params": "softid.records",
    "save_diagnosis": "softid.records",
    "save_fit": "softid.records",
    "save_validation": "softid.records",
    "FitResult": "softid.results",
    "FitStatus": "softid.results",
    "Simulation": "softid.results",
    "Validation": "softid.results",
    "load_recipe": "softid.synthesis",
    "synthesize": "softid.synthesis",
    "self_check": "softid.validation",
    "validate": "softid.validation",
}

__all__ = [
    "MODELS",
    "Diagnosis",
    "Equilibrium",
    "FitResult",
    "FitStatus",
    "IdentificationError",
    "InputError",
    "Issue",
    "Log",
    "LogSet",
    "MissingExtraError",
    "Model",
    "Muscle",
    "Oscillator",
    "OutputError",
    "Parameter",
    "ParameterSet",
    "Polynomial",
    "SavedModel",
    "Simulation",
    "SoftidError",
    "UsageError",
    "Validation",
    "Yeoh",
    "bootstrap_parameters",
    "diagnose",
    "fit",
    "inspect",
    "load",
    "load_actuator",
    "load_params",
    "load_recipe",
    "profile_parameter",
    "register_effect",
    "save_diagnosis",
    "save_fit",
    "save_validation",
    "self_check",
    "simulate",
    "synthesize",
    "validate",
]


def __getattr__(name: str) -> object:
    """Import a public name when it is first used, so that `import softid` costs nothing."""
    if name == "__version__":
        return import_module("importlib.metadata").version("softid")
    if name == "fitters":
        return import_module("softid.fitters")
    if name not in _HOME:
        raise AttributeError(f"module 'softid' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "fitters"})
