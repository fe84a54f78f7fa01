"""The comparison of candidates under one noise model, by hand and on logs in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade_rounds import SAMPLES, UNKNOWNS, candidate
from linear_motion import SIGMA, TRUTH, Bow, linear_log, linear_problem, parabolic, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.whitening import Whitener
from softid.diagnosis.search import bic_ranking
from softid.diagnosis.search.bic_ranking import bic_of, rank
from softid.diagnosis.search.effect_starts import candidate_at
from softid.diagnosis.search.forward_selection import converged
from softid.diagnosis.search.racing import race

NOTHING = np.zeros(0)
WHITE = Whitener({(0, "angle"): NOTHING}, {(0, "angle"): 0.01})


def test_bic_by_hand() -> None:
    """Closed form n ln(S/n) + k ln n with S of the white rows: n = 1000, k = 4 unknowns.

    A noise model of half the size makes S four times larger for all alike.
    """
    problem = linear_problem([linear_log(noise=0.01)])
    base = converged(standing(problem, problem.unknowns(TRUTH)), SIGMA)
    n, k = 1000, problem.size
    for sigma, factor in ((0.01, 1.0), (0.005, 4.0)):
        white = replace(WHITE, sigma={(0, "angle"): sigma})
        (row,) = rank([base], SIGMA, whitener=white)
        wanted = n * np.log(factor * base.squares / n) + k * np.log(n)
        assert row.bic == pytest.approx(wanted, abs=0.01)
        assert row.plain is base


def test_the_noise_model_is_that_of_the_best() -> None:
    """What the worse candidate leaves is no noise: all are whitened by what the best one leaves.

    The base leaves a parabola of 0.05 rad on noise of 0.01; the noise that is used is the latter,
    which is white, while an autoregression to the former nearly adds it up.
    """
    base, scale = parabolic()
    best = race(base, [Bow()], scale, SIGMA)[0]
    first, second = rank([base, best], SIGMA)
    assert first.candidate.keys == ("bow",)
    assert second.candidate.keys == ()
    whitener = first.candidate.whitener
    assert whitener is second.candidate.whitener
    assert whitener is not None
    assert whitener.sigma[0, "angle"] == pytest.approx(0.01, rel=0.1)
    assert float(np.sum(whitener.phi[0, "angle"])) < 0.2


def test_a_term_that_explains_noise_ranks_behind() -> None:
    """Closed form: one more unknown costs ln n = 6.9, and gains χ² of one degree, 10 at most."""
    problem = linear_problem([linear_log(noise=0.01)])
    base = converged(standing(problem, problem.unknowns(TRUTH)), SIGMA)
    bowed = bowed_at(base, 0.001)
    first, second = rank([bowed, base], SIGMA, whitener=WHITE)
    assert first.candidate.keys == ()
    assert np.log(1000.0) - 10.0 < second.bic - first.bic < np.log(1000.0) + 0.01


def test_who_cannot_catch_up_is_only_evaluated(monkeypatch: pytest.MonkeyPatch) -> None:
    """The one that all others extend is brought to its optimum all the same, behind or not."""
    monkeypatch.setattr(bic_ranking, "can_catch_up", lambda *_: False)
    problem = linear_problem([linear_log(noise=0.01)])
    base = standing(problem, problem.unknowns({"M": 0.4, "N": 10.0, "Q": 60.0}))
    bowed = bowed_at(base, 1.0)
    found = {
        row.candidate.keys: row.candidate for row in rank([base, bowed], SIGMA, whitener=WHITE)
    }
    assert found[()].parameters["Q"] == pytest.approx(TRUTH["Q"], rel=0.01)
    assert found["bow",].parameters["bow_c"] == 1.0


def test_the_bic_of_a_perfect_fit_is_finite() -> None:
    """Closed form k ln n for a mean square of one; the logarithm of nothing left is none."""
    log_n = np.log(SAMPLES)
    assert bic_of(candidate((), float(SAMPLES))) == pytest.approx(UNKNOWNS * log_n)
    assert np.isfinite(bic_of(candidate((), 0.0)))


def bowed_at(base: Candidate, size: float) -> Candidate:
    """The base with a parabola of some size."""
    scale = scale_of(base.problem, base.minimum.point)
    return candidate_at(base, Bow(), {"c": size}, scale, SIGMA)[1]
