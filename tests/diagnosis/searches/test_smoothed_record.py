"""A true model over a record that was filtered after it was taken, as motion capture often is."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from scipy.signal import butter, filtfilt, savgol_filter

from softid.diagnosis import diagnose
from softid.diagnosis.searches.smoothed_record import SMOOTHED_RECORD
from softid.diagnosis_results import Verdict
from softid.log import Log
from softid.synthesis import hidden_pair

Array = npt.NDArray[np.float64]

RATE_HZ = 100.0


def there_and_back(cut_off_hz: float, order: int) -> Callable[[Array], Array]:
    """A Butterworth filter that delays nothing."""
    b, a = butter(order, cut_off_hz / (0.5 * RATE_HZ))
    return lambda y: np.asarray(filtfilt(b, a, y))


def filtered(log: Log, smooth: Callable[[Array], Array]) -> Log:
    """The log with its output smoothed."""
    (name,) = log.outputs
    channels = {log.input: log.channels[log.input].values, name: smooth(log.channels[name].values)}
    units = {key: log.channels[key].unit for key in channels}
    return Log.from_arrays(log.time_s, channels, outputs=(name,), units=units, name=log.name)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "smooth"),
    [
        (7, there_and_back(6.0, 4)),
        (8, lambda y: savgol_filter(y, 21, 3)),
        (9, there_and_back(6.0, 4)),
    ],
)
def test_a_filter_that_moves_the_prediction_is_named(
    seed: int, smooth: Callable[[Array], Array]
) -> None:
    """Stands on the truth of the generator: the filter is in both logs, and nothing else is."""
    train, judge = (filtered(log, smooth) for log in hidden_pair((), seed=seed).logs)
    found = diagnose([train], hold_out=[judge], model="muscle")
    assert found.verdict is Verdict.NAMED
    assert [cause.effect for cause in found.causes] == ["smoothing"]
    assert not found.alternatives


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "smooth", "is_told"),
    [
        (7, there_and_back(10.0, 2), True),
        (10, there_and_back(10.0, 4), False),
        (11, there_and_back(20.0, 2), True),
    ],
)
def test_noise_behind_a_filter_is_no_misfit(
    seed: int, smooth: Callable[[Array], Array], *, is_told: bool
) -> None:
    """A filter that moves no prediction is told as one of the record, or its noise as slow."""
    train, judge = (filtered(log, smooth) for log in hidden_pair((), seed=seed).logs)
    found = diagnose([train], hold_out=[judge], model="muscle")
    assert found.verdict is Verdict.ADEQUATE
    assert not found.causes
    assert not found.alternatives
    assert (SMOOTHED_RECORD in {issue.code for issue in found.issues}) is is_told
    assert ("as if it was smoothed after it was recorded" in found.summary) is is_told
    assert ("has the marks of slow noise" in found.summary) is not is_told


@pytest.mark.slow
@pytest.mark.parametrize(
    "effect",
    [
        "coulomb_friction",
        "creep",
        "stiffening",
        "dead_zone",
    ],
)
def test_a_cause_behind_a_filter_is_still_found(effect: str) -> None:
    """The filter is in both logs; it may be named beside the cause, or not."""
    smooth = there_and_back(8.0, 4)
    train, judge = (filtered(log, smooth) for log in hidden_pair((effect,), seed=12).logs)
    found = diagnose([train], hold_out=[judge], model="muscle")
    assert effect in {cause.effect for cause in found.causes}
    assert {cause.effect for cause in found.causes} <= {effect, "smoothing"}
