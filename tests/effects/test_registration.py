"""Effects of users' own: one class in a script simulates and fits, and mistakes are told."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from softid.effects import (
    EFFECTS,
    Effect,
    InputEffect,
    OutputEffect,
    StateEffect,
    confusable_with,
    effect_of,
    model_of,
    register_effect,
)
from softid.effects.registration import EXAMPLE
from softid.errors import UsageError
from softid.parameters import Parameter, ParameterSet
from softid.results import ModelSpec

ROOT = Path(__file__).resolve().parents[2]

SCRIPT = """
import math

import numpy as np
import softid
from softid.effects import ExtendedModel, Scale, StateEffect
from softid.kernels.terms import FORCE


@softid.register_effect
class Cogging(StateEffect):
    name = "cogging"
    title = "Cogging"
    law = "+ Fk sin(2 pi x / L)"
    meaning = "The guide has teeth."
    signature = "A wave against the position, the same at every speed."
    shown_by = "the full range, slowly"
    source = "own"
    amplitude = "Fk"
    changes_sign = True

    def parameters(self, scale):
        return softid.ParameterSet((
            softid.Parameter("Fk", 0.05 * scale.force, scale.force_unit, -scale.force, scale.force),
            softid.Parameter("L", 0.5, scale.x_unit, 0.1 * scale.x_span, scale.x_span),
        ))

    def starts(self, scale):
        return tuple({"Fk": 0.05 * scale.force, "L": s * scale.x_span} for s in (0.3, 0.6))

    @staticmethod
    def step(x, v, z, u, t, eta, out):
        out[FORCE] += eta[0] * math.sin(2.0 * math.pi * x / eta[1])


scale = Scale(0.0, 100.0, 0.0, 1.0, 2.0, 100.0, 0.0, 1.0, 0.02, 20.0, 0.2, 20.0,
              "kPa", "rad", "kPa", "rad")
base = softid.Oscillator(order="first", x_unit="rad", u_unit="kPa")
model = ExtendedModel(base, (Cogging(),), scale)
t = np.arange(0.0, 20.0, 0.02)
p = 50.0 - 50.0 * np.cos(2.0 * np.pi * (0.1 * t + 0.02 * t**2))
truth = {name: 0.0 for name in model.parameters()} | {
    "N": 20.0, "Q": 100.0, "G": 1.0, "cogging_Fk": 8.0, "cogging_L": 0.4}
