"""Whether a zero or a load shifted a reading, on logs of a linear actuator with either."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import RATE_HZ, TRUTH, linear_angle, linear_problem, pressure_course, standing
from scipy.signal import lfilter

from softid.diagnosis.changes.change_point import change_point
from softid.diagnosis.changes.shifts import Shift, shift_at
from softid.diagnosis.changes.spells import residual_in
from softid.diagnosis.refit.candidates import Candidate, advance
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.log import Log
from softid.uncertainty.autoregression import fit_ar

Array = npt.NDArray[np.float64]

TIME_S = np.arange(2000) / RATE_HZ
SIZE = 0.2
"""What stays of a shift, in rad."""

RINGING = {"M": 2.0, "N": 4.0, "Q": 50.0}
FAST = {"M": 0.0, "N": 0.1, "Q": 50.0}
"""A time constant of 2 ms, where samples are 20 ms apart."""


def acts(begin_s: float, end_s: float) -> Array:
    return np.where((begin_s <= TIME_S) & (end_s > TIME_S), 1.0, 0.0)


def shifted(kind: str, truth: dict[str, float], when: Array, noise: Array) -> Log:
    """A load is a force against the input; it moves the actuator, and a zero the reading alone."""
    pressure = pressure_course(TIME_S)
    arriving = pressure + when * SIZE * truth["Q"] * (kind == "load")
    angle = linear_angle(TIME_S, arriving, truth) + when * SIZE * (kind == "zero") + noise
    return Log.from_arrays(TIME_S, {"pressure": pressure, "angle": angle}, name=kind)


def standing_on(log: Log, truth: dict[str, float]) -> Candidate:
    problem = linear_problem([log])
    return standing(problem, problem.unknowns(truth))


def found_in(
    kind: str,
    truth: dict[str, float],
    noise: Array,
    when: Array,
    moments_s: tuple[float, ...] = (12.3, 31.2),
) -> Shift | None:
    """What is found at moments that are known to a tenth of a second only."""
    log = shifted(kind, truth, when, noise)
    model = standing_on(log, truth)
    _, left = residual_in(log, model)
    return shift_at(moments_s, model, TIME_S, left, fit_ar([noise]))


def white(seed: int, sigma: float) -> Array:
    return sigma * np.random.default_rng(seed).standard_normal(TIME_S.size)


@pytest.mark.parametrize("truth", [TRUTH, RINGING], ids=["overdamped", "ringing"])
@pytest.mark.parametrize("kind", ["zero", "load"])
def test_a_load_is_told_from_a_zero(kind: str, truth: dict[str, float]) -> None:
    """Known truth, from 12.4 to 31.1 s, and for good from 12.4 s on."""
    for end_s, moments_s in ((31.1, (12.3, 31.2)), (99.0, (12.3,))):
        when = acts(12.4, end_s)
        found = found_in(kind, truth, white(1, 0.01), when, moments_s)
        assert found is not None
        assert found.kind == kind
        assert found.size == pytest.approx(SIZE, abs=0.01)


@pytest.mark.parametrize("kind", ["zero", "load"])
def test_slow_noise_is_allowed_for(kind: str) -> None:
    """Known truth under noise that is alike over 0.4 s, as long as the actuator takes to settle."""
    noise = lfilter([1.0], [1.0, -0.95], white(2, 0.003))
    found = found_in(kind, TRUTH, noise, acts(12.4, 31.1))
    assert found is not None
    assert found.kind == kind


def test_what_settles_between_two_samples_is_either() -> None:
    """Nothing in the log tells; nor where the noise is half as large as the shift."""
    for truth, sigma in ((FAST, 0.01), (TRUTH, 0.5 * SIZE)):
        for kind in ("zero", "load"):
            found = found_in(kind, truth, white(3, sigma), acts(12.4, 31.1))
            assert found is not None
            assert found.kind == "zero or load"


@pytest.mark.parametrize("seed", range(20))
def test_noise_is_no_shift(seed: int) -> None:
    """Nothing happens; white noise, and slow noise that wanders as far."""
    for noise in (white(seed, 0.01), lfilter([1.0], [1.0, -0.95], white(seed, 0.003))):
        assert found_in("zero", TRUTH, noise, acts(99.0, 99.0)) is None


@pytest.mark.parametrize("kind", ["zero", "load"])
def test_a_change_for_good_is_told_by_its_course(kind: str) -> None:
    """Known truth: the fit bends to both parts."""
    log = shifted(kind, TRUTH, acts(22.4, 99.0), white(4, 0.01))
    base = advance(standing_on(log, TRUTH), {"angle": 0.01}, 40)
    scale = scale_of(base.problem, base.minimum.point)
    left = residual_in(log, base)[1]
    found = change_point(base, scale, float(np.mean(left**2)) / 0.01**2 - 1.0)
    assert found is not None
    assert (found.kind, found.time_s) == (kind, pytest.approx(22.4, abs=0.5))
