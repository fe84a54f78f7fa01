"""Profiles against parabolas, linear models and responses that saturate."""

from __future__ import annotations

import numpy as np
import pytest
from noise import ar1

from softid.errors import IdentificationError, UsageError
from softid.uncertainty import ResidualBlock, confidence_interval, profile, sandwich_covariance

LIMIT = 0.01 * 1.96
"""A limit is found to 1 % of the half-width of a parabola."""


def test_a_parabola_gives_the_normal_interval() -> None:
    """Rise (v − 3)²/0.25: limits 3 ± 1.96·0.5, in few refits from a start ten times too small."""
    found = profile(
        lambda v: 7.0 + (v - 3.0) ** 2,
        3.0,
        sd=0.05,
        cost_per_variance=0.25,
        optimum_cost=7.0,
    )
    assert found.ci95 == pytest.approx((3.0 - 0.98, 3.0 + 0.98), abs=LIMIT)
    assert found.evaluations <= 20
    assert list(found.values) == sorted(found.values)
    assert found.better_value is None
    assert not found.unbounded_below


def test_a_linear_model_gives_the_interval_of_the_covariance() -> None:
    """Coloured noise, others refitted by lstsq: v ± t sd of `sandwich_covariance`, to 1 %."""
    t = np.linspace(0.0, 1.0, 600)
    design = np.column_stack((1.0 - np.exp(-t / 0.2), np.ones(600), t))
    y = ar1(np.random.default_rng(1), 600, 0.9)
    estimate, cost = (np.linalg.lstsq(design, y, rcond=None)[k] for k in (0, 1))
    block = ResidualBlock("y", (design,), (y - design @ estimate,))
    errors = sandwich_covariance([block], ["gain", "zero", "drift"])

    def refit(value: float) -> float:
        left = y - value * design[:, 0]
        return float(np.linalg.lstsq(design[:, 1:], left, rcond=None)[1][0])

    found = profile(
        refit,
        float(estimate[0]),
        sd=errors.sd[0],
        cost_per_variance=float(errors.cost_per_variance[0]),
        optimum_cost=float(cost[0]),
        degrees_of_freedom=errors.degrees_of_freedom[0],
    )
    expected = confidence_interval(
        float(estimate[0]), "linear", errors.sd[0], errors.degrees_of_freedom[0]
    )
    half = (expected[1] - expected[0]) / 2.0
    assert found.ci95 == pytest.approx(expected, abs=0.011 * half)


def test_a_cost_that_levels_off_has_no_upper_limit() -> None:
    """S = 9 (e^{−v} − e^{−1})²: rise 9/e² = 1.22 < 3.84 for v → ∞, below it crosses at a root."""
    found = profile(
        lambda v: 9.0 * (np.exp(-v) - np.exp(-1.0)) ** 2,
        1.0,
        sd=1.0,
        cost_per_variance=1.0,
        optimum_cost=0.0,
        lower=-5.0,
    )
    root = -np.log(np.exp(-1.0) + np.sqrt(found.threshold) / 3.0)
    assert found.ci95[0] == pytest.approx(root, abs=0.02)
    assert found.unbounded_above
    assert max(found.values) > 1000.0


def test_a_side_that_ends_at_a_bound_is_unbounded() -> None:
    """At the bound the rise is 1 < 3.84; nothing beyond the bound is tried."""
    found = profile(
        lambda v: (v - 1.0) ** 2,
        1.0,
        sd=1.0,
        cost_per_variance=1.0,
        optimum_cost=0.0,
        lower=0.0,
    )
    assert found.ci95[0] is None
    assert min(found.values) == 0.0
    assert found.ci95[1] == pytest.approx(2.96, abs=LIMIT)


def test_an_optimum_on_its_bound_has_a_limit_on_the_other_side() -> None:
    """M → 0: no lower limit, an upper one, and no refit at the bound itself."""
    found = profile(
        lambda v: (v + 1.0) ** 2 - 1.0,
        0.0,
        sd=1.0,
        cost_per_variance=1.0,
        optimum_cost=0.0,
        lower=0.0,
    )
    assert found.unbounded_below
    assert found.ci95[1] == pytest.approx(np.sqrt(1.0 + found.threshold) - 1.0, abs=0.03)


