"""What every effect of the catalogue says of itself: words, law, source and neighbours."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache

import pytest
from printed_laws import unnamed_in
from textbook_effects import driven, sizes

from softid.effects import EFFECTS, Scale, confusable_with

NAMES = (
    "delay", "pneumatic_lag", "line_resonance", "valve_flow", "dead_zone",
    "static_curve", "stiffening", "contact", "quadratic_damping", "asymmetric_damping",
    "coulomb_friction", "hysteresis", "creep", "softening", "ageing", "pressure_mass",
    "sensor_drift", "sensor_gain_drift", "sensor_warmup", "sensor_lag", "sensor_resonance",
    "relaxation", "smoothing", "sensor_clipping", "clock_rate",
)  # fmt: skip


@cache
def muscle_scale() -> Scale:
    """The sizes of a muscle's motion."""
    return sizes("muscle", driven("muscle"))


@pytest.mark.parametrize("key", EFFECTS)
def test_words_are_there(key: str) -> None:
    """Every text is given, in sentences where people read sentences; neighbours are effects."""
    effect = EFFECTS[key]()
    assert effect.key == key
    assert effect.name in NAMES
    for text in (effect.title, effect.law, effect.remedy, effect.shown_by, effect.source):
        assert text
        assert not text.endswith(".")
    for sentence in (effect.meaning, effect.signature):
        assert sentence.endswith(".")
        assert sentence[0].isupper()
    assert effect.neighbours
    assert set(effect.neighbours) <= set(NAMES) - {effect.name}


@pytest.mark.parametrize(
    ("key", "goes_by"),
    [
        ("quadratic_damping.power", ["v_max"]),
        ("pneumatic_lag.level", ["u_low", "u_high"]),
        ("static_curve", ["u_low", "u_high"]),
    ],
)
def test_a_law_that_goes_by_sizes_tells_them(key: str, goes_by: list[str]) -> None:
    """Whoever has the parameters and the law can compute the effect elsewhere."""
    scale = replace(muscle_scale(), u_unit="kPa", x_unit="rad")
    told = EFFECTS[key]().law_at(scale)
    for name in goes_by:
        assert f"{getattr(scale, name):.5g}" in told
    assert EFFECTS["delay"]().law_at(scale) == EFFECTS["delay"].law


@pytest.mark.parametrize("key", EFFECTS)
def test_the_law_names_every_parameter(key: str) -> None:
    """So that who reads the values below the law knows where they go; also with the sizes told."""
    effect, scale = EFFECTS[key](), muscle_scale()
    for law in (effect.law, effect.law_at(scale)):
        assert unnamed_in(law, effect.parameters(scale).names) == set()


@pytest.mark.parametrize("key", [key for key in EFFECTS if EFFECTS[key].stage == "output"])
def test_y_is_what_was_recorded_and_x_what_was_not_changed(key: str) -> None:
    """No letter stands for both: where y is given outright, no y is left on the other side."""
    law = EFFECTS[key].law
    assert law.lower().startswith("recorded y")
    left, right = law.lower().split(" = ", 1)
    assert "x" in re.findall(r"[a-z]+", right)
    if ":" not in left:
        assert "y" not in re.findall(r"[a-z]+", right)


@pytest.mark.parametrize("key", EFFECTS)
def test_the_docstring_has_the_source_that_is_printed(key: str) -> None:
    """In a paragraph of its own, with titles in italics; where and for what may follow it."""
    *_, last = (EFFECTS[key].__doc__ or "").split("\n\n")
    told = " ".join(last.replace("*", "").split())
    assert told.startswith(f"Source: {EFFECTS[key]().source}")
    assert told.endswith(".")


def test_effects_are_confused_with_each_other() -> None:
    """Each with what any form of it names, and with those of which any form names it."""
    confused = {
        name: {n for key in EFFECTS if EFFECTS[key].name == name for n in names_of(key)}
        for name in NAMES
    }
    for name, others in confused.items():
        for other in others:
            assert name in confused[other], (name, other)
    assert "smoothing" not in EFFECTS["sensor_lag"].neighbours
    assert names_of("sensor_lag")[-1] == "smoothing"
    for key, effect in EFFECTS.items():
        assert names_of(key)[: len(effect.neighbours)] == effect.neighbours
        assert len(set(names_of(key)) - {effect.name}) == len(names_of(key))


def names_of(key: str) -> tuple[str, ...]:
    """What an effect of the catalogue can be confused with."""
    return confusable_with(EFFECTS[key]())


@pytest.mark.parametrize("key", EFFECTS)
def test_roles_are_played_by_parameters(key: str) -> None:
    """Bounds that make a law another one's, the plain form and the simpler effect all exist.

    A plain form lies within the bounds, or is the limit below the lower one, as where the excess of
    a friction lies within no speed at all.
    """
    effect, declared = EFFECTS[key](), EFFECTS[key]().parameters(muscle_scale())
    assert set(effect.essential) | set(effect.ceilings) <= set(declared)
    assert set(effect.draws) <= set(NAMES)
    if effect.plain_at is not None:
        name, value = effect.plain_at
        assert effect.variant
        assert value < declared[name].upper
        assert declared[name].lower < value or (value == 0.0 < declared[name].lower)
