"""Channels that move like a second input."""

from __future__ import annotations

import numpy as np
import pytest

from softid import Log, fit, inspect
from softid.quality.second_inputs import SECOND_INPUT, independent_inputs

TIME_S = np.arange(0.0, 40.0, 0.02)


def levels(seed: int) -> np.ndarray:
    """Random levels of 2 s each, in kPa."""
    rng = np.random.default_rng(seed)
    return np.repeat(rng.uniform(0.0, 100.0, 20), TIME_S.size // 20)


def log_with(other: np.ndarray) -> Log:
    """A log of an angle that follows the first of two pressures only."""
    pressure = levels(1)
    angle = np.zeros_like(TIME_S)
    for k in range(1, TIME_S.size):
        angle[k] = angle[k - 1] + 0.02 / 0.2 * (0.01 * pressure[k - 1] - angle[k - 1])
    noise = np.random.default_rng(2).normal(0.0, 0.005, TIME_S.size)
    channels = {"pressure": pressure, "angle": angle + noise, "second_kpa": other}
    return Log.from_arrays(TIME_S, channels, units={"second_kpa": "kPa"}, outputs=["angle"])


@pytest.mark.parametrize(
    ("other", "told"),
    [
        (levels(7), ("second_kpa",)),
        (0.5 * levels(1) + 3.0, ()),
        (np.roll(levels(1), 40), ()),
        (np.random.default_rng(3).normal(0.0, 10.0, TIME_S.size), ()),
        (20.0 * np.repeat(np.random.default_rng(3).normal(0.0, 0.5, 500).round(), 4), ()),
        (0.1 * levels(7), ()),
    ],
    ids=["on its own", "alike", "late", "noise", "coarse and held noise", "small"],
)
def test_only_what_moves_on_its_own_is_told(other: np.ndarray, told: tuple[str, ...]) -> None:
    """A copy, a copy that is 0.8 s late, noise and what hardly moves are no second input."""
    log = log_with(other)
    assert independent_inputs(log) == told
    codes = [issue.code for issue in inspect(log).issues]
    assert (SECOND_INPUT in codes) == bool(told)


def test_a_fit_tells_it_once_with_the_name_of_the_log() -> None:
    """A fit takes one input, and what another one does for something else."""
    issues = fit(log_with(levels(7)), model="oscillator").issues
    (told,) = (issue for issue in issues if issue.code == SECOND_INPUT)
    assert "second_kpa moves as an input does, and not with pressure" in told.message
