"""`softid effects`: the catalogue is complete and says what the effects say."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest
from desk import Outcome

from softid.effects import EFFECTS, confusable_with
from softid_cli.effects import example_scale

Cli = Callable[..., Outcome]


def test_the_list_names_all_by_stage(softid: Cli) -> None:
    """Stands on the table of effects; a stage's effects follow its heading."""
    told = softid("effects")
    assert told.code == 0
    lines = told.out.splitlines()
    assert max(map(len, lines)) <= 80
    places = {
        key: next(i for i, line in enumerate(lines) if line.split()[:1] == [key]) for key in EFFECTS
    }
    heading = next(i for i, line in enumerate(lines) if line.startswith("In the equation"))
    for key, effect in EFFECTS.items():
        assert (places[key] < heading) is (effect.stage == "input")


@pytest.mark.parametrize("key", sorted(EFFECTS))
def test_an_effect_is_explained(softid: Cli, key: str) -> None:
    """Law, meaning, signature, neighbours, remedy, experiment, and parameters with units."""
    effect = EFFECTS[key]()
    told = softid("effects", key)
    words = " ".join(told.out.split())
    assert told.code == 0
    for text in (effect.law, effect.meaning, effect.signature, effect.shown_by, effect.remedy):
        assert " ".join(text.split()) in words
    for neighbour in confusable_with(effect):
        assert neighbour in words
    for parameter in effect.parameters(example_scale()).values():
        assert f"{parameter.name} {parameter.unit}" in words
    assert max(map(len, told.out.splitlines())) <= 80


def test_json_is_the_whole_catalogue(softid: Cli) -> None:
    """One entry per key, in the order of the table; bounds hold the start."""
    catalogue = json.loads(softid("effects", "--json").out)
    assert [entry["name"] for entry in catalogue] == list(EFFECTS)
    for entry in catalogue:
        for parameter in entry["parameters"]:
            assert parameter["lower"] <= parameter["start"] <= parameter["upper"]
    (lag,) = json.loads(softid("effects", "pneumatic_lag", "--json").out)
    assert lag["law"] == "tau pa' + pa = p"


@pytest.mark.parametrize(
    ("typed", "meant"),
    [("delays", "delay"), ("Lag", "sensor_lag"), ("clipping", "sensor_clipping")],
)
def test_an_unknown_effect(softid: Cli, typed: str, meant: str) -> None:
    """Exit code 2 and what was probably meant."""
    told = softid("effects", typed)
    assert told.code == 2
    assert "there is no such effect" in told.err
    assert meant in told.err
    assert "register" not in told.err  # which only a script can
