"""Causes of which each makes far more than both together."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from linear_motion import TRUTH, Array, Bow, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.verdict.cancelling import cancelling
from softid.effects import EFFECTS, effect_of
from softid.effects.scale import Scale


@dataclass(frozen=True)
class Sag(Bow):
    """Against a bow, with a little more of its end, − c (t/T)^2.2."""

    name: ClassVar[str] = "sag"

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Take the other parabola away."""
        sagged: Array = y - eta[0] * (time_s / scale.duration_s) ** 2.2
        return sagged


@dataclass(frozen=True)
class Wave(Bow):
    """A wave that no bow is like, + c sin(12 t)."""

    name: ClassVar[str] = "wave"

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Add the wave."""
        del scale
        waved: Array = y + eta[0] * np.sin(12.0 * time_s)
        return waved


def with_sizes(**sizes: float) -> tuple[Candidate, Candidate, Scale]:
    """The linear actuator without and with effects of these sizes, at the truth."""
    known = {effect.name: effect for effect in (Bow(), Sag(), Wave())}
    problem = linear_problem([linear_log()])
    z = problem.unknowns(TRUTH)
    scale = scale_of(problem, z)
    effects = tuple(known[name] for name in sizes)
    extended = extend(problem, effects, scale)
    values = {f"{name}_c": size for name, size in sizes.items()}
    final = standing(extended, start_unknowns(extended, problem, z, values))
    return replace(final, effects=effects), standing(problem, z), scale


@pytest.mark.parametrize(
    ("sizes", "found"),
    [
        ({"bow": 1.0, "sag": 1.0}, {"bow", "sag"}),
        ({"bow": 1.0, "sag": 1.0, "wave": 0.5}, {"bow", "sag"}),
        ({"bow": 1.0, "sag": 0.4}, set()),
        ({"bow": 1.0, "wave": 1.0}, set()),
        ({"bow": 1.0}, set()),
    ],
)
def test_what_nearly_cancels_is_no_cause(sizes: dict[str, float], found: set[str]) -> None:
    """A parabola less its neighbour is a tenth of either; less two fifths of it, most stays."""
    final, base, scale = with_sizes(**sizes)
    assert cancelling(final, base, scale) == found


def test_laws_without_another_form_may_meet_halfway(monkeypatch: pytest.MonkeyPatch) -> None:
    """An offset and a rate of a clock; one of them alone is not enough."""
    final, base, scale = with_sizes(bow=1.0, sag=1.0)
    monkeypatch.setattr(Sag, "has_one_form", True)
    assert cancelling(final, base, scale) == {"bow", "sag"}
    monkeypatch.setattr(Bow, "has_one_form", True)
    assert cancelling(final, base, scale) == set()


def test_a_clock_has_one_form() -> None:
    assert {name for name in EFFECTS if effect_of(name).has_one_form} == {"clock_rate", "delay"}
