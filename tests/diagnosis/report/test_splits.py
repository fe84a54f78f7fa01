"""What would tell causes apart is asked for only where the logs lack it."""

from __future__ import annotations

import pytest
from handmade_diagnosis import TIE, diagnosis

from softid.diagnosis.report.splits import advised_split, split_in_words, why_tied_here
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis.verdict.separations import (
    CHIRP,
    EXPERIMENTS,
    HOLD,
    STEPS,
    splitting_experiment,
    why_unsplit,
)
from softid.diagnosis_results import Verdict

LAGS = ("delay", "pneumatic_lag")
LATE = ("delay", "smoothing.past", "sensor_resonance", "line_resonance")
EVERYTHING = frozenset(EXPERIMENTS)


@pytest.mark.parametrize("keys", [LAGS, LATE, ("creep", "hysteresis")])
def test_without_logs_the_best_is_advised(keys: tuple[str, ...]) -> None:
    """As the table of separations and the catalogue say."""
    split, advice = splitting_experiment(keys), advised_split(keys, frozenset())
    assert split is not None
    assert advice is not None
    assert (advice.experiment, advice.is_again) == (split.experiment, False)
    assert why_tied_here(keys, frozenset(), alike=True) == why_unsplit(keys)


@pytest.mark.parametrize(
    ("keys", "held", "words"),
    [
        (LAGS, {CHIRP}, "record fast steps, to tell delay of the input from lag of the pneu"),
        (LAGS, {STEPS}, "record a chirp from slow to fast, to tell delay of the input from l"),
        (LAGS, EVERYTHING, "record a chirp from slow to fast once more, for longer or with less "),
        (("creep", "hysteresis"), {HOLD}, "record a sine of 0.5 Hz, to tell creep of the mat"),
    ],
)
def test_the_next_best_is_advised_where_the_best_is_held(
    keys: tuple[str, ...], held: set[str], words: str
) -> None:
    """By the table: a delay and a lag differ by 4.9 in a chirp and 3 in steps, a third of the noise
    and less in what else there is; creep and hysteresis by 4.2 in a hold and 4.1 in a sine."""
    assert (split_in_words(keys, frozenset(held)) or "").startswith(words)


def test_of_what_shows_each_only_what_is_lacking_is_advised() -> None:
    """Steps show a delay and a moving average; nobody is told to record them twice."""
    told = split_in_words(LATE, frozenset((STEPS,)))
    assert told == (
        "record a chirp beyond the bandwidth of the sensor, at two offsets, to tell delay of the "
        "input from the others"
    )
    assert "What these logs lack and would help: a chirp beyond" in why_tied_here(
        LATE, frozenset((STEPS,)), alike=True
    )
    assert "is in these logs, but too faintly" in why_tied_here(LAGS, EVERYTHING, alike=True)


def test_the_paragraph_asks_for_what_is_lacking() -> None:
    found = diagnosis(Verdict.AMBIGUOUS)
    bare = type(found)(**{**vars(found), "next_experiment": None, "alternatives": (TIE,)})
    assert "Next: record a chirp from slow to fast, to tell" in write_summary(bare).summary
    asked = write_summary(bare, frozenset((CHIRP,))).summary
    assert "Next: record fast steps, to tell" in asked
