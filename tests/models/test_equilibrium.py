"""The equilibrium model: response, derivatives, plan, options, starts and cautions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from softid.errors import UsageError
from softid.log import Log
from softid.models.actuator_geometry import Actuator
from softid.models.equilibrium import NAMES, Equilibrium
from softid.models.equilibrium_cautions import relative_condition
from softid.segment import Segment

THETA = np.array([4.5e-4, 0.2, -0.3, 1.3, 1.0, 1.0, 0.0, 0.0])


def step(
    level_kpa: float,
    *,
    rate_hz: float = 200.0,
    stop_s: float = 3.0,
    angle: np.ndarray | None = None,
) -> Segment:
    """A pressure that rises within 30 ms after 0.5 s of rest."""
    time_s = np.arange(round(stop_s * rate_hz) + 1) / rate_hz
    since = np.maximum(time_s - 0.5, 0.0)
    pressure = level_kpa * (1.0 - np.exp(-since / 0.03))
    channels = {"pressure": pressure, "angle": time_s if angle is None else angle}
    return Log.from_arrays(time_s, channels).segments()[0]


def angle_of(model: Equilibrium, theta: np.ndarray, segment: Segment) -> np.ndarray:
    return model.response(theta, segment, ("angle",), start=None, derivatives=False).outputs[
        "angle"
    ]


@pytest.mark.parametrize("damping", [1e-5, 4.5e-4, 2e-2])
@pytest.mark.parametrize("rate_hz", [50.0, 200.0])
def test_the_response_is_accurate_at_any_sampling(damping: float, rate_hz: float) -> None:
    """DOP853 on the same straight pieces of pressure: within 1e-4 of the swing, ringing or not."""
    theta = THETA.copy()
    theta[0] = damping
    model, segment = Equilibrium(), step(20.0, rate_hz=rate_hz, stop_s=2.0)

    def rates(time_s: float, y: np.ndarray) -> list[float]:
        pressure = float(np.interp(time_s, segment.time_s, segment.input))
        part = model.torques(theta, y[0], y[1], pressure)
        pull = part["driving"] - part["elastic"] - part["damping"] - part["inertial"]
        return [y[1], pull / part["inertia"]]

    exact = solve_ivp(
        rates, (0.0, 2.0), [0.0, 0.0], "DOP853", segment.time_s, rtol=1e-8, atol=1e-10,
        max_step=1 / rate_hz,
    )  # fmt: skip
    found = angle_of(model, theta, segment)
    assert np.abs(found - exact.y[0]).max() < 1e-4 * np.ptp(exact.y[0])


@pytest.mark.parametrize("inertia", ["root-moment", "lagrangian"])
def test_derivatives(inertia: str) -> None:
    """Central differences with the plan held: within 1e-6; drift and the mirrored output too."""
    theta = THETA.copy()
    theta[6:] = 1e-3, 0.02
    model = Equilibrium(inertia=inertia, inverted=True)  # type: ignore[arg-type]
    segment = step(20.0)
    segment = replace(segment, input=segment.input + 3.0)
    plan = model.plan(theta, segment)
    for start in (None, np.array([0.05, -0.4])):
        found = model.response(
            theta, segment, ("angle",), start=start, derivatives=True, relative=True, plan=plan
        )
        assert found.by_parameter is not None
        assert found.by_state is not None
        for k in range(10):
            ends = []
            for sign in (1.0, -1.0):
                at = theta.copy()
                state = None if start is None else start.copy()
                if k < 8:
                    h = 1e-6 * max(abs(theta[k]), 1e-3)
                    at[k] += sign * h
                elif state is not None:
                    h = 1e-6
                    state[k - 8] += sign * h
                else:
                    continue
                moved = model.response(
                    at, segment, ("angle",), start=state, derivatives=False, relative=True,
                    plan=plan,
                )  # fmt: skip
                ends.append(moved.outputs["angle"])
            if not ends:
                continue
            numeric = (ends[0] - ends[1]) / (2 * h)
            exact = (
                found.by_parameter["angle"][:, k] if k < 8 else found.by_state["angle"][:, k - 8]
            )
            assert np.abs(exact - numeric).max() < 2e-6 * np.abs(numeric).max(), k


def test_both_directions_and_rest() -> None:
    """−p bends the other way, from rest at the first pressure to θ_eq(20 kPa) = 0.7048266347."""
    model = Equilibrium()
    bent = angle_of(model, THETA, step(20.0, stop_s=12.0))
    np.testing.assert_allclose(angle_of(model, THETA, step(-20.0, stop_s=12.0)), -bent, atol=1e-14)
    assert np.abs(bent[:100]).max() < 1e-15
    assert bent[-1] == pytest.approx(0.7048266347, abs=1e-8)
    static = model.static_output(THETA, np.array([20.0, -20.0, 0.0, 1e6]), "angle")
    assert static[:3] == pytest.approx([0.7048266347, -0.7048266347, 0.0], abs=1e-9)
    assert np.isnan(static[3])


def test_the_plan_follows_the_fastest_motion() -> None:
    """One step a sample at 1 kHz, several at 50 Hz, more where damping over inertia is stiff."""
    model = Equilibrium()
    assert model.plan(THETA, step(20.0, rate_hz=1000.0)).counts.max() == 1
    slow = step(20.0, rate_hz=50.0)
    ringing = model.plan(THETA, slow).counts.max()
    assert 3 <= ringing <= 6
    stiff = THETA.copy()
    stiff[0] = 0.09
    assert model.plan(stiff, slow).counts.max() > 2 * ringing
    assert np.isfinite(angle_of(model, stiff, slow)).all()
    stiff[0] = 1.0
    assert model.plan(stiff, slow).counts.max() == 16
    assert np.isnan(angle_of(model, stiff, slow)[-1])


def test_inertia_forms_differ_as_they_should() -> None:
    """ρl³/8 against ρl³/20 of a rod: the Lagrangian actuator swings about 1.5 times as fast."""
    values = dict(zip(NAMES, THETA.tolist(), strict=True))
    root, energy = (
        Equilibrium(inertia=form).derived(values, (0.0, 20.0))["natural_frequency_at_20_kPa"][0]
        for form in ("root-moment", "lagrangian")
    )
    assert root == pytest.approx(3.7, abs=0.05)
    assert 1.3 < energy / root < 1.7


@pytest.mark.parametrize(
    ("options", "free"),
    [
        ({}, ("C_d", "a", "b", "c", "stiffness")),
        ({"compensation": "constant"}, ("C_d", "c", "stiffness")),
        ({"compensation": "none"}, ("C_d", "stiffness")),
        ({"drift": "linear"}, ("C_d", "a", "b", "c", "stiffness", "drift")),
        ({"driving": "free"}, ("C_d", "a", "b", "c", "stiffness", "drive")),
    ],
)
def test_options_say_what_is_free(options: dict[str, str], free: tuple[str, ...]) -> None:
    """The driving torque is held unless asked, since only ratios show."""
    assert Equilibrium(**options).parameters().free == free  # type: ignore[arg-type]


def test_options_are_checked() -> None:
    with pytest.raises(UsageError, match="inertia"):
        Equilibrium(inertia="rotary")  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="root moment only"):
        Equilibrium(inertia="lagrangian", kernels="taylor")


def test_the_taylor_form_swings_faster() -> None:
    """Its M is too small at large angles, so at 40 kPa the frequency is higher, at 5 kPa equal."""
    values = dict(zip(NAMES, THETA.tolist(), strict=True))

    def swing(kernels: str, level: float) -> float:
        model = Equilibrium(kernels=kernels)  # type: ignore[arg-type]
        return model.derived(values, (0.0, level))[f"natural_frequency_at_{level:.0f}_kPa"][0]

    assert swing("taylor", 5.0) == pytest.approx(swing("exact", 5.0), rel=1e-4)
    assert swing("taylor", 40.0) > 1.01 * swing("exact", 40.0)


def test_starts_find_the_basin() -> None:
    """With 0.2° of noise the best of the starts explains 80 % of the variance without a or b."""
    for level, scale, mass in ((20.0, 1.0, 1.0), (-15.0, 2.0, 4.0), (10.0, 0.5, 0.4)):
        theta = THETA * [1.0, mass, mass, mass, scale, 1.0, 1.0, 1.0]
        model = Equilibrium()
        truth = angle_of(model, theta, step(level))
        noisy = truth + np.deg2rad(0.2) * np.random.default_rng(1).standard_normal(truth.size)
        segment = step(level, angle=noisy + 0.1)
        best = model.guess([segment], "angle")[0].values_vector()
        left = noisy - angle_of(model, best, segment)
        assert np.var(left) < 0.2 * np.var(noisy)
        assert best[4] == pytest.approx(scale, rel=0.15)


def test_an_assumed_actuator_is_not_tried_unasked() -> None:
    """The default dimensions are nobody's; a given geometry is."""
    assert Equilibrium().variants("pressure") == ()
    given = Equilibrium.of(Actuator(assumed=""))
    assert given.variants("pressure") == (given,)


