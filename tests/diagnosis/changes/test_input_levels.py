"""Logs that can be held against each other, by the levels of their input."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from softid.diagnosis.changes.input_levels import have_same_levels
from softid.log import Log

Array = npt.NDArray[np.float64]

TIME_S = np.arange(1200) / 100.0
TWO_LEVELS = np.where(np.floor(TIME_S) % 2 == 0, 20.0, 80.0)
THREE_LEVELS = np.choose(np.floor(TIME_S).astype(int) % 3, [20.0, 50.0, 80.0])
SINE = 50.0 + 30.0 * np.sin(TIME_S)
RAMP = 20.0 + 60.0 * TIME_S / TIME_S[-1]


def log_of(pressure: Array) -> Log:
    return Log.from_arrays(TIME_S, {"pressure": pressure, "angle": pressure / 10.0})


@pytest.mark.parametrize(
    ("known", "other", "same"),
    [
        (SINE, RAMP, True),
        (RAMP, THREE_LEVELS, True),
        (TWO_LEVELS, TWO_LEVELS + 3.0, True),
        (TWO_LEVELS, THREE_LEVELS, False),
        (TWO_LEVELS, RAMP, False),
        (SINE, SINE + 40.0, False),
    ],
    ids=["sine-ramp", "ramp-levels", "levels-again", "a-third-level", "between-levels", "higher"],
)
def test_a_log_is_held_against_others_whose_levels_it_visits(
    known: Array, other: Array, same: bool
) -> None:
    assert have_same_levels([log_of(known)], [log_of(other)]) == same


def test_levels_of_several_logs_count_together_and_every_other_log_must_visit_them() -> None:
    both = [log_of(TWO_LEVELS), log_of(RAMP)]
    assert have_same_levels(both, [log_of(THREE_LEVELS)])
    assert not have_same_levels([log_of(TWO_LEVELS)], [log_of(TWO_LEVELS), log_of(THREE_LEVELS)])
