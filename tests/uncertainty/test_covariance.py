"""Covariance of least squares under coloured noise: exact algebra, Monte Carlo, and its edges."""

from __future__ import annotations

import numpy as np
import pytest
from noise import ar1
from scipy.linalg import toeplitz

from softid.errors import IdentificationError, UsageError
from softid.uncertainty import (
    Covariance,
    ResidualBlock,
    confidence_interval,
    sandwich_covariance,
    standard_error,
    to_linear,
)


def step_regressors(n: int) -> np.ndarray:
    t = np.linspace(0.0, 1.0, n)
    return np.column_stack((np.ones(n), np.sin(10 * np.pi * t), 1.0 - np.exp(-t / 0.1)))


def fitted(design: np.ndarray, y: np.ndarray) -> ResidualBlock:
    residual = y - design @ np.linalg.lstsq(design, y, rcond=None)[0]
    return ResidualBlock("angle", (design,), (residual,))


def test_standard_errors_are_those_of_ordinary_least_squares_under_ar1() -> None:
    """Exact: H⁻¹ Jᵀ Ω J H⁻¹, dense, ρ = 0.8, n = 1500; and 2000 simulated fits agree with it.

    The median over 30 records lies within 10 % (single records scatter by 10 %; the widest of three
    time scales is taken, which adds some 5 %).
    """
    n, rho = 1500, 0.8
    design = step_regressors(n)
    project = np.linalg.pinv(design)
    exact = np.sqrt(np.diag(project @ toeplitz(rho ** np.arange(n)) @ project.T))
    rng = np.random.default_rng(1)
    simulated = np.std([project @ ar1(rng, n, rho) for _ in range(2000)], axis=0)
    np.testing.assert_allclose(simulated, exact, rtol=0.05)
    found = [
        sandwich_covariance([fitted(design, ar1(rng, n, rho))], ["a", "b", "c"]).sd
        for _ in range(30)
    ]
    np.testing.assert_allclose(np.median(found, axis=0), exact, rtol=0.10)


def test_white_noise_gives_the_textbook_errors() -> None:
    """σ² H⁻¹ and no inflation, n = 4000: 10 % for the scatter of the noise model.

    The coarsest time scale averages over 64 samples and so has 62 − 3 degrees of freedom or more.
    """
    design = step_regressors(4000)
    block = fitted(design, np.random.default_rng(2).normal(size=4000))
    found = sandwich_covariance([block], ["a", "b", "c"])
    expected = np.sqrt(np.diag(np.linalg.inv(design.T @ design)))
    np.testing.assert_allclose(np.array(found.sd), expected, rtol=0.1)
    np.testing.assert_allclose(found.inflation, 1.0, rtol=0.2)
    assert min(found.degrees_of_freedom) > 50.0


def test_slow_noise_lowers_the_degrees_of_freedom() -> None:
    """ρ = 0.99 and n = 2000 are twenty correlation times: fewer than 40 degrees of freedom."""
    block = fitted(step_regressors(2000), ar1(np.random.default_rng(3), 2000, 0.99))
    found = sandwich_covariance([block], ["a", "b", "c"])
    assert found.degrees_of_freedom[0] < 40.0
    assert found.inflation[0] > 20.0


def test_units_of_a_parameter_do_not_matter() -> None:
    """A column in units a million times smaller: standard error a million times larger, to 1e-9."""
    design = step_regressors(600)
    y = ar1(np.random.default_rng(4), 600, 0.7)
    first = sandwich_covariance([fitted(design, y)], ["a", "b", "c"])
    other = sandwich_covariance([fitted(design * [1.0, 1e-6, 1.0], y)], ["a", "b", "c"])
    ratio = np.array(other.sd) / np.array(first.sd)
    np.testing.assert_allclose(ratio, [1.0, 1e6, 1.0], rtol=1e-6)


@pytest.mark.parametrize("size", [1e-100, 1e-80, 1e80, 1e100])
def test_a_parameter_of_any_size_has_the_same_degrees_of_freedom(size: float) -> None:
    """sd ∝ 1/size, and ν is that of size 1, though a variance squared is beyond every number."""
    design, residual = step_regressors(200), np.random.default_rng(1).normal(size=200)
    names = ["a", "b", "c"]
    usual = sandwich_covariance([ResidualBlock("angle", (design,), (residual,))], names)
    with np.errstate(all="raise", under="ignore"):
        block = ResidualBlock("angle", (size * design,), (residual,))
        found = sandwich_covariance([block], names)
    np.testing.assert_allclose(found.degrees_of_freedom, usual.degrees_of_freedom, rtol=1e-6)
    np.testing.assert_allclose(size * np.array(found.sd), usual.sd, rtol=1e-9)


def test_channels_in_other_units_are_one_problem() -> None:
    """Two channels, the second in thousandths with weight 1/1000: the errors of one unit."""
    design = step_regressors(800)
    y = ar1(np.random.default_rng(5), 800, 0.6)
    whole = fitted(design, y)
    left = whole.residuals[0]
    plain = [
        ResidualBlock("angle", (design[:400],), (left[:400],)),
        ResidualBlock("force", (design[400:],), (left[400:],)),
    ]
    scaled = [
        plain[0],
        ResidualBlock("force", (1e3 * design[400:],), (1e3 * left[400:],), 1e-3),
    ]
    a, b = (sandwich_covariance(blocks, ["a", "b", "c"]) for blocks in (plain, scaled))
    np.testing.assert_allclose(b.matrix, a.matrix, rtol=1e-6)
    assert [ar.sigma for ar in b.noise] == pytest.approx([a.noise[0].sigma, 1e3 * a.noise[1].sigma])


