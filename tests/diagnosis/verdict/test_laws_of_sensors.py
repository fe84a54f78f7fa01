"""Sensors that a cause in the actuator may stand for: laws in closed form, and logs with them."""

from __future__ import annotations

import numpy as np
import pytest
from extended_fits import scale_of as sizes_of
from wrong_readings import read_with

from softid.diagnosis import diagnose
from softid.diagnosis.verdict.unlisted_drifts import SettlingPressure
from softid.diagnosis.verdict.unlisted_memories import ReadingHysteresis
from softid.diagnosis_results import Verdict
from softid.log import Log
from softid.synthesis import Rig, hidden_pair


def test_a_zero_of_the_gauge_settles() -> None:
    """Closed form: 0.2 of the range of the pressure, of which 1 − 1/e is there after 10 s."""
    scale, time_s = sizes_of("muscle"), np.array([0.0, 10.0, 500.0])
    found = SettlingPressure().apply(np.array([0.2, 10.0]), time_s, np.full(3, 5.0), scale)
    settled = 0.2 * scale.u_span
    assert found == pytest.approx([5.0, 5.0 + settled * (1.0 - np.exp(-1.0)), 5.0 + settled])


def test_a_sensor_stays_behind_on_both_ways() -> None:
    """Closed form: z is 1 − e⁻² after two distances up, and e⁻¹ z − (1 − e⁻¹) after one down.

    However the way is divided into samples; at rest it stays.
    """
    scale = sizes_of("muscle")
    zs = 0.25 * scale.y_span
    corners = zs * np.array([0.0, 2.0, 2.0, 1.0])
    way = np.interp(np.linspace(0.0, 3.0, 301), np.arange(4.0), corners)
    up = 1.0 - np.exp(-2.0)
    branch = np.array([0.0, up, up, np.exp(-1.0) * up - (1.0 - np.exp(-1.0))])
    expected = corners - 0.1 * scale.y_span * branch
    for y, at in ((corners, slice(None)), (way, slice(None, None, 100))):
        found = ReadingHysteresis().apply(np.array([0.1, zs]), np.arange(y.size), y, scale)
        np.testing.assert_allclose(found[at], expected, rtol=1e-12)


SILENT = Rig(noise=0.0)
"""A sensor without noise, behind which another one may stand: its loop follows the motion alone."""


def with_a_loop_in_the_sensor(log: Log) -> Log:
    """−h z by Dahl's law in steps of its own, h an eighth, zs a fifth of the range; and noise."""
    y = log.channels[log.outputs[0]].values
    span = float(np.ptp(y))
    z, lost = 0.0, np.zeros(y.size)
    for k in range(1, y.size):
        for _ in range(20):
            step = (y[k] - y[k - 1]) / 20.0
            z += (step - abs(step) * z) / (0.2 * span)
        lost[k] = -0.125 * span * z
    noise = 0.005 * span * np.random.default_rng(y.size).standard_normal(y.size)
    return read_with(log, log.outputs[0], lost + noise)


def with_a_gauge_that_warms_up(log: Log) -> Log:
    """The gauge reads an eighth of the range too much when it is warm, with 10 s."""
    span = float(np.ptp(log.channels["pressure"].values))
    return read_with(log, "pressure", 0.125 * span * (1.0 - np.exp(-log.time_s / 10.0)))


@pytest.mark.parametrize("seed", [981001, pytest.param(981002, marks=pytest.mark.slow)])
def test_a_loop_in_the_sensor_is_not_named_in_the_material(seed: int) -> None:
    fitted, judge = map(with_a_loop_in_the_sensor, hidden_pair(seed=seed, rig=SILENT).logs)
    found = diagnose(fitted, hold_out=[judge], model="muscle")
    assert found.verdict is not Verdict.NAMED
    assert "hysteresis of the sensor" in found.summary


@pytest.mark.parametrize("seed", [981003, pytest.param(981004, marks=pytest.mark.slow)])
def test_a_gauge_that_warms_up_is_told_from_the_sensor(seed: int) -> None:
    """Over a muscle, whose curve at rest is bent."""
    fitted, judge = map(with_a_gauge_that_warms_up, hidden_pair(seed=seed).logs)
    found = diagnose(fitted, hold_out=[judge], model="muscle")
    assert found.verdict is not Verdict.NAMED
    assert "zero of the pressure gauge that changes with the time" in found.summary


def test_over_a_linear_model_no_log_tells_which_of_the_two_warms_up() -> None:
    fitted, judge = hidden_pair(["sensor_warmup"], seed=981005, model="oscillator").logs
    found = diagnose(
        fitted, hold_out=[judge], model="oscillator", effects=["sensor_warmup", "creep"]
    )
    assert [cause.effect for cause in found.causes] == ["sensor_warmup"]
    assert "a sensor that warms up, a pressure gauge that warms up or a load" in found.summary
