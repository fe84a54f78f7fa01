"""Terms that the samples cannot show are dropped, and those that they show are not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import chirp, lsim

from softid import Log, fit
from softid.models import Oscillator

MASS, DAMPING = 0.4, 10.0


def drive_log(stiffness: float) -> Log:
    """Half a minute of a mass that a force pushes about, on a spring, with 0.2 % of noise."""
    time_s = 0.02 * np.arange(1500)
    force = np.repeat(np.random.default_rng(1).uniform(-50.0, 50.0, 30), 50) - 3.0
    system = ([1.0], [MASS, DAMPING, stiffness])
    _, position, _ = lsim(system, force, time_s, interp=False)
    noise = 0.002 * np.ptp(position) * np.random.default_rng(2).standard_normal(time_s.size)
    channels = {"force": force, "position": position + noise}
    log = Log.from_arrays(time_s, channels, input="force", outputs=["position"])
    return log.with_intersample("zoh")


def test_a_spring_that_comes_too_late_for_the_log_is_none() -> None:
    """Known truth without a spring: it is dropped from the model that has one, and told; the mean
    force, which a spring would have to hold, is an offset then."""
    found = fit(drive_log(0.0), model="oscillator")
    assert found.model.options["spring"] == "none"
    stiffness = found.parameter("Q")
    assert (stiffness.value, stiffness.verdict) == (0.0, "not identified")
    assert "the motion would come back in" in stiffness.reason
    assert found.parameter("N").value == pytest.approx(DAMPING, rel=0.02)
    assert abs(found.parameter("offset").value) < 0.2


def test_a_spring_that_shows_stays() -> None:
    """It would bring the motion back in five lengths of the log, and is found to a tenth."""
    truth = DAMPING / 150.0
    found = fit(drive_log(truth), model="oscillator")
    assert found.model.options["spring"] == "linear"
    assert found.parameter("Q").value == pytest.approx(truth, rel=0.1)


def test_a_spring_that_the_user_holds_stays() -> None:
    """A fixed stiffness is no free term that could be dropped."""
    model = Oscillator(x_unit="mm", u_unit="N")
    held = model.parameters().with_values({"Q": 1e-3}).with_fixed({"Q": 1e-3})
    found = fit(drive_log(0.0), model="oscillator", parameters=held)
    assert found.parameter("Q").value == 1e-3
    assert found.model.options["spring"] == "linear"


def test_an_inertia_shows_between_slow_readings_where_the_input_moves_there() -> None:
    """Known truth: it swings at 4.1 Hz, and a gauge takes five readings a second of what a chirp of
    0.2 to 6 Hz makes it do. Without the inertia four times as much would be left."""
    time_s = 0.01 * np.arange(4800)
    pressure = 100.0 + 80.0 * chirp(time_s, 0.2, time_s[-1], 6.0)
    stiffness, damping, mass = 4.7, 0.23, 0.0072
    _, moved, _ = lsim(([1.0], [mass, damping, stiffness]), pressure, time_s)
    noise = 0.28 * np.random.default_rng(3).standard_normal(240)
    channels = {"pressure": pressure, "contraction": np.repeat(moved[::20] + noise, 20)}
    found = fit(Log.from_arrays(time_s, channels), model="oscillator")
    for name, truth in {"M": mass, "N": damping, "Q": stiffness}.items():
        assert found.parameter(name).value == pytest.approx(truth, rel=0.1)
    assert found.parameter("M").verdict == "identified"
