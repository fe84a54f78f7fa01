"""What is left, in words: noise, a line, or more than either."""

from __future__ import annotations

from dataclasses import replace

import pytest
from handmade_diagnosis import diagnosis, remainder

from softid.diagnosis.report.rest_phrases import PREDICTORS, UNLIKE_NOISE, structure_of_rest
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis.residual.disturbances import SPECTRAL_LINE
from softid.diagnosis_results import Diagnosis, NotNoise, Verdict
from softid.errors import Issue


def told(found: Diagnosis) -> str:
    """The paragraph."""
    return write_summary(found).summary


@pytest.mark.parametrize(
    ("excess", "from_rest", "words"),
    [
        (0.04, True, "rms, looks like noise."),
        (0.17, True, "looks like noise, though its power is 17 % above that of the noise of the "),
        (0.17, False, "is 17 % above that of noise in its fastest part."),
    ],
)
def test_noise_is_called_so_with_its_excess(excess: float, from_rest: bool, words: str) -> None:
    """A rest that is a little larger than the noise is not called noise without a word."""
    found = diagnosis(Verdict.NAMED)
    left = replace(found.remainder, excess=excess, noise_from_rest=from_rest, structured=False)
    assert words in told(replace(found, remainder=left))


@pytest.mark.parametrize("mark", NotNoise)
def test_what_speaks_against_slow_noise_is_told(mark: NotNoise) -> None:
    """Where nothing does, slow noise stays among what it may be."""
    found = diagnosis(Verdict.UNKNOWN)
    left = replace(
        found.remainder, structured=True, structure_share=0.0, noise_from_rest=False, by={}
    )
    assert "a disturbance or slow noise" in told(replace(found, remainder=left))
    nothing = replace(found, remainder=replace(left, explained_share=0.0), descriptive=())
    assert "Something is missing, or the noise is slow, and none" in told(nothing)
    text = told(replace(found, remainder=replace(left, against_noise=mark)))
    assert "a disturbance or slow noise" not in text
    assert f"rather than slow noise, for {UNLIKE_NOISE[mark]}" in text
    assert "the noise is slow" not in text


@pytest.mark.parametrize(("structured", "said"), [(False, True), (True, False)])
def test_a_hold_out_that_is_missed_may_lie_in_the_parameters(structured: bool, said: bool) -> None:
    """Where the fitted logs leave noise, and what is held out more than that."""
    found = diagnosis(Verdict.UNKNOWN)
    left = replace(found.remainder, structured=structured, misses_held_out=True)
    text = told(replace(found, remainder=left))
    assert ("or parameters are off that the fitted logs hardly tell" in text) is said


def test_structure_that_chance_would_make_of_slow_noise_is_told() -> None:
    """A third of the rest follows from the motion, where shifted residuals reach two fifths."""
    found = diagnosis(Verdict.UNKNOWN)
    left = replace(found.remainder, structured=True, structure_share=0.33, structure_limit=0.41)
    text = told(replace(found, remainder=left))
    assert (
        f"33 % of it follows from {PREDICTORS}, no more than chance would make of slow noise"
        in text
    )
    assert "follows from no variable" not in text


@pytest.mark.parametrize("verdict", [Verdict.ADEQUATE, Verdict.PARTIAL, Verdict.UNKNOWN])
def test_a_rest_with_a_line_is_no_slow_noise(verdict: Verdict) -> None:
    """A line has no correlation time and is not normal; without one the marks are told."""
    found = diagnosis(verdict)
    left = replace(found.remainder, colour_s=0.058, structured=False, noise_from_rest=False)
    found = replace(found, remainder=left, issues=(), alternatives=())
    assert "the marks of slow noise with a correlation time of 0.058 s" in told(found)
    line = Issue(SPECTRAL_LINE, "warning", "what is left holds a steady line at 50 Hz")
    text = told(replace(found, issues=(line,)))
    assert "slow noise" not in text
    assert "and a steady line is in it; it is no larger where the motion is quick" in text
    assert "What is left holds a steady line at 50 Hz." in text


def test_noise_with_a_line_is_noise_but_for_the_line() -> None:
    """Of an adequate model nothing else is left."""
    found = diagnosis(Verdict.ADEQUATE)
    left = replace(found.remainder, structured=False, structure_share=0.0, noise_from_rest=False)
    line = Issue(SPECTRAL_LINE, "warning", "what is left holds a steady line at 50 Hz")
    text = told(replace(found, remainder=left, issues=(line,)))
    assert "looks like noise but for a steady line: no more of it follows" in text


def test_a_share_that_rounds_to_nothing_is_less_than_one() -> None:
    """Not "0 %, where chance reaches 0 %"."""
    left = replace(remainder(structured=False, explained=1.0), structure_limit=0.001)
    told = structure_of_rest(replace(left, structure_share=0.004))
    assert told.startswith("less than 1 % of its power follows from")
    assert structure_of_rest(replace(left, structure_share=0.0)).startswith("no more of it")
