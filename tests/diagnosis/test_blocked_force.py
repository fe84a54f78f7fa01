"""The force of an actuator that is held in its place, computed by hand."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from scipy.signal import lsim

from softid.diagnosis import diagnose
from softid.diagnosis_results import Verdict
from softid.log import Log

Array = npt.NDArray[np.float64]

SHARE, SLOW_S, FAST_S, NOISE_N = 0.15, 4.0, 0.05, 1.0


def blocked_log(seed: int, share: float) -> Log:
    """Force 1.2 N/kPa behind a lag of 50 ms, of which a share relaxes in 4 s; both by `lsim`."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(0.0, 60.0, 0.01)
    corners_s = np.cumsum(rng.uniform(0.5, 4.0, 40))
    levels = rng.uniform(0.0, 200.0, 41)
    levels[0] = 0.0
    pressure = levels[np.searchsorted(corners_s, time_s)]
    pressure = lsim(([1.0], [0.02, 1.0]), pressure, time_s)[1]
    fast = lsim(([1.0], [FAST_S, 1.0]), pressure, time_s)[1]
    slow = lsim(([1.0], [SLOW_S, 1.0]), pressure, time_s)[1]
    force = 1.2 * (fast - share * slow) + NOISE_N * rng.normal(size=time_s.size)
    return Log.from_arrays(
        time_s, {"pressure": pressure, "force": force}, units={"force": "N"}, name=f"held_{seed}"
    )


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.0, SHARE])
def test_a_force_that_relaxes_is_told(share: float) -> None:
    """A held log that keeps its force is adequate; one that relaxes has the share and time put in,
    within a tenth, for the relaxation follows the pressure and not the force that lags behind it.
    """
    found = diagnose(blocked_log(1, share), hold_out=[blocked_log(2, share)], model="oscillator")
    if share == 0.0:
        assert found.verdict is Verdict.ADEQUATE
        return
    assert [cause.key for cause in found.causes] == ["relaxation"]
    assert not found.alternatives
    values = {p.name: p.value for p in found.causes[0].parameters}
    assert values["relaxation_c"] == pytest.approx(SHARE, rel=0.1)
    assert values["relaxation_tau"] == pytest.approx(SLOW_S, rel=0.1)


def test_a_sensor_that_loses_all_that_stands_still_is_told() -> None:
    """A piezoelectric one: the share is at its bound of 1, which is no other law."""
    effects = ["relaxation", "sensor_drift"]
    logs = [blocked_log(seed, 1.0) for seed in (1, 2)]
    found = diagnose(logs[0], hold_out=logs[1:], model="oscillator", effects=effects)
    assert found.verdict is Verdict.NAMED
    assert [cause.key for cause in found.causes] == ["relaxation"]
    values = {p.name: p.value for p in found.causes[0].parameters}
    assert values["relaxation_c"] == pytest.approx(1.0, rel=0.01)
    assert values["relaxation_tau"] == pytest.approx(SLOW_S, rel=0.1)
