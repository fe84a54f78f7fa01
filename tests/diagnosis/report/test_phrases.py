"""Small parts of the sentences in which a diagnosis is told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from handmade_diagnosis import cause, diagnosis, estimate, remainder

from softid.diagnosis.report.descriptions import described
from softid.diagnosis.report.phrases import (
    doubt_about,
    doubts_about,
    percent_below,
    percent_range,
    taken_by,
    unsteady,
    values_of,
)
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis.verdict.naming import nameable
from softid.diagnosis_results import Diagnosis, Doubt, Variation, Verdict
from softid.errors import Issue
from softid.sentences import lowered


def told(found: Diagnosis) -> str:
    """The paragraph."""
    return write_summary(found).summary


@pytest.mark.parametrize(
    ("interval", "text"),
    [
        ((0.5, 0.8), "50 to 80 %"),
        ((-1.0, 1.0), "-100 to 100 %"),
        ((-259.2, 1.0), "unknown up to 100 %"),
    ],
)
def test_a_gain_that_may_be_any_loss_has_no_lower_end(
    interval: tuple[float, float], text: str
) -> None:
    assert percent_range(interval) == text


def test_an_interval_beyond_both_bounds_is_not_printed() -> None:
    """It says nothing that the bounds do not say already, and a side beyond one is open."""
    ratio = replace(estimate("valve_flow_b", 0.3, "1"), lower=0.1, upper=0.528)
    open_one = replace(ratio, ci95=(-0.542, 1.14))
    text = values_of([open_one, replace(ratio, ci95=(-0.5, 0.5))])
    assert "b, which is not known within its bounds of 0.1 to 0.528" in text
    assert "b = 0.3 (at most 0.5)" in text


@pytest.mark.parametrize(
    ("value", "text"), [(0.9299, "92.9 %"), (0.926, "92.6 %"), (0.92, "92 %"), (0.934, "93 %")]
)
def test_a_share_below_a_bound_does_not_read_like_it(value: float, text: str) -> None:
    """By hand, with a bound of 93 %."""
    assert percent_below(value, 0.93) == text


@pytest.mark.parametrize(("share", "are_told"), [(0.4, False), (0.6, True)])
def test_doubts_are_told_of_descriptions_that_take_away_half(share: float, are_told: bool) -> None:
    found = diagnosis(Verdict.UNKNOWN)
    doubted = tuple(replace(c, doubt=Doubt.CANCELS) for c in found.descriptive)
    left = replace(found.remainder, explained_share=share)
    text = told(replace(found, descriptive=doubted, remainder=left))
    assert (doubt_about(doubted[0]) in text) is are_told


def test_values_that_only_count_together_are_told_as_such() -> None:
    """The knots of a curve that the base can bend, too: no list of what is not known."""
    knots = [
        replace(estimate(f"static_curve_k{k}", 0.1, "rad"), lower=-0.7, upper=0.7, ci95=(-9.0, 9.0))
        for k in (1, 2, 3, 4)
    ]
    known = estimate("static_curve_k5", 0.2, "rad")
    text = values_of([*knots, known])
    assert text.startswith("k5 = 0.2")
    assert "4 values of which none is known by itself" in text
    assert "not known within its bounds" not in text


@pytest.mark.parametrize(
    ("verdict", "doubt", "differs"),
    [(Verdict.NAMED, None, "may not be"), (Verdict.UNKNOWN, Doubt.VARIES, "is not")],
)
def test_a_size_that_varies_is_told(verdict: Verdict, doubt: Doubt | None, differs: str) -> None:
    """Behind the evidence of a cause, and behind a description, for which it is the reason."""
    found = diagnosis(verdict)
    (first, *_) = found.causes or found.descriptive
    varied = replace(first, variation=Variation("p", 0.12, 0.01, 1e-9), doubt=doubt)
    shown = replace(found, causes=(varied,) if found.causes else (), descriptive=())
    if not found.causes:
        shown = replace(shown, descriptive=(varied,))
    text = told(shown)
    size = "Its size" if found.causes else f"The size of {lowered(first.title)}"
    assert f"{size} varies by about 12 % with the input, so its law {differs} exactly" in text
    assert "so its law" not in told(found)


def test_a_description_is_small_or_not_sure() -> None:
    """Beside a cause of 412 in BIC one of 100 is small; one of 1683 that ends at a bound is not."""
    found = diagnosis(Verdict.NAMED)
    stuck = replace(estimate("pneumatic_lag_ratio", 0.2, "1"), at_bound=True)
    lag = cause("pneumatic_lag", [stuck], before=2.0, after=0.5)
    slight = replace(lag, delta_bic=100.0, holdout_rmse_before=0.0087, holdout_rmse_after=0.0085)
    small = told(replace(found, descriptive=(slight,)))
    assert "a part of the rest, too small to be named as a cause" in small
    much = told(replace(found, descriptive=(replace(lag, delta_bic=100.0),)))
    assert "too small to be named" not in much  # on what is held out it takes more than the cause
    large = told(replace(found, descriptive=(replace(lag, delta_bic=1683.0),)))
    assert "too small" not in large
    assert "a law that is not sure enough for a name" in large
    assert "The ratio of lag of the pneumatics ends at its bound" in large


@pytest.mark.parametrize(
    ("structured", "explained", "held", "why"),
    [
        (
            True,
            0.92,
            0.92,
            "unexplained is named only if it takes away 93 % or more of it",
        ),
        (True, 0.94, 0.78, "not surely enough for a name"),
        (False, 0.8, 0.75, "not surely enough for a name"),
        (True, 0.95, 0.69, "but 69 % on those held out: it does not carry over"),
        (
            True,
            0.5,
            0.45,
            "unexplained is named only if it takes away 93 % or more of it",
        ),
        (True, 0.6, 0.37, "but 37 % on those held out: it does not carry over"),
    ],
)
def test_why_a_description_is_no_cause(
    structured: bool, explained: float, held: float, why: str
) -> None:
    """Stands on the two shares by which names are given: 0.93 fitted and 0.7 held out."""
    left = replace(remainder(structured=structured, explained=explained), held_out_share=held)
    assert taken_by(left).endswith(why)
    link: Any = None
    assert nameable((link,), link, left, gain=0.9) == (why == "not surely enough for a name",)


def test_a_rest_that_is_held_out_is_why_a_description_is_no_cause() -> None:
    """Stands on the share of 0.93 beside something else."""
    left = remainder(structured=False, explained=1.0)
    left = replace(left, held_out_share=0.9, misses_held_out=True)
    assert "100 % of the misfit above the noise on the fitted samples and 90 %" in taken_by(left)
    assert taken_by(left).endswith("is named only if it takes away 93 % or more of it")


@pytest.mark.parametrize("doubt", Doubt)
def test_every_doubt_about_a_description_is_told(doubt: Doubt) -> None:
    """In one sentence each: of the numbers, of a bound, or of a size that varies."""
    rate = replace(estimate("sensor_drift_rate", 0.01, "rad/s"), at_bound=doubt is Doubt.AT_BOUND)
    told = replace(cause("sensor_drift", [rate], before=2.0, after=1.9), doubt=doubt)
    if doubt is Doubt.VARIES:
        told = replace(told, variation=Variation("x", 0.2, 0.1, 1e-9))
    why = doubt_about(told)
    bounded = replace(told, parameters=(replace(rate, at_bound=True),))
    assert doubt_about(bounded).count(".") == 1
    assert "rift of the sensor" in why
    assert why.endswith(".")
    assert doubt_about(cause("sensor_drift", [], before=2.0, after=1.0)) == ""


def test_a_doubt_about_all_descriptions_is_told_once() -> None:
    """Two reasons are two sentences; one description is called by its name."""
    rate = estimate("sensor_drift_rate", 0.01, "rad/s")
    slow = replace(cause("sensor_drift", [rate], before=2.0, after=1.9), doubt=Doubt.TOO_SLOW)
    other = replace(slow, doubt=Doubt.MAY_BE_ZERO)
    both = "Each of them may be slower than these logs can tell."
    assert doubts_about([slow, slow]) == [both]
    assert doubts_about([slow]) == [doubt_about(slow)]
    assert doubts_about([slow, other]) == [doubt_about(slow), doubt_about(other)]
    assert doubts_about([replace(slow, doubt=None)] * 2) == []
    assert doubts_about([]) == []


@pytest.mark.parametrize(("spread", "size"), [(0.004, "a little"), (0.2, "by about 20 %")])
def test_a_variation_of_nothing_is_told_without_a_number(spread: float, size: str) -> None:
    """A share that would round to 0 % says that nothing varies."""
    told = cause("creep", [], before=2.0, after=1.0)
    varied = replace(told, variation=Variation("x", spread, 0.1, 1e-9))
    assert f"varies {size} with the position" in unsteady(varied)


def test_a_description_of_next_to_nothing_is_not_told() -> None:
    """Below a tenth of the misfit no name is worth it, nor is what it is confused with."""
    found = diagnosis(Verdict.UNKNOWN)
    assert found.descriptive
    left = replace(found.remainder, explained_share=0.02, held_out_share=0.02)
    text = told(replace(found, remainder=left))
    assert "No effect takes away more than 2 % of the misfit of the fitted samples." in text
    assert "The best description" not in text


def test_a_disturbance_says_what_to_do_next() -> None:
    """Where nothing describes the misfit; where something does, more data would show it better."""
    line = Issue("spectral-line", "warning", "what is left holds a line", "look for a pump")
    found = replace(diagnosis(Verdict.UNKNOWN), issues=(line,))
    assert "look for a pump" not in told(found)
    assert "Next: look for a pump." in told(replace(found, descriptive=(), extended=None))


@pytest.mark.parametrize(
    ("doubt", "told"),
    [
        (Doubt.GAINS_NOTHING, "too small to be named"),
        (Doubt.DOES_NOT_OCCUR, "hold out a log that has it"),
    ],
)
def test_what_does_not_occur_is_not_called_small(doubt: Doubt, told: str) -> None:
    """Beside a cause that explains most; its size where it occurs is not known to be small."""
    main = replace(cause("creep", [], before=2.0, after=1.0), delta_bic=5000.0)
    beside = replace(cause("sensor_drift", [], before=1.0, after=1.0), delta_bic=50.0, doubt=doubt)
    assert told in described([beside], [main])
