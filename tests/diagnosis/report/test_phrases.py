"""Small parts of the sentences in which a diagnosis is told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from handmade_diagnosis import cause, diagnosis, estimate, remainder

from softid.diagnoses import Diagnosis, Variation, Verdict
from softid.diagnosis.report.phrases import taken_by, values_of
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis.verdict.naming import nameable


def told(found: Diagnosis) -> str:
    """The paragraph."""
    return write_summary(found).summary


def test_an_interval_beyond_both_bounds_is_not_printed() -> None:
    """It says nothing that the bounds do not say already."""
    ratio = replace(estimate("valve_flow_b", 0.3, "1"), lower=0.1, upper=0.528)
    open_one = replace(ratio, ci95=(-0.542, 1.14))
    text = values_of([open_one, replace(ratio, ci95=(-0.5, 0.5))])
    assert "b, which is not known within its bounds of 0.1 to 0.528" in text
    assert "b = 0.3 [0.1, 0.5]" in text


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


@pytest.mark.parametrize("verdict", [Verdict.NAMED, Verdict.UNKNOWN])
def test_a_size_that_varies_is_told(verdict: Verdict) -> None:
    """Behind the evidence of a cause, and behind a description, for which it is the reason."""
    found = diagnosis(verdict)
    (first, *_) = found.causes or found.descriptive
    varied = replace(first, variation=Variation("p", 0.12, 0.01, 1e-9))
    shown = replace(found, causes=(varied,) if found.causes else (), descriptive=())
    if not found.causes:
        shown = replace(shown, descriptive=(varied,))
    text = told(shown)
    assert f"The size of {first.title[:1].lower()}{first.title[1:]} is not the same" in text
    assert "it varies by about 12 % with the input" in text
    assert "not the same throughout" not in told(found)


def test_a_description_is_small_or_not_sure() -> None:
    """Beside a cause of 412 in BIC one of 100 is small; one of 1683 that ends at a bound is not."""
    found = diagnosis(Verdict.NAMED)
    stuck = replace(estimate("pneumatic_lag_ratio", 0.2, "1"), at_bound=True)
    lag = cause("pneumatic_lag", [stuck], before=2.0, after=0.5)
    small = told(replace(found, descriptive=(replace(lag, delta_bic=100.0),)))
    assert "a part of the rest, too small to be named as a cause" in small
    large = told(replace(found, descriptive=(replace(lag, delta_bic=1683.0),)))
    assert "too small" not in large
    assert "a law that is not sure enough for a name" in large
    assert "The ratio of lag of the pneumatics ends at its bound" in large


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


def test_structure_that_chance_would_make_of_slow_noise_is_told() -> None:
    """A third of the rest follows from the motion, where shifted residuals reach two fifths."""
    found = diagnosis(Verdict.UNKNOWN)
    left = replace(found.remainder, structured=True, structure_share=0.33, structure_limit=0.41)
    text = told(replace(found, remainder=left))
    assert "33 % of it follows from the motion, but so much of slow noise would by chance" in text
    assert "follows from no variable" not in text


@pytest.mark.parametrize(
    ("structured", "explained", "held", "why"),
    [
        (True, 0.92, 0.92, "too little for a cause"),
        (True, 0.94, 0.78, "not surely enough for a name"),
        (False, 0.8, 0.75, "not surely enough for a name"),
        (True, 0.95, 0.69, "but 69 % on those held out: it does not carry over"),
        (True, 0.5, 0.45, "too little for a cause"),
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
