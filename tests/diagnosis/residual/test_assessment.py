"""Whether what a model leaves is more than noise."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from handmade_diagnosis import remainder
from linear_motion import RATE_HZ, TRUTH, linear_log, linear_problem, standing
from noise import coloured

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.residual import assessment
from softid.diagnosis.residual.assessment import assess, excess_of, held_out_share, is_structured
from softid.diagnosis.residual.motion import residual_context
from softid.diagnosis.residual.noise_floor import NoiseFloor
from softid.diagnosis.residual.structure import Structure
from softid.diagnosis_results import Remainder


@pytest.mark.parametrize(
    ("before", "after", "share"),
    [(3.0, 1.0, 1.0), (3.0, 1.2, 1.0), (3.0, 2.0, 1.0 - 3.0 / 8.0), (3.0, 4.0, 0.0)],
)
def test_share_of_the_held_out_misfit(before: float, after: float, share: float) -> None:
    """Closed form: 1 - (after² - noise)/(before² - noise), 1 within half a noise variance."""
    assert held_out_share(before, after, 1.0) == pytest.approx(share)


def test_a_model_that_runs_away_explains_nothing_of_what_is_held_out() -> None:
    """Where nothing is held out all is explained; a simulation that diverges explains nothing."""
    assert held_out_share(3.0, float("nan"), 1.0) == 1.0
    assert held_out_share(3.0, float("inf"), 1.0) == 0.0


def bent(added: float) -> tuple[Candidate, Candidate]:
    """Bases at the truth: one whose log is the truth with noise, one with a sine on it."""
    samples = 4000
    swing = added * np.sin(2.0 * np.pi * np.arange(samples) / (5.0 * RATE_HZ))
    clean = linear_problem([linear_log(noise=0.01, samples=samples)])
    wrong = linear_problem([linear_log(noise=0.01, samples=samples, added=swing)])
    return (
        standing(clean, clean.unknowns(TRUTH)),
        standing(wrong, wrong.unknowns(TRUTH)),
    )


def test_noise_alone_leaves_nothing() -> None:
    """Known truth: white noise of 0.01 rad, whose variance is known to a few hundredths."""
    clean, _ = bent(0.0)
    scale = scale_of(clean.problem, clean.minimum.point)
    left = assess(clean, clean, scale, rng=np.random.default_rng(0))
    assert left.structured is False
    assert left.explained_share == 1.0
    assert left.rms == pytest.approx(0.01, rel=0.05)
    assert abs(left.excess) < 0.15


@pytest.mark.parametrize("lasts", [1, 4])
def test_outliers_are_noise_and_what_lasts_is_none(lasts: int) -> None:
    """Known truth: deviations of 0.06 rad in 2 % of the samples double the power of the noise. By
    closed form single ones add to the second differences as noise does, and four in a row a sixth
    of that."""
    samples, rng = 4000, np.random.default_rng(2)
    added = np.zeros(samples)
    for first in rng.choice(samples // 10 - 1, 80 // lasts, replace=False):
        added[10 * first : 10 * first + lasts] = rng.choice((-0.06, 0.06))
    problem = linear_problem([linear_log(noise=0.01, samples=samples, added=added)])
    model = standing(problem, problem.unknowns(TRUTH))
    scale = scale_of(problem, model.minimum.point)
    left = assess(model, model, scale, rng=np.random.default_rng(0))
    assert left.structured is (lasts > 1)
    assert abs(left.excess) < 0.1 or lasts > 1


def test_a_misfit_of_known_size() -> None:
    """Closed form: a sine of 0.05 rad on noise of 0.01 has an excess of ½·25 = 12.5.

    The cause takes all of it or none of it; the noise's variance is known to 5 %.
    """
    clean, wrong = bent(0.05)
    scale = scale_of(wrong.problem, wrong.minimum.point)
    none, every = (
        assess(wrong, final, scale, rng=np.random.default_rng(0)) for final in (wrong, clean)
    )
    assert none.structured is True
    assert none.explained_share == pytest.approx(0.0, abs=1e-9)
    assert none.excess == pytest.approx(12.5, rel=0.15)
    assert none.excess == excess_of(wrong, scale)
    assert type(none.excess) is float
    assert every.structured is False
    assert every.explained_share > 0.98


@pytest.mark.parametrize(
    ("from_rest", "excess", "structured"),
    [(True, 0.09, False), (True, 0.11, True), (False, -0.5, True)],
)
def test_a_structure_of_known_noise_must_show(
    from_rest: bool, excess: float, structured: bool
) -> None:
    """Where rests tell the variance to 10 %, a structure must make the residual so much larger."""
    found = Structure(0.2, 0.1, {})
    assert is_structured(found, excess, NoiseFloor(1.0, 0.1, from_rest), 1.0) is structured


@pytest.mark.parametrize(
    ("excess", "explained", "structured"),
    [(0.66, 0.81, False), (0.66, 0.79, True), (0.54, 0.79, False), (0.76, 0.81, True)],
)
def test_a_law_that_explains_little_needs_less_to_be_doubted(
    excess: float, explained: float, structured: bool
) -> None:
    """By hand: a variance known to 0.2 allows 0.15 + 3 · 0.2, and 0.15 + 2 · 0.2 of the latter."""
    nothing = Structure(0.0, 0.1, {})
    floor = NoiseFloor(1.0, 0.2, from_rest=True)
    assert is_structured(nothing, excess, floor, explained) is structured


def left_under_slow_noise(slow: float) -> Remainder:
    """The truth under white noise of 0.01 rad and slow noise with a correlation time of 0.5 s."""
    samples = 4000
    added = slow * coloured(np.random.default_rng(1), samples, 0.5, 1.0 / RATE_HZ)
    problem = linear_problem([linear_log(noise=0.01, samples=samples, added=added)])
    model = standing(problem, problem.unknowns(TRUTH))
    scale = scale_of(problem, model.minimum.point)
    return assess(model, model, scale, rng=np.random.default_rng(0))


def test_slow_noise_without_a_rest_is_noise_by_its_marks() -> None:
    """Known truth: five times the power that neighbouring samples show, and all of it noise."""
    left = left_under_slow_noise(0.02)
    assert left.structured is False
    assert left.colour_s == pytest.approx(0.5, rel=0.5)
    assert left.excess == 0.0


def test_a_little_slow_noise_is_not_told_from_a_misfit() -> None:
    """Known truth: a third of the white noise's power is too little to have marks."""
    left = left_under_slow_noise(0.006)
    assert left.structured is True
    assert left.colour_s is None
    assert 0.2 < left.excess < 0.5


@pytest.mark.parametrize(
    ("before", "after", "is_explained"),
    [(0.27, 0.25, False), (0.27, 0.13, True), (2.0, 0.9, True), (2.0, 1.1, False)],
)
def test_moments_of_jumps_explain_what_they_take_most_of(
    before: float, after: float, is_explained: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the rule: one jump takes next to nothing of a misfit that goes on throughout."""
    log = linear_log(noise=0.01)
    problem = linear_problem([log])
    model = standing(problem, problem.unknowns(TRUTH))
    left = remainder(structured=True, explained=0.0)
    looks = iter(
        [
            replace(left, excess=before),
            replace(left, excess=after, structured=False),
        ]
    )
    monkeypatch.setattr(assessment, "_look", lambda *args, **options: next(looks))
    monkeypatch.setattr(
        assessment,
        "with_open_jumps",
        lambda *args: SimpleNamespace(parts=residual_context(model), count=1, scatter=True),
    )
    scale = scale_of(problem, model.minimum.point)
    found = assess(model, model, scale, rng=np.random.default_rng(0))
    assert found.structured is not is_explained
    assert found.open_jumps == int(is_explained)
