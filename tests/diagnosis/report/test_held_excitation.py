"""What is on record already is not asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from softid.diagnosis.report.held_excitation import (
    ANY_OF,
    SEE_MORE,
    held_experiments,
    is_held,
    moves_quickly,
    with_advice_lacking,
)
from softid.diagnosis.verdict.separations import CHIRP, EXPERIMENTS, HOLD, SINE, STAIRCASE, STEPS
from softid.diagnosis.verdict.unlisted_laws import UNLISTED_LAWS
from softid.effects import EFFECTS
from softid.errors import Issue
from softid.log import Log
from softid.models.muscle import Muscle

Array = npt.NDArray[np.float64]

TIME_S = np.arange(0.0, 75.0, 0.01)


def recorded(pressure: Array, noise_kpa: float = 0.1) -> Log:
    """A log whose output does not matter."""
    noise = noise_kpa * np.random.default_rng(2).standard_normal(pressure.size)
    channels = {"pressure": pressure + noise, "angle": 0.01 * pressure}
    return Log.from_arrays(TIME_S[: pressure.size], channels)


def levels(every_s: float, rise_s: float, values: list[float]) -> Array:
    """Levels held in turn, each reached on a straight line."""
    begins_s = every_s * np.arange(len(values))
    corner_s = np.sort(np.concatenate((begins_s, begins_s[1:] - rise_s)))
    passed: Array = np.interp(TIME_S, corner_s, np.repeat(values, 2)[:-1])
    return passed


def chirp(top_hz: float) -> Array:
    """From a tenth of that frequency to it within the log."""
    grown = 0.1 * top_hz * TIME_S + 0.45 * top_hz * TIME_S**2 / TIME_S[-1]
    swung: Array = 60.0 - 40.0 * np.cos(2.0 * np.pi * grown)
    return swung


UP_AND_DOWN = [0.0, 40.0, 80.0, 120.0, 80.0, 40.0, 0.0, 60.0, 120.0, 60.0, 0.0, 80.0]


@pytest.mark.parametrize(
    ("pressure", "held"),
    [
        (levels(5.0, 0.05, UP_AND_DOWN), {STEPS, STAIRCASE}),
        (levels(1.2, 0.05, UP_AND_DOWN), {STEPS}),
        (levels(5.0, 1.5, UP_AND_DOWN), {STAIRCASE}),
        (levels(25.0, 1.5, [0.0, 90.0, 0.0]), {HOLD}),
        (60.0 - 40.0 * np.cos(np.pi * TIME_S), {SINE}),
        (chirp(4.0), {CHIRP}),
        (chirp(0.5), set()),
    ],
    ids=["steps", "brief steps", "slow staircase", "hold", "sine", "chirp", "slow chirp"],
)
def test_what_a_log_holds(pressure: Array, held: set[str]) -> None:
    """By construction; the noise of the gauge does not matter."""
    found = held_experiments([recorded(pressure)])
    assert found & {STEPS, HOLD, CHIRP} == held & {STEPS, HOLD, CHIRP}
    assert held <= found
    assert moves_quickly(found) == bool(held & {STEPS, CHIRP})


@pytest.mark.parametrize("noise_kpa", [0.0, 0.1])
def test_a_log_at_rest_holds_nothing(noise_kpa: float) -> None:
    """Whether its gauge shows noise or not, and where the recorder stalled once."""
    log = recorded(np.full(TIME_S.size, 60.0), noise_kpa)
    assert held_experiments([log]) == frozenset()
    late_s = log.time_s + 20.0 * (log.time_s > 30.0)
    assert held_experiments([replace(log, time_s=late_s)]) == frozenset()


def test_logs_hold_together_what_each_does() -> None:
    logs = [recorded(levels(5.0, 0.05, UP_AND_DOWN)), recorded(chirp(4.0))]
    assert held_experiments(logs) >= {STEPS, CHIRP}


def test_advice_in_other_words_is_never_held() -> None:
    """A log that holds all may still lack the same steps at its end, or a look at the sensor."""
    everything = frozenset(EXPERIMENTS)
    assert is_held("fast steps, or a chirp", frozenset((CHIRP,)))
    assert not is_held("the same fast steps at the beginning and end of a long log", everything)
    assert not is_held(STEPS, frozenset((CHIRP, SINE)))


def test_a_remark_does_not_advise_what_is_held() -> None:
    """An inertia that fast steps do not show needs faster samples; other advice stays."""
    unseen = Issue(
        "not-seen", "warning", "it cannot be seen", f"record {Muscle.identified_by['M']}"
    )
    other = Issue("weakly-identified", "info", "a2 is weakly identified", "record a staircase")
    issues = (unseen, other, Issue("coloured-residual", "info", "it is coloured"))
    assert with_advice_lacking(issues, frozenset((SINE,))) == issues
    first, *rest = with_advice_lacking(issues, frozenset((STEPS,)))
    assert first.remedy == SEE_MORE
    assert tuple(rest) == issues[1:]


def test_the_words_are_those_of_the_advice() -> None:
    """So that nothing is asked for in other words one day."""
    laws = (*EFFECTS.values(), *UNLISTED_LAWS)
    wanted = Muscle.identified_by.values()
    assert set(ANY_OF) <= {*EXPERIMENTS, *(law.shown_by for law in laws), *wanted}
