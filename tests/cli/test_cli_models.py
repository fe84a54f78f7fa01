"""`softid models`: the catalogue is complete and says what the models say."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable

import pytest
from desk import Outcome

from softid.models import MODELS
from softid_cli.model_options import follows_from_logs
from softid_cli.models import in_own_units

Cli = Callable[..., Outcome]


def test_the_list_names_all(softid: Cli) -> None:
    """Stands on the table of models."""
    told = softid("models")
    assert told.code == 0
    for name in MODELS:
        assert any(line.startswith(name) for line in told.out.splitlines())


@pytest.mark.parametrize("name", sorted(MODELS))
def test_a_model_is_described(softid: Cli, name: str) -> None:
    """Every parameter with its unit, and the excitation that shows it where the model says so."""
    model = in_own_units(MODELS[name]())
    told = softid("models", name)
    words = " ".join(told.out.split())
    assert told.code == 0
    assert " ".join(model.equation.split()) in words
    for parameter in model.parameters().values():
        assert f"{parameter.name} {parameter.unit}" in words
    assert max(map(len, told.out.splitlines())) <= 80
    options = told.out.partition("\noption")[2]
    for field in dataclasses.fields(model):
        assert (f"\n{field.name} " in options) == (not follows_from_logs(field.name)), field.name


def test_the_choices_of_an_option_are_listed(softid: Cli) -> None:
    """Stands on the model's annotations: the paper's Taylor form and the drift are found here."""
    words = " ".join(softid("models", "equilibrium").out.split())
    assert "kernels exact exact, taylor" in words
    assert "drift none none, linear" in words


def test_json_is_the_whole_catalogue(softid: Cli) -> None:
    """An infinite bound is null, as in params.json."""
    catalogue = json.loads(softid("models", "--json").out)
    assert [entry["name"] for entry in catalogue] == list(MODELS)
    oscillator = next(entry for entry in catalogue if entry["name"] == "oscillator")
    gain = next(p for p in oscillator["parameters"] if p["name"] == "G")
    assert gain["fixed"] is True
    (muscle,) = json.loads(softid("models", "muscle", "--json").out)
    assert [p["name"] for p in muscle["parameters"]] == ["M", "a1", "b1", "c1", "a2", "b2", "c2"]


def test_an_unknown_model(softid: Cli) -> None:
    """Exit code 2 and the choice."""
    told = softid("models", "spring")
    assert told.code == 2
    assert "no such model (got 'spring'); choose from muscle" in told.err
