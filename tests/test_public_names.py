"""The public face: a name that goes or comes is a decision, so it is written down here too."""

from __future__ import annotations

import pytest
from fresh_process import printed_by

import softid

VERBS = (
    "bootstrap_parameters",
    "diagnose",
    "fit",
    "inspect",
    "load",
    "profile_parameter",
    "register_effect",
    "self_check",
    "simulate",
    "synthesize",
    "validate",
)
RECORDS = (
    "load_actuator",
    "load_params",
    "load_recipe",
    "save_diagnosis",
    "save_fit",
    "save_validation",
)
TYPES = (
    "Diagnosis",
    "Equilibrium",
    "FitResult",
    "FitStatus",
    "Log",
    "LogSet",
    "Model",
    "Muscle",
    "Oscillator",
    "Parameter",
    "ParameterSet",
    "Polynomial",
    "SavedModel",
    "Simulation",
    "Validation",
    "Yeoh",
)
ERRORS = (
    "IdentificationError",
    "InputError",
    "Issue",
    "MissingExtraError",
    "OutputError",
    "SoftidError",
    "UsageError",
)
PUBLIC = {"MODELS", *VERBS, *RECORDS, *TYPES, *ERRORS}


def test_the_names_are_these() -> None:
    """Stands on the lists above; users' code stands on them too."""
    assert set(softid.__all__) == PUBLIC
    assert set(dir(softid)) >= PUBLIC


@pytest.mark.parametrize("name", sorted(PUBLIC))
def test_every_name_is_there_and_described(name: str) -> None:
    """A lazy name that points to the wrong module would only fail when it is used."""
    value = getattr(softid, name)
    if callable(value):
        assert value.__doc__
        assert value.__module__.split(".")[0] == "softid"


def test_an_unknown_name_is_an_attribute_error() -> None:
    """So that hasattr and star imports work as everywhere in Python."""
    with pytest.raises(AttributeError, match="no attribute 'fitt'"):
        getattr(softid, "fitt")  # noqa: B009 - the name must not be checked before it runs


@pytest.mark.parametrize(
    "protocol",
    [
        "muscle.levels",
        "muscle.extremes",
        "muscle.damping_surface",
        "muscle.sequential",
        "polynomial.quartic",
        "equilibrium.by_hand",
    ],
)
def test_the_papers_protocols_are_there_by_name(protocol: str) -> None:
    """In a process of its own, for any import of softid.fitters makes it an attribute of softid."""
    code = f"import softid; print(softid.fitters.{protocol}.__doc__[:1], 'fitters' in dir(softid))"
    assert printed_by(code).strip().endswith("True")
    module = protocol.split(".")[0]
    assert module in dir(softid.fitters)


def test_importing_softid_is_free() -> None:
    """Every library is imported by the function that needs it; numpy costs 0.1 s already."""
    code = "import sys, softid; print(sorted({'numpy', 'scipy', 'numba'} & set(sys.modules)))"
    assert printed_by(code) == "[]\n"