def test_what_cannot_be_seen_is_said_and_spares_the_others() -> None:
    """Two equal columns and a zero one get None; the others keep their errors."""
    design = step_regressors(500)
    y = ar1(np.random.default_rng(6), 500, 0.5)
    wide = np.column_stack((design, design[:, 1], np.zeros(500)))
    residual = fitted(design, y).residuals
    found = sandwich_covariance([ResidualBlock("y", (wide,), residual)], list("abcde"))
    alone = sandwich_covariance([ResidualBlock("y", (design,), residual)], list("abc"))
    assert sorted(found.undetermined) == [("b", "d"), ("e",)]
    assert [s is None for s in found.sd] == [False, True, False, True, True]
    assert found.sd[0] == pytest.approx(alone.sd[0], rel=1e-6)
    assert np.isnan(found.matrix[1]).all()
    assert np.isnan(found.matrix[:, 4]).all()
    assert found.condition_number == np.inf


def test_gaps_cost_only_their_samples() -> None:
    """Every tenth block of ten samples masked: errors grow by √(1/0.9) = 1.05, here within 15 %."""
    design = step_regressors(3000)
    y = ar1(np.random.default_rng(7), 3000, 0.5)
    whole = fitted(design, y)
    masked = np.where(np.arange(3000) // 10 % 10 == 0, np.nan, whole.residuals[0])
    a = sandwich_covariance([whole], list("abc"))
    b = sandwich_covariance([ResidualBlock("y", (design,), (masked,))], list("abc"))
    np.testing.assert_allclose(np.array(b.sd) / np.array(a.sd), 1.05, rtol=0.15)


def test_cost_per_variance_is_the_white_variance_times_the_inflation() -> None:
    """C/(H⁻¹) = inflation · σ², with σ² = Σ r²/(n − k)."""
    block = fitted(step_regressors(500), ar1(np.random.default_rng(8), 500, 0.8))
    found = sandwich_covariance([block], list("abc"))
    power = float(np.sum(block.residuals[0] ** 2)) / 497
    np.testing.assert_allclose(found.cost_per_variance, found.inflation * power, rtol=1e-9)


@pytest.mark.parametrize("kind", ["zero", "tiny", "smooth", "walk"])
def test_residuals_that_are_no_noise_give_finite_errors(kind: str) -> None:
    """Noise-free misfit and worse: standard errors are finite, below a hundred residuals."""
    t = np.linspace(0.0, 1.0, 1000)
    rng = np.random.default_rng(9)
    y = {
        "zero": np.zeros(1000),
        "tiny": 1e-17 * rng.normal(size=1000),
        "smooth": np.exp(-t / 0.3) * np.sin(9.0 * t),
        "walk": np.cumsum(rng.normal(size=1000)),
    }[kind]
    block = fitted(step_regressors(1000), y)
    found = sandwich_covariance([block], list("abc"))
    rms = np.sqrt(np.mean(block.residuals[0] ** 2))
    assert max(found.sd) <= 100.0 * rms
    assert min(found.degrees_of_freedom) >= 2.0


def test_errors_and_intervals_on_both_scales() -> None:
    """Closed forms v ± t s and v exp(± t s); t = 2.5706 at five degrees of freedom."""
    assert standard_error(-3.0, "linear", 0.5) == 0.5
    assert standard_error(3.0, "log", 0.5) == 1.5
    assert standard_error(3.0, "log", None) is None
    low, high = confidence_interval(3.0, "linear", 0.1, 5.0)
    assert (low, high) == pytest.approx((3.0 - 0.25706, 3.0 + 0.25706), abs=1e-5)
    low, high = confidence_interval(3.0, "log", 0.1, 5.0)
    assert (low, high) == pytest.approx((3.0 * np.exp(-0.25706), 3.0 * np.exp(0.25706)), abs=1e-4)
    assert confidence_interval(3.0, "log", None, None) is None
    assert confidence_interval(3.0, "log", 1e5, 10.0) is None


def test_linear_covariance_multiplies_by_the_value_on_a_log_scale() -> None:
    """∂v/∂log v = v: entries times v_i v_j where logarithmic."""
    matrix = np.array([[0.04, 0.01], [0.01, 0.09]])
    blank = np.ones(2)
    known = Covariance(("a", "b"), matrix, (0.2, 0.3), (9.0, 9.0), blank, blank, 1.0, (), ())
    expected = [[4.0 * 25.0 * 0.01, 0.05], [0.05, 0.09]]
    np.testing.assert_allclose(to_linear(known, [5.0, 7.0], ["log", "linear"])[0, 1], 0.05)
    np.testing.assert_allclose(to_linear(known, [5.0, 7.0], ["log", "linear"]), expected)


def test_mistakes_are_named() -> None:
    """Names that do not fit the columns, and more parameters than residuals."""
    block = ResidualBlock("y", (np.ones((5, 2)),), (np.arange(5.0),))
    with pytest.raises(UsageError, match="do not match"):
        sandwich_covariance([block], ["a"])
    with pytest.raises(UsageError, match="do not match"):
        sandwich_covariance([], ["a"])
    few = ResidualBlock("y", (np.eye(3),), (np.ones(3),))
    with pytest.raises(IdentificationError, match="3 residuals for 3"):
        sandwich_covariance([few], list("abc"))
