"""Standard errors of fits to readings in coarse steps, which no noise blurs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import RATE_HZ, TRUTH, linear_angle

from softid.identification import fit, parameter_covariance
from softid.log import Log

STEP = 0.05
"""A thirtieth of the range."""

DRAWS = 20


def rounded_log(seed: int) -> Log:
    """Two thirds of it at rest at the highest level, and a converter whose steps lie anywhere."""
    time_s = np.arange(1500) / RATE_HZ
    since_s = np.maximum(time_s - 22.0, 0.0)
    moving = 50.0 + 40.0 * np.cos(2.0 * np.pi * (0.2 + 0.03 * since_s) * since_s)
    angle = linear_angle(time_s, moving - 90.0) + 90.0 / TRUTH["Q"]
    offset = np.random.default_rng(seed).uniform(0.0, STEP)
    rounded = STEP * np.round((angle + offset) / STEP)
    return Log.from_arrays(time_s, {"pressure": moving, "angle": rounded}, name="rounded")


def share_within() -> float:
    """Share of the true parameters within their 95 % intervals, over all draws."""
    inside = []
    for seed in range(DRAWS):
        found = fit(rounded_log(seed), model="oscillator")
        for name, true in TRUTH.items():
            low, high = found.parameter(name).ci95
            inside.append(low <= true <= high)
    return float(np.mean(inside))


def test_a_long_rest_is_one_draw_of_what_was_rounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Known truth: taken as independent samples, the intervals hold it in 40 % of the cases."""
    assert share_within() >= 0.9
    monkeypatch.setattr(parameter_covariance, "_rounding_of", lambda *_: None)
    assert share_within() < 0.7


def test_noise_blurs_the_steps() -> None:
    """Where it is as large as a step the rounding says nothing, and the errors stay as they are."""
    log = rounded_log(0)
    noise = STEP * np.random.default_rng(0).standard_normal(len(log))
    angle = log.channels["angle"]
    noisy = STEP * np.round((angle.values + noise) / STEP)
    fine = angle.values + noise
    errors = []
    for values in (noisy, fine):
        channels = {**log.channels, "angle": replace(angle, values=values)}
        found = fit(replace(log, channels=channels), model="oscillator")
        errors.append([found.parameter(name).stderr for name in TRUTH])
    np.testing.assert_allclose(errors[0], errors[1], rtol=0.2)
