"""What a log can identify, judged on logs whose excitation is known."""

from __future__ import annotations

import numpy as np
import pytest
from drawn_logs import follow, staircase_log

from softid.log import Log
from softid.quality import Inspection, inspect


def answered(time_s: np.ndarray, pressure: np.ndarray, lag_s: float = 0.3) -> Inspection:
    rng = np.random.default_rng(0)
    angle = 0.01 * follow(time_s, pressure, lag_s) + 1e-4 * rng.standard_normal(time_s.size)
    return inspect(Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}))


def verdicts(found: Inspection) -> dict[str, str]:
    return {a.name: a.possible for a in found.abilities}


def test_a_staircase_up_and_down() -> None:
    """Six levels, reached from both sides, timed transitions at several pressures, both pressures
    recorded; 44 s without a long hold."""
    told = verdicts(inspect(staircase_log()))
    assert told == {
        "static curve": "yes",
        "damping": "yes",
        "damping by pressure": "yes",
        "inertia": told["inertia"],
        "hysteresis": "yes",
        "creep": "no",
        "sensor drift": "no",
        "pneumatic lag": "yes",
    }
    assert told["inertia"] != "yes"


def test_one_step() -> None:
    """Two levels: gain and zero, a time constant, and nothing of shape or loops."""
    time_s = np.arange(1000) * 0.02
    told = verdicts(answered(time_s, np.where(time_s < 5.0, 0.0, 80.0)))
    assert told["static curve"] == "partly"
    assert told["damping"] == "yes"
    assert told["damping by pressure"] == "partly"
    assert told["hysteresis"] == "no"
    assert told["pneumatic lag"] == "no"


@pytest.mark.parametrize(
    ("rate_hz", "rise_s", "possible", "reason"),
    [
        (200.0, 0.0, "partly", "an upper bound at least"),
        (50.0, 0.0, "no", "quickly enough, but the 0.3 s of the output hold 15 samples only"),
        (200.0, 0.4, "no", "too slow to feel the mass"),
    ],
)
def test_an_inertia_needs_quick_steps_and_quick_samples(
    rate_hz: float, rise_s: float, possible: str, reason: str
) -> None:
    """A lag of 0.3 s: at 50 Hz it is the sampling that is too slow, whatever the valve does."""
    time_s = np.arange(0.0, 20.0, 1.0 / rate_hz)
    corner_s = np.array([0.0, 5.0, 5.0 + rise_s, 10.0, 10.0 + rise_s, 15.0, 15.0 + rise_s, 20.0])
    levels = [0.0, 0.0, 80.0, 80.0, 20.0, 20.0, 60.0, 60.0]
    pressure = np.interp(time_s, corner_s + 1e-6 * np.arange(8), levels)
    ability = answered(time_s, pressure).ability("inertia")
    assert ability.possible == possible
    assert reason in ability.reason
    if "samples only" in reason:
        assert ability.wanted == "a higher sampling rate"


def test_one_sine() -> None:
    """One frequency leaves lag, damping and inertia mixed; the curve is passed, not settled."""
    time_s = np.arange(4000) * 0.01
    told = verdicts(answered(time_s, 40.0 + 30.0 * np.sin(2 * np.pi * 0.25 * time_s)))
    assert told["static curve"] == "partly"
    assert told["damping"] == "partly"
    assert told["inertia"] == "no"
    assert told["hysteresis"] == "partly"


def test_two_speeds_show_hysteresis() -> None:
    """A triangle at 0.1 Hz and one at 0.4 Hz."""
    slow, fast = np.arange(4000) * 0.01, np.arange(2000) * 0.01
    waves = [1.0 - np.abs(2.0 * ((f * t) % 1.0) - 1.0) for f, t in ((0.1, slow), (0.4, fast))]
    pressure = 60.0 * np.concatenate([waves[0], np.zeros(300), waves[1]])
    found = answered(np.arange(pressure.size) * 0.01, pressure)
    assert found.ability("hysteresis").possible == "yes"


@pytest.mark.parametrize(
    ("hold_s", "creep", "drift"), [(10, "no", "no"), (25, "yes", "no"), (40, "yes", "yes")]
)
def test_long_holds(hold_s: float, creep: str, drift: str) -> None:
    """Creep wants 20 s of hold, drift 30 s of rest."""
    time_s = np.arange(int(50 * (hold_s + 8))) * 0.02
    told = verdicts(answered(time_s, np.where(time_s < 8.0, 0.0, 60.0)))
    assert (told["creep"], told["sensor drift"]) == (creep, drift)


def test_a_response_too_quick_for_the_sampling() -> None:
    """A time constant of half a sample: only a higher rate helps."""
    time_s = np.arange(400) * 0.1
    pressure = np.repeat([0.0, 60.0, 0.0, 60.0], 100)
    ability = answered(time_s, pressure, lag_s=0.05).ability("damping")
    assert ability.possible == "no"
    assert "sampling rate" in (ability.wanted or "")


def test_what_is_missing_is_wanted() -> None:
    """Whatever cannot be identified comes with the log that would show it."""
    time_s = np.arange(1000) * 0.02
    for ability in answered(time_s, np.where(time_s < 5.0, 0.0, 80.0)).abilities:
        assert ability.reason
        assert (ability.possible == "no") <= (ability.wanted is not None)
