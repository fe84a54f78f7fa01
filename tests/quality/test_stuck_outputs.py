"""Outputs that saturate or stand still, as a fit is told of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import linear_log

from softid.identification import fit
from softid.log import Log
from softid.quality import dropout_mask, misleading_channels


def with_angle(values: np.ndarray) -> Log:
    log = linear_log()
    return replace(
        log, channels={**log.channels, "angle": replace(log.channels["angle"], values=values)}
    )


def noisy() -> np.ndarray:
    return linear_log(noise=0.01).channels["angle"].values


@pytest.mark.parametrize(
    ("values", "code"),
    [
        (noisy(), None),
        (np.minimum(noisy(), 0.9), "saturation"),
        (np.where(np.arange(1000) // 100 == 4, noisy()[400], noisy()), "frozen-channel"),
    ],
)
def test_what_an_output_is_stuck_at(values: np.ndarray, code: str | None) -> None:
    """Cut off at 0.9 of 1.6 rad, or one value for 2 s; a fit carries it among its issues."""
    log = with_angle(values)
    codes = [issue.code for issue in misleading_channels(log)]
    assert codes == ([code] if code else [])
    told = {issue.code for issue in fit(log, model="oscillator").issues}
    assert (code in told) is (code is not None)
    if code:
        (issue,) = misleading_channels(log)
        assert issue.message.startswith(f"{log.name}: angle ")


@pytest.mark.parametrize("seconds", [0.6, 2.0])
def test_a_stale_reading_is_no_motion(seconds: float) -> None:
    """The last value is repeated for a while, and the actuator is elsewhere afterwards.

    Known truth: what is left out are these samples, and the stiffness is what it is without them.
    """
    whole = noisy()
    stale = slice(230, 230 + round(50.0 * seconds))
    values = whole.copy()
    values[stale] = values[230]
    log = with_angle(values)
    np.testing.assert_array_equal(np.flatnonzero(dropout_mask(log)), np.arange(1000)[stale])
    found, without = (fit(one, model="oscillator") for one in (log, with_angle(whole)))
    assert found.parameter("Q").value == pytest.approx(without.parameter("Q").value, rel=1e-3)
    assert found.statistics[0].rmse == pytest.approx(without.statistics[0].rmse, rel=0.02)
    assert any("stale" in issue.message for issue in found.issues)


def test_a_reading_that_is_stuck_for_a_moment() -> None:
    """Five samples stay at a value that is off, and five at one while the actuator moves on."""
    values = noisy().copy()
    values[400:405] = values[400] - 0.3
    quick = int(np.argmax(np.abs(values[10:] - values[:-10])))
    values[quick : quick + 5] = values[quick]
    expected = np.zeros(values.size, bool)
    expected[400:405] = expected[quick : quick + 5] = True
    np.testing.assert_array_equal(dropout_mask(with_angle(values)), expected)


@pytest.mark.parametrize("steps", [1.0, 2.0, 5.0])
def test_readings_that_rounding_repeats_are_not_stuck(steps: float) -> None:
    """Noise of so many steps of the converter, in motion and at rest: several values repeat."""
    step = 0.01 / steps
    rounded = step * np.round(noisy() / step)
    assert not dropout_mask(with_angle(rounded)).any()


def test_a_stale_reading_that_goes_on_from_near_there_is_none() -> None:
    """The sensor is back when the motion is where it was, after the input went far away."""
    log = linear_log(noise=0.01)
    pressure, values = log.channels["pressure"].values, noisy().copy()
    begin = 150
    end = next(
        k
        for k in range(begin + 45, 400)
        if abs(values[k] - values[begin]) < 0.02
        and np.median(np.abs(pressure[begin:k] - pressure[begin])) > 0.2 * np.ptp(pressure)
    )
    values[begin:end] = values[begin]
    found = dropout_mask(with_angle(values))
    np.testing.assert_array_equal(np.flatnonzero(found), np.arange(begin, end))


def test_a_reading_without_noise_that_goes_on_from_there_is_kept() -> None:
    """A pump stops and its noise with it; the actuator is at rest, so that nothing was missed."""
    values = noisy().copy()
    values[:48] = values[20]
    log = with_angle(values)
    assert not dropout_mask(log).any()
