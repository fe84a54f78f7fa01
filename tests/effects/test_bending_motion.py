"""Effects in the law of the bending actuator, which is not affine in its state."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from muscle_rig import jacobian_error, response

from softid.effects import EFFECTS, ExtendedModel, Scale
from softid.effects.extension.motion import simulate_motion
from softid.log import Log
from softid.models import Equilibrium
from softid.segment import Segment

THETA = np.array([4.5e-4, 0.2, -0.3, 1.3, 1.0, 1.0, 0.0, 0.0])
ETA = {
    "sensor_drift": [0.02],
    "sensor_gain_drift": [0.01],
    "pneumatic_lag": [0.03],
    "creep": None,
    "coulomb_friction": [1e-3, 0.5],
}
SCALE = Scale(
    u_low=0.0,
    u_high=20.0,
    x_low=0.0,
    x_high=1.2,
    v_max=12.0,
    force=0.03,
    y_low=0.0,
    y_high=1.2,
    period_s=0.005,
    duration_s=3.0,
    motion_s=0.05,
    travel=5.0,
    x_unit="rad",
    force_unit="N·m",
    y_unit="rad",
)


@cache
def step() -> Segment:
    """0 to 20 kPa with a lag of 30 ms, 200 Hz, 3 s."""
    time_s = np.arange(601) / 200.0
    since = np.maximum(time_s - 0.5, 0.0)
    pressure = 20.0 * (1.0 - np.exp(-since / 0.03))
    channels = {"pressure": pressure, "angle": np.zeros_like(time_s)}
    return Log.from_arrays(time_s, channels).segments()[0]


def extended(*keys: str) -> tuple[ExtendedModel, np.ndarray]:
    """The model with effects, and moderate parameters."""
    effects = tuple(EFFECTS[key]() for key in keys)
    model = ExtendedModel(Equilibrium(), effects, SCALE)
    own = [
        value
        for effect in model.effects
        for value in ETA[effect.key] or effect.parameters(SCALE).values_vector()
    ]
    return model, np.concatenate((THETA, own))


@pytest.mark.parametrize("inverted", [False, True])
@pytest.mark.parametrize("drift", [0.0, 0.02])
def test_without_effects_it_is_the_models_own_response(inverted: bool, drift: float) -> None:
    """Radau against the model's own Runge–Kutta: 1e-5 of the range, and 1e-4 of a derivative."""
    model, theta = Equilibrium(inverted=inverted, drift="linear"), THETA.copy()
    theta[7] = drift
    wrapped = ExtendedModel(model, (), SCALE)
    plan = wrapped.plan(theta, step())
    options = {"start": None, "derivatives": True}
    own = model.response(theta, step(), ("angle",), **options)
    span = np.ptp(own.outputs["angle"])
    whole = wrapped.response(theta, step(), ("angle",), **options)
    moved = simulate_motion(
        model,
        (),
        SCALE,
        theta,
        np.empty(0),
        step(),
        ("angle",),
        first_input=float(step().input[0]),
        stage_input=plan.stage_input,
        plan=plan,
        relative=False,
        **options,
    )
    for found in (whole, moved):
        assert np.abs(found.outputs["angle"] - own.outputs["angle"]).max() < 1e-5 * span
        for mine, theirs in (
            (found.by_parameter, own.by_parameter),
            (found.by_state, own.by_state),
        ):
            assert mine is not None
            assert theirs is not None
            sizes = np.abs(theirs["angle"]).max(axis=0)
            off = np.abs(mine["angle"] - theirs["angle"]).max(axis=0)
            assert np.all(off <= 1e-4 * sizes), off / sizes


@pytest.mark.parametrize(
    "keys", [(key,) for key in ETA] + [tuple(ETA), ("creep", "coulomb_friction")], ids=str
)
def test_the_jacobian_is_that_of_differences(keys: tuple[str, ...]) -> None:
    """Against central differences of the simulation on the same plan, to 1e-3 of each column."""
    model, theta = extended(*keys)
    plain = Equilibrium().response(THETA, step(), ("angle",), start=None, derivatives=False)
    assert np.abs(response(model, theta, step()) - plain.outputs["angle"]).max() > 1e-3
    assert jacobian_error(model, theta, step(), step=1e-4) < 1e-3


def suddenly(model: Equilibrium | ExtendedModel, theta: np.ndarray) -> np.ndarray:
    """The angle after a jump to 20 kPa before the first sample."""
    jumped = replace(step(), input=np.full(step().input.size, 20.0))
    start = np.zeros(2)
    found = model.response(theta, jumped, ("angle",), start=start, derivatives=False)
    return found.outputs["angle"]


def test_a_share_of_inertia_is_more_of_all_compensation() -> None:
    """(1 + m p)·(M θ̈ + D θ̇²) at a constant p is C_m times 1 + m p, to 1e-5 of the range."""
    model = ExtendedModel(Equilibrium(), (EFFECTS["pressure_mass"](),), SCALE)
    heavier = THETA.copy()
    heavier[1:4] *= 1.4
    there = suddenly(Equilibrium(), heavier)
    found = suddenly(model, np.append(THETA, 0.02))
    assert np.abs(found - there).max() < 1e-5 * np.ptp(there)
    assert np.abs(found - suddenly(Equilibrium(), THETA)).max() > 0.1


def test_a_share_of_damping_leaves_the_inertial_torque() -> None:
    """A motion that only rises: 1 + ε on the damping is C_d times 1 + ε, to 1e-5 of the range."""
    model = ExtendedModel(Equilibrium(), (EFFECTS["asymmetric_damping"](),), SCALE)
    slow, slower = THETA.copy(), THETA.copy()
    slow[0], slower[0] = 5e-3, 6.5e-3
    there = suddenly(Equilibrium(), slower)
    assert np.all(np.diff(there) > -1e-9)
    found = suddenly(model, np.concatenate((slow, [0.3, 1e-6])))
    assert np.abs(found - there).max() < 1e-5 * np.ptp(there)
    assert np.abs(found - suddenly(Equilibrium(), slow)).max() > 0.01


def test_rest_is_that_of_the_model() -> None:
    """Neither friction nor a settled lag has a force at rest: the golden 0.7048266347 rad."""
    model, theta = extended("pneumatic_lag", "coulomb_friction")
    found = model.static_output(theta, np.array([0.0, 20.0, -20.0]), "angle")
    np.testing.assert_allclose(found, [0.0, 0.7048266347, -0.7048266347], atol=1e-8)
