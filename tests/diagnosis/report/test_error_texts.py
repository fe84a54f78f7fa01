"""Errors and gains as sentences."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from handmade_diagnosis import diagnosis, gain

from softid.diagnosis.report.issues import REFUSED
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis_results import Verdict
from softid.errors import Issue


def test_more_is_left_on_what_is_held_out() -> None:
    """0.2 degrees on the fitted samples: 0.25 held out are no more than that, 0.26 are."""
    found = diagnosis(Verdict.NAMED)
    assert found.remainder.rms * 180.0 / math.pi == pytest.approx(0.2, rel=0.01)
    for factor, more in ((1.24, False), (1.26, True)):
        gains = tuple(replace(g, rmse_after=factor * found.remainder.rms) for g in found.gains)
        text = write_summary(replace(found, gains=gains)).summary
        assert ("The held-out samples keep more" in text) is more


@pytest.mark.parametrize("verdict", [Verdict.NAMED, Verdict.PARTIAL, Verdict.UNKNOWN])
def test_what_only_the_held_out_samples_show_is_told(verdict: Verdict) -> None:
    """In each answer with the error there and what to do about it."""
    found = diagnosis(verdict)
    left = replace(found.remainder, structured=False, misses_held_out=True)
    open_end = replace(found, remainder=left, next_experiment=None)
    text = write_summary(open_end).summary
    assert "than noise and the errors of the parameters make of them: something that" in text
    assert "Next: fit what is held out together with the rest" in text
    assert "is not noise" not in text


def test_a_law_that_begins_anew_is_judged_by_blocks() -> None:
    """Where a clock or a use of the actuator began is not known of what is held out."""
    found = diagnosis(Verdict.UNKNOWN)
    left = replace(found.remainder, structured=False, misses_held_out=True)
    described = tuple(replace(c, effect="clock_rate", key="clock_rate") for c in found.descriptive)
    text = write_summary(
        replace(found, descriptive=described, remainder=left, next_experiment=None)
    ).summary
    assert "Next: hold out none, so that blocks of these logs judge: clock-rate error" in text


def judged_by_noise() -> str:
    """The paragraph of an adequate model whose logs show the noise in its fastest part only."""
    found = diagnosis(Verdict.ADEQUATE)
    quiet = tuple(replace(g, rmse_before=0.0, rmse_after=0.0) for g in found.gains)
    left = replace(found.remainder, noise_from_rest=False)
    return write_summary(replace(found, gains=quiet, remainder=left)).summary


def test_without_a_rest_nothing_to_mend_is_what_the_logs_show() -> None:
    """A slow misfit could hide, so the last word is no more than that."""
    text = judged_by_noise()
    assert "a slow misfit could hide in it" in text
    assert "As far as these logs show, there is nothing to mend." in text


@pytest.mark.parametrize("jumps", [0, 9])
def test_more_that_moments_of_jumps_make_is_noise(jumps: int) -> None:
    """Then nothing is to be recorded; without such jumps more moves would tell what it is."""
    found = diagnosis(Verdict.ADEQUATE)
    left = replace(found.remainder, open_jumps_held_out=jumps)
    louder = tuple(replace(g, rmse_after=2.0 * left.rms) for g in found.gains)
    text = write_summary(replace(found, gains=louder, remainder=left)).summary
    assert ("which is noise, once the moments of 9 jumps" in text) is (jumps == 9)
    assert ("Record more of such moves to tell which." in text) is (jumps == 0)
    assert ("there is nothing to mend" in text.lower()) is (jumps == 9)


def test_a_law_that_is_refused_explains_more_than_chance() -> None:
    """What is held out speaks against it, and that is what is said."""
    refused = Issue(REFUSED, "info", "creep would take away 5 %, but leaves it as it is", None)
    found = replace(diagnosis(Verdict.ADEQUATE), issues=(refused,))
    text = write_summary(found).summary
    assert "None of the effects tried can be claimed." in text
    assert "Creep would take away 5 %, but leaves it as it is." in text
    assert "than chance would." not in text


def test_a_model_that_runs_away_has_no_fit() -> None:
    """An error of eleven times the motion is no misfit to be explained."""
    found = diagnosis(Verdict.UNKNOWN)
    far = tuple(replace(g, rmse_before=2.4, fit_percent_before=-1000.0) for g in found.gains)
    text = write_summary(replace(found, gains=far)).summary
    assert text.startswith("The muscle model runs away on held-out samples, by 138 deg rms:")
    assert "fit -" not in text


def test_a_model_that_moves_where_nothing_does_has_not_run_away() -> None:
    """An error as large as the fitted motion, of 12.5 degrees, on an output that stays still."""
    found = diagnosis(Verdict.UNKNOWN)
    still = tuple(
        replace(g, rmse_before=np.deg2rad(13.0), fit_percent_before=-5000.0) if g.held_out else g
        for g in (
            gain("a", before=2.0, after=0.2, held_out=False),
            gain("b", before=13.0, after=0.2, held_out=True),
        )
    )
    text = write_summary(replace(found, gains=still)).summary
    assert text.startswith("The muscle model misses angle by 13 deg rms on held-out samples. On")


@pytest.mark.parametrize(("held", "carries_over"), [(5.9, True), (6.1, False)])
def test_a_base_that_does_not_carry_over_is_told(held: float, carries_over: bool) -> None:
    """2 degrees on the fitted samples, nearly or just above three times that on the others."""
    gains = (
        gain("a", before=2.0, after=0.2, held_out=False),
        gain("b", before=held, after=0.2, held_out=True),
    )
    found = replace(diagnosis(Verdict.NAMED), gains=gains)
    text = write_summary(found).summary
    assert f"misses angle by {held:.3g} deg rms on held-out samples" in text
    told = "On the fitted ones it is 2 deg: the model does not carry over"
    assert (f"{told}, and what is gained there" in text) != carries_over
    alone = write_summary(replace(found, verdict=Verdict.UNKNOWN, causes=(), descriptive=()))
    assert (f"{told}. " in alone.summary) != carries_over