def test_options_alone_build_the_model_again() -> None:
    """Numbers and texts only, so that params.json can simulate without the geometry file."""
    model = Equilibrium.of(Actuator(rib_m=0.004), inertia="lagrangian", drift="linear")
    spec = model.spec()
    assert all(isinstance(v, float | int | str) for v in spec.options.values())
    assert Equilibrium(**spec.options) == model  # type: ignore[arg-type]


def test_cautions_name_what_is_assumed() -> None:
    """Dimensions that set the scale make a warning, none assumed only a reminder."""
    values = dict(zip(NAMES, THETA.tolist(), strict=True))
    codes = {i.code: i for i in Equilibrium().cautions(values, ("C_d", "c"), None)}
    assert set(codes) == {"assumed-geometry", "ratios-only"}
    assert "chamber_width_m = 0.02" in codes["assumed-geometry"].message
    assert "layer_modulus" not in codes["assumed-geometry"].message
    assert codes["ratios-only"].severity == "warning"
    known = Equilibrium.of(Actuator(assumed="")).cautions(values, ("C_d", "c"), None)
    assert [(i.code, i.severity) for i in known] == [("ratios-only", "info")]


@pytest.mark.parametrize(
    ("stiffness", "told"), [(1.0, False), (1.9, False), (0.4, True), (9, True)]
)
def test_a_stiffness_far_from_one_points_at_the_geometry(stiffness: float, told: bool) -> None:
    """The scale is 1 where geometry and material are right; a factor of two is the stated limit."""
    values = dict(zip(NAMES, THETA.tolist(), strict=True)) | {"stiffness": stiffness}
    model = Equilibrium.of(Actuator(assumed=""))
    for known in (("C_d", "stiffness"), ("C_d",)):
        codes = {i.code for i in model.cautions(values, known, None)}
        assert ("geometry-does-not-match" in codes) == (told and "stiffness" in known)


def test_condition_of_one_step() -> None:
    """One 20 kPa step at 200 Hz: condition 166, standard errors 5.9, 4.6 and 0.3 % at 0.2°."""
    segment = step(20.0, stop_s=6.0)
    model = Equilibrium()
    found = model.response(THETA, segment, ("angle",), start=None, derivatives=True)
    assert found.by_parameter is not None
    jacobian = found.by_parameter["angle"][:, :4]
    covariance = np.deg2rad(0.2) ** 2 * np.linalg.inv(jacobian.T @ jacobian)
    values = dict(zip(NAMES, THETA.tolist(), strict=True))
    assert relative_condition(values, NAMES[:4], covariance) == pytest.approx(166, abs=1.5)
    percent = 100 * np.sqrt(np.diag(covariance)) / np.abs(THETA[:4])
    assert percent[1:] == pytest.approx([5.9, 4.6, 0.3], abs=0.06)
    told = model.cautions(values, NAMES[:4], covariance)
    assert "compensation-not-separated" in {issue.code for issue in told}
    assert relative_condition(values, NAMES[:3], covariance[:3, :3]) is None