def test_a_logarithmic_scale_is_searched_by_factors() -> None:
    """Rise (log v)²/0.01: limits e^{± 0.196}; with a flat cost both sides end after a million."""
    found = profile(
        lambda v: np.log(v / 5.0) ** 2,
        5.0,
        sd=0.1,
        cost_per_variance=0.01,
        optimum_cost=0.0,
        scale="log",
        lower=0.0,
    )
    assert found.ci95 == pytest.approx((5.0 * np.exp(-0.196), 5.0 * np.exp(0.196)), rel=0.01)
    flat = profile(
        lambda v: 0.0 * v, 5.0, sd=0.1, cost_per_variance=0.01, optimum_cost=0.0, scale="log"
    )
    assert flat.ci95 == (None, None)
    assert max(flat.values) == pytest.approx(5e6)


def test_a_refit_that_fails_counts_as_outside() -> None:
    """NaN beyond v = 2, where the parabola has risen to 1: the limit is where fits end."""
    found = profile(
        lambda v: (v - 1.0) ** 2 if v < 2.0 else np.nan,
        1.0,
        sd=1.0,
        cost_per_variance=1.0,
        optimum_cost=0.0,
    )
    assert found.ci95[1] == pytest.approx(2.0, abs=0.02)
    assert np.inf in found.cost_rise


def test_a_refit_that_falls_from_the_valley_sets_no_limit() -> None:
    """Rise (log v)²; a refit further than 0.7 from all before falls into a minimum that costs 400.

    Bracketing from the right and from the left both end at such a fall, below the limits e^{± 1.96}
    unless the side is followed on from there.
    """
    found_at = [0.0]

    def refit(v: float) -> float:
        at = float(np.log(v))
        if min(abs(at - other) for other in found_at) > 0.7:
            return 400.0
        found_at.append(at)
        return at**2

    found = profile(refit, 1.0, sd=9.0, cost_per_variance=1.0, optimum_cost=0.0, scale="log")
    assert found.ci95 == pytest.approx((np.exp(-1.96), np.exp(1.96)), rel=0.02)
    assert 400.0 in found.cost_rise


def test_a_jump_that_stays_is_a_limit() -> None:
    """No start near v = 2 finds a fit beyond it: a few steps on are tried, then it is the limit."""
    tried: list[float] = []

    def refit(v: float) -> float:
        tried.append(v)
        return (v - 1.0) ** 2 if v < 2.0 else 400.0

    found = profile(refit, 1.0, sd=1.0, cost_per_variance=1.0, optimum_cost=0.0)
    assert found.ci95[1] == pytest.approx(2.0, abs=0.01)
    assert len(tried) < 35


@pytest.mark.parametrize(("gaps", "edge"), [(6, None), (7, 7), (8, 7)])
def test_a_side_is_followed_beyond_six_jumps(gaps: int, edge: int | None) -> None:
    """A rise of 1 sets no limit, but refits fail in gaps of 5 %, into each of which a step leads.

    The first step is 1.96, and later ones end an eighth, then a quarter beyond the last gap: that
    quarter is 2 % within the next one. Behind six of them the side is open; the edge of the seventh
    is a limit, for no more are passed over.
    """
    edges = 1.9 * 1.225 ** np.arange(gaps)

    def refit(value: float) -> float:
        return np.inf if np.any((edges <= value) & (value <= 1.05 * edges)) else 1.0

    found = profile(refit, 0.0, sd=1.0, cost_per_variance=1.0, optimum_cost=0.0, lower=0.0)
    wanted = None if edge is None else pytest.approx(edges[edge - 1], rel=1e-3)
    assert found.ci95[1] == wanted


def test_a_better_optimum_is_reported() -> None:
    """The least cost is at 2.96, not at the value profiled from."""
    found = profile(
        lambda v: (v - 2.96) ** 2 - 3.8416,
        1.0,
        sd=1.0,
        cost_per_variance=1.0,
        optimum_cost=0.0,
    )
    assert found.better_value == pytest.approx(2.96, abs=0.01)


def test_mistakes_are_named() -> None:
    """Outside the bounds, not positive on a logarithmic scale, and nothing to scale with."""

    def flat(value: float) -> float:
        return 0.0 * value

    options = {"sd": 1.0, "cost_per_variance": 1.0, "optimum_cost": 0.0}
    with pytest.raises(UsageError):
        profile(flat, 3.0, **options, upper=2.0)
    with pytest.raises(UsageError):
        profile(flat, -3.0, **options, scale="log")
    with pytest.raises(IdentificationError):
        profile(flat, 3.0, **(options | {"cost_per_variance": np.nan}))
