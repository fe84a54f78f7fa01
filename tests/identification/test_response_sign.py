"""Logs whose outputs go different ways, and fits that explain nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import linear_angle, linear_log

from softid.errors import IdentificationError
from softid.identification import fit
from softid.identification.response_sign import correlation, falls_with_input, opposed
from softid.log import Log, LogSet


def turned(log: Log, name: str) -> Log:
    angle = log.channels["angle"]
    return replace(
        log, name=name, channels={**log.channels, "angle": replace(angle, values=-angle.values)}
    )


def still(seed: int, samples: int = 1000) -> Log:
    """Steps of the pressure, and an angle that is noise."""
    log = linear_log(samples=samples)
    noise = 0.01 * np.random.default_rng(seed).standard_normal(samples)
    angle = replace(log.channels["angle"], values=noise)
    return replace(log, channels={**log.channels, "angle": angle})


def test_a_log_that_goes_the_other_way_is_told() -> None:
    """By definition: the same log with its sign turned, fitted or held out."""
    first = linear_log(noise=0.01)
    again, other = linear_log(noise=0.01, seed=1), turned(linear_log(noise=0.01, seed=2), "turned")
    assert opposed(LogSet((first, again)), ()) == ()
    for logs, held in (((first, again, other), ()), ((first, again), (other,))):
        (issue,) = opposed(LogSet(logs), held)
        assert issue.message == f"turned: angle falls as pressure rises, unlike in {first.name}"
    found = fit(first, model="oscillator", hold_out=other)
    assert found.issues[0].code == "opposed-signs"


@pytest.mark.slow
def test_logs_of_both_signs_explain_nothing_together() -> None:
    """What one needs the other contradicts; the error names the log that differs."""
    logs = [linear_log(noise=0.01), turned(linear_log(noise=0.01), "turned")]
    with pytest.raises(IdentificationError, match="explains nothing of angle") as caught:
        fit(logs, model="oscillator")
    assert "turned: angle falls" in str(caught.value.remedy)
    assert caught.value.exit_code == 4


@pytest.mark.parametrize("seed", range(5))
def test_noise_is_not_explained(seed: int) -> None:
    """A deaf sensor: seven unknowns take away less than a hundredth of white noise."""
    for model in ("oscillator", "muscle"):
        with pytest.raises(IdentificationError, match="explains nothing"):
            fit(still(seed), model=model)


def test_a_weak_answer_is_explained() -> None:
    """Noise of three times the motion's own standard deviation leaves 10 % of the variance."""
    sd = float(np.std(linear_log().channels["angle"].values))
    found = fit(linear_log(noise=3.0 * sd), model="oscillator")
    assert 2.0 < found.statistics[0].fit_percent < 10.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("lag_s", [0.0, 0.4])
def test_the_way_of_an_output_that_lags_by_more_than_a_quarter_turn(
    sign: float, lag_s: float
) -> None:
    """One that falls then moves with the input, and one that rises against it.

    A single sine that begins in mid-motion is any free motion without damping.
    """
    time_s = np.arange(0.0, 30.0, 0.02)
    pressure = 50.0 + 20.0 * (np.sin(0.9 * np.pi * time_s) + np.sin(1.1 * np.pi * time_s))
    late = linear_angle(time_s, np.interp(time_s - lag_s, time_s, pressure))
    angle = sign * late + 0.01 * np.random.default_rng(6).standard_normal(time_s.size)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})
    whole = LogSet((log.between(5.0, 30.0),))
    assert (correlation(whole) * sign < 0.0) == (lag_s > 0.0)
    assert falls_with_input(whole, rng=np.random.default_rng(0)) == (sign < 0.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("mass", "least"), [(6.0, 0.55), (8.0, 0.7), (12.0, 0.8)])
def test_a_heavy_actuator_past_its_natural_frequency_moves_against_its_input(
    sign: float, mass: float, least: float
) -> None:
    """One that falls follows it then as closely as one that rises under steps."""
    time_s = np.arange(0.0, 40.0, 0.02)
    turns = 2.0 * np.pi * np.array([0.7, 1.0, 1.3]) * time_s[:, None] + np.arange(3.0)
    pressure = 50.0 + 20.0 * np.sin(turns).sum(axis=1)
    angle = sign * linear_angle(time_s, pressure - pressure[0], {"M": mass, "N": 20.0, "Q": 50.0})
    angle += 0.01 * np.random.default_rng(6).standard_normal(time_s.size)
    whole = Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})
    logs = LogSet((whole.between(10.0, 40.0),))
    assert -sign * correlation(logs) > least
    assert falls_with_input(logs, rng=np.random.default_rng(0)) == (sign < 0.0)


def test_an_output_that_does_not_move_goes_no_way() -> None:
    log = linear_log()
    angle = replace(log.channels["angle"], values=np.zeros(len(log)))
    same = replace(log, channels={**log.channels, "angle": angle})
    assert not falls_with_input(LogSet((same,)), rng=np.random.default_rng(0))
