"""Laws that act in the fast part of a log alone, and numbers that change there for good."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import RATE_HZ, TRUTH, linear_angle, linear_problem, standing

from softid.diagnosis.base.base_fit import Request
from softid.diagnosis.changes.events import events_in
from softid.diagnosis.changes.spells import Spells, moves_as_in, spells_of, usual_samples
from softid.diagnosis.refit.candidates import Candidate, advance
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]

FAINT = 0.003
N, NOISE, MOTION_S, BEGUN_S, LATE_S = 2000, 0.01, 0.1, 4.0, 26.0
TIME_S = np.arange(N) / RATE_HZ
SOFT, LIGHT = {**TRUTH, "Q": 0.8 * TRUTH["Q"]}, {**TRUTH, "M": 0.5 * TRUTH["M"]}


def row(
    fast: npt.NDArray[np.bool_],
    other: npt.NDArray[np.bool_],
    name: str = "row",
    *,
    truth: Mapping[str, float] = SOFT,
    noise: float = NOISE,
) -> Log:
    """Half a hertz, or two hertz upon an eighth of one, and an actuator that is another at times.

    It comes to the middle within four seconds, more evenly than either.
    """
    since_s = TIME_S - LATE_S  # all are in their middle then, and eight seconds before and after
    slow, quick, slower = (np.sin(2.0 * np.pi * hertz * since_s) for hertz in (0.5, 2.0, 0.125))
    begins = 25.0 * (1.0 - np.cos(0.25 * np.pi * TIME_S))
    moved = np.where(fast, 8.0 * quick + 20.0 * slower, 30.0 * slow)
    driven = np.where(TIME_S < BEGUN_S, begins, 50.0 + moved)
    angle = np.where(other, *(linear_angle(TIME_S, driven, one) for one in (truth, TRUTH)))
    trembling = noise * np.random.default_rng(len(name)).standard_normal(N)
    channels = {"pressure": driven, "angle": angle + trembling}
    return Log.from_arrays(TIME_S, channels, name=name)


def until(end_s: float) -> npt.NDArray[np.bool_]:
    return end_s > TIME_S


ALWAYS, NEVER, LATE = until(50.0), until(-1.0), ~until(LATE_S)
MOSTLY = until(38.0)


def spells_of_row(log: Log) -> Spells:
    def fit(log: Log) -> Candidate:
        problem = linear_problem([log])
        return advance(standing(problem, problem.unknowns(TRUTH)), {"angle": NOISE}, 40)

    found = spells_of(log, fit, NOISE**2)
    assert found is not None
    return found


def test_what_is_fast_is_met_nowhere_in_what_is_slow() -> None:
    """It goes less far and hardly faster, but not as evenly; slow and fast, it would be met."""
    found = spells_of_row(row(LATE, LATE))
    assert found.ends_last
    assert not found.is_met
    assert spells_of_row(row(NEVER, LATE)).is_met


def test_another_log_is_usual_where_it_is_slow() -> None:
    """But for a while behind what is fast, which the motion remembers."""
    spells = spells_of_row(row(LATE, LATE))
    usual = usual_samples(row(until(10.0), NEVER), spells, MOTION_S)
    assert not usual[until(10.0) & (TIME_S > BEGUN_S)].any()
    assert usual[~until(12.0)].mean() > 0.9
    assert moves_as_in(row(until(10.0), NEVER), spells)
    assert not moves_as_in(row(NEVER, NEVER), spells)


def test_what_lasts_into_a_rest_lasts_to_the_end() -> None:
    """A spring shows nothing of itself without pressure: the spell does not end where that goes."""
    log = row(LATE, LATE)
    rests = TIME_S > 36.0
    driven = np.where(rests, 0.0, log.channels["pressure"].values)
    angle = np.where(LATE, *(linear_angle(TIME_S, driven, truth) for truth in (SOFT, TRUTH)))
    noise = NOISE * np.random.default_rng(1).standard_normal(N)
    channels = {"pressure": driven, "angle": angle + noise}
    found = spells_of_row(Log.from_arrays(TIME_S, channels, name="rests"))
    ((begin, end),) = found.spans_s
    assert begin == pytest.approx(LATE_S, abs=0.5)
    assert end == TIME_S[-1]
    assert found.ends_last


@pytest.mark.parametrize(
    ("fast", "soft", "is_event"),
    [(NEVER, ALWAYS, True), (until(34.0), until(34.0), False), (ALWAYS, ~until(BEGUN_S), False)],
    ids=["soft when slow, too", "soft when fast", "soft but at the start"],
)
def test_a_number_has_changed_if_another_log_has_it_in_slow_motion(
    fast: npt.NDArray[np.bool_], soft: npt.NDArray[np.bool_], is_event: bool
) -> None:
    """A spring that gave way is soft throughout the next log; one that is soft in fast motion is a
    law, whose next log is as the end of the first one for the most part."""
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    judge = row(fast, soft, "another")
    base = request.fit_base(LogSet((row(LATE, LATE),)), (judge,), thorough=False)
    assert bool(events_in(base)) is is_event


@pytest.mark.parametrize(
    ("fast", "light", "is_event"),
    [(MOSTLY, ALWAYS, True), (MOSTLY, MOSTLY, False)],
    ids=["light when slow, too", "light when fast"],
)
def test_an_inertia_that_slow_motion_hardly_shows_has_changed_if_that_shows_it(
    fast: npt.NDArray[np.bool_], light: npt.NDArray[np.bool_], is_event: bool
) -> None:
    """A payload that was taken off, or a law that acts at large accelerations alone: with half of
    the inertia the next log is followed nearly as well in either case."""
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    train = row(LATE, LATE, truth=LIGHT, noise=FAINT)
    judge = row(fast, light, "another", truth=LIGHT, noise=FAINT)
    base = request.fit_base(LogSet((train,)), (judge,), thorough=False)
    assert bool(events_in(base)) is is_event
