"""The generator's own equilibrium law: golden numbers, and agreement with the compiled one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from softid.errors import InputError
from softid.kernels.bending_body import inertia_parts
from softid.log import Log
from softid.models.actuator_geometry import Actuator
from softid.models.equilibrium import NAMES, Equilibrium
from softid.synthesis import bundled_datasets, load_recipe, synthesize
from softid.synthesis.bending_law import equilibrium_motion
from softid.synthesis.recipe import Recipe

RECIPES = bundled_datasets() / "recipes"


def recipe(name: str) -> Recipe:
    return load_recipe(RECIPES / f"{name}.toml")


def test_golden_numbers() -> None:
    """θ_eq(20 kPa) = 0.7048266347 and K(1) = 0.041949544; every value by two methods."""
    made = recipe("equilibrium_20")
    assert made.actuator is not None
    motion = equilibrium_motion(made.parameters, made.actuator)
    assert motion.rest(20.0) == pytest.approx(0.7048266347, abs=1e-10)
    assert motion.rest(-20.0) == -motion.rest(20.0)
    assert motion.terms["spring"](0.0, 0.0, 1.0, 0.0) == pytest.approx(-0.041949544, rel=2e-8)
    assert motion.inertia_at(1.0) / 1.2 == pytest.approx(6.4424637e-5 + 1.7499323e-6, rel=1e-8)
    assert motion.terms["inertial"](0.0, 0.0, 1.0, 1.0) / -1.2 == pytest.approx(-7.398970e-6, 1e-7)


def test_the_two_codes_agree() -> None:
    """Gauss points here, power series there: M, D and their like to 1e-12 at any angle."""
    made = recipe("equilibrium_20")
    assert made.actuator is not None
    motion = equilibrium_motion(made.parameters, made.actuator)
    body = Actuator().body("root-moment", "exact")
    for angle in (0.0, 1e-6, 1e-3, 0.4, -1.7, 3.2):
        m, _, d, _ = inertia_parts(angle, body)
        mass = 0.2 * angle**2 - 0.3 * abs(angle) + 1.3
        assert motion.inertia_at(angle) == pytest.approx(mass * m, rel=1e-12)
        turned = motion.terms["inertial"](0.0, 0.0, angle, 2.0)
        assert turned == pytest.approx(-4.0 * mass * d, rel=1e-11, abs=1e-30)


@pytest.mark.parametrize("level", ["20", "minus_20"])
def test_the_model_follows_the_truth(level: str) -> None:
    """On the true pressure the model errs by 1e-3 of the swing: it takes the 5 ms between two
    samples as straight, the pressure bends within them. Sampled at 1 kHz that falls 25-fold."""
    errors = []
    for rate_hz in (200.0, 1000.0):
        made = recipe(f"equilibrium_{level}")
        log = synthesize(replace(made, sampling=replace(made.sampling, rate_hz=rate_hz)))
        channels = {"pressure": log.truth_columns["pressure_kpa"], "angle": log.time_s}
        segment = Log.from_arrays(log.time_s, channels).segments()[0]
        theta = np.array([log.truth[name] for name in NAMES])
        found = Equilibrium().response(theta, segment, ("angle",), start=None, derivatives=False)
        true_rad = np.deg2rad(log.truth_columns["angle_deg"])
        errors.append(np.abs(found.outputs["angle"] - true_rad).max() / np.ptp(true_rad))
    assert errors[0] < 1e-3
    assert errors[1] < errors[0] / 20.0


def test_the_gyroscope_drifts() -> None:
    """The drift adds 0.02 rad/s times the recorded time, and nothing else changes."""
    made = recipe("equilibrium_20_drift")
    still = replace(made, parameters=dict(made.parameters) | {"drift": 0.0})
    drifting, plain = synthesize(made), synthesize(still)
    added = np.deg2rad(drifting.truth_columns["angle_deg"] - plain.truth_columns["angle_deg"])
    np.testing.assert_allclose(added, 0.02 * drifting.time_s, atol=1e-12)


def test_what_no_actuator_does_is_refused() -> None:
    """A mass that turns negative on the way, a pressure that no angle holds, a missing table."""
    made = recipe("equilibrium_20")
    with pytest.raises(InputError, match="compensated mass"):
        synthesize(replace(made, parameters=dict(made.parameters) | {"b": -3.0}))
    assert made.actuator is not None
    with pytest.raises(InputError, match="cannot hold this torque"):
        equilibrium_motion(made.parameters, made.actuator).rest(1e6)
    with pytest.raises(InputError, match="table actuator"):
        replace(made, actuator=None)