still = softid.Log.from_arrays(t, {"pressure": p, "angle": 0.001 * t}, units={"angle": "rad"})
y = softid.simulate(model, truth, still).outputs["angle"]
noisy = y + 2e-3 * np.random.default_rng(4).standard_normal(t.size)
log = softid.Log.from_arrays(t, {"pressure": p, "angle": noisy}, units={"angle": "rad"})
start = model.parameters().with_values(truth | {"cogging_Fk": 5.0, "cogging_L": 0.42})
found = softid.fit(log, model=model, parameters=start)
softid.save_fit(found, "params.json")
back = softid.load_params("params.json")
again = softid.simulate(back.build_model(), back.values, log, nuisance=back.nuisance_for(log))
print(back.model.effects, *(f"{found.values[name]:.4f}" for name in ("cogging_Fk", "cogging_L")))
print(np.abs(again.outputs["angle"] - found.simulations[0].outputs["angle"]).max())
print(len(back.issues), np.std(y) > 0.1)
"""


def test_a_script_with_one_class(tmp_path: Path) -> None:
    """Simulated, fitted and read back: noise of 2 mrad on 1000 samples leaves Fk within 3 %."""
    script = tmp_path / "cogging.py"
    script.write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, str(script)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    first, second, third = done.stdout.splitlines()
    assert first.startswith("('cogging',)")
    force, length = map(float, first.split()[1:])
    assert force == pytest.approx(8.0, rel=0.03)
    assert length == pytest.approx(0.4, rel=0.01)
    assert float(second) <= 1e-12
    assert third == "0 True"


WORDS: dict[str, Any] = {
    "name": "sensor_glow",
    "title": "Sensor that glows",
    "law": "y (1 + k y)",
    "meaning": "The sensor is nonlinear.",
    "signature": "A parabola against the output.",
    "shown_by": "the full range",
    "source": "own",
    "amplitude": "k",
    "parameters": lambda self, scale: ParameterSet((Parameter("k", 1e-3, "1/deg", 0.0, 0.1),)),
    "starts": lambda self, scale: ({"k": 1e-3},),
    "apply": lambda self, eta, time_s, y, scale: y * (1.0 + eta[0] * y),
}


def effect_class(kind: type[Effect] = OutputEffect, **changes: Any) -> type[Effect]:
    left_out = [name for name, value in changes.items() if value is Ellipsis]
    body = {k: v for k, v in (WORDS | changes).items() if k not in left_out}
    made: type[Effect] = type("SensorGlow", (kind,), body)
    return made


@pytest.fixture(autouse=True)
def table_as_before() -> Iterator[None]:
    before = dict(EFFECTS)
    yield
    EFFECTS.clear()
    EFFECTS.update(before)


def test_all_that_a_class_may_set_is_explained() -> None:
    """Each attribute in the docstring of its base class, in the order in which they stand."""
    told = (Effect.__doc__ or "").splitlines()
    names = [name for name in Effect.__annotations__ if "ClassVar" in Effect.__annotations__[name]]
    heads = [line.strip().split(", ") for line in told if line.startswith("    ")]
    explained = [name for head in heads for name in head if name in names]
    assert explained == names


def test_a_registered_effect_is_in_the_table() -> None:
    """Under its key, so that a specification that names it gives the extended model."""
    glow = register_effect(effect_class())
    assert EFFECTS["sensor_glow"] is glow
    spec = ModelSpec("oscillator", {}, ("sensor_glow",), vars(EXAMPLE))
    assert model_of(spec).parameters().names[-1] == "sensor_glow_k"
    assert register_effect(effect_class()) is not glow  # a cell of a notebook that runs twice


def test_what_a_registered_effect_names_is_confused_with_it() -> None:
    """Both ways, as long as it is in the table."""
    assert "sensor_glow" not in confusable_with(effect_of("sensor_lag"))
    glow = register_effect(effect_class(neighbours=("sensor_lag", "contact")))
    assert confusable_with(glow()) == ("sensor_lag", "contact")
    assert confusable_with(effect_of("sensor_lag"))[-1] == "sensor_glow"
    assert confusable_with(effect_of("contact.lower"))[-1] == "sensor_glow"


def no_end(self: Effect, scale: object) -> ParameterSet:
    return ParameterSet((Parameter("k", 1e-3, "1/deg"),))


def endless(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
    out[0] += np.inf


def listed(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
    out[0] += float(str(eta[0]).strip("k"))


MISTAKES: dict[str, tuple[type[Effect], dict[str, Any], str]] = {
    "no word": (OutputEffect, {"law": ""}, "law must be said"),
    "two words": (OutputEffect, {"law": "", "title": ...}, "title and law must be said"),
    "no amplitude": (OutputEffect, {"amplitude": ...}, "amplitude must be said"),
    "bad name": (OutputEffect, {"name": "Sensor glow"}, "not a name in lower case"),
    "taken": (OutputEffect, {"name": "delay"}, "another effect has this name"),
    "neighbour": (OutputEffect, {"neighbours": ("delays",)}, "a neighbour is no effect"),
    "drawn": (OutputEffect, {"draws": ("delays",)}, "a drawn effect is no effect"),
    "essential": (OutputEffect, {"essential": ("c",)}, "essential parameter is none of its"),
    "ceiling": (OutputEffect, {"ceilings": ("c",)}, "with a ceiling is none of its parameters"),
    "plain": (OutputEffect, {"plain_at": ("c", 1.0)}, "the plain form is none of its parameters"),
    "begins another": (OutputEffect, {"name": "sensor"}, "would look like its own"),
    "begins with another": (OutputEffect, {"name": "delay_of_sensor"}, "of delay would look like"),
    "abstract": (OutputEffect, {"apply": ...}, "it cannot be made"),
    "no bounds": (OutputEffect, {"parameters": no_end}, "k has no finite bounds"),
    "no parameter": (OutputEffect, {"parameters": lambda s, _: ParameterSet(())}, "no parameter"),
    "odd amplitude": (OutputEffect, {"amplitude": "c"}, "amplitude is none of its parameters"),
    "no start": (OutputEffect, {"starts": lambda s, _: ()}, "it has no start"),
    "odd start": (OutputEffect, {"starts": lambda s, _: ({"c": 1.0},)}, "each parameter one"),
    "start outside": (OutputEffect, {"starts": lambda s, _: ({"k": 1.0},)}, "outside its bounds"),
    "shape": (InputEffect, {"apply": lambda s, eta, t, u, _: u[1:]}, "one finite number"),
    "nan": (InputEffect, {"apply": lambda s, eta, t, u, _: u * np.nan}, "one finite number"),
    "self": (StateEffect, {"step": lambda self, *a: None}, "step takes no self"),
    "infinite": (StateEffect, {"step": staticmethod(endless)}, "not finite"),
    "python": (StateEffect, {"step": staticmethod(listed)}, "cannot be compiled"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_told(mistake: str) -> None:
    """Each would otherwise show as a crash, or as nonsense, within a diagnosis; exit code 2."""
    kind, changes, said = MISTAKES[mistake]
    before = dict(EFFECTS)
    with pytest.raises(UsageError, match=said) as caught:
        register_effect(effect_class(kind, **changes))
    assert caught.value.remedy
    assert before == EFFECTS


def test_only_effects_are_registered() -> None:
    """A function or a class of another kind has no law."""
    with pytest.raises(UsageError, match="this is not an effect"):
        register_effect(dict)  # type: ignore[type-var]
    with pytest.raises(UsageError, match="this is not an effect"):
        register_effect(replace)  # type: ignore[type-var]
