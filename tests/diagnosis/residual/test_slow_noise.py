"""Slow wander in what a model leaves, and the noise and the misfit that are none."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from noise import coloured

from softid.diagnosis.residual.disturbances import CODES, disturbance_issues
from softid.diagnosis.residual.slow_noise import (
    SlowNoise,
    chance_of_positive,
    covariance_of_means,
    slow_noise_in,
    slow_noise_issues,
)
from softid.diagnosis.residual.structure import ResidualContext

Array = npt.NDArray[np.float64]

MOTION_S, PERIOD_S = 0.2, 0.05
DRAWS = 100
MOST_FALSE = 3
"""At a rate of 1 in 100 more than three of 100 draws come once in fifty times; noise that is faster
than the limit does far less."""


def times(length_s: float) -> Array:
    return PERIOD_S * np.arange(round(length_s / PERIOD_S))


def with_rest(rest_s: float) -> Array:
    """A chirp of 40 s and a rest."""
    time_s = times(40.0 + rest_s)
    chirp = 50.0 + 50.0 * np.sin(2.0 * np.pi * (0.05 + 0.01 * time_s) * time_s)
    return np.where(time_s < 40.0, chirp, 50.0)


def with_cycles(count: int) -> Array:
    return 50.0 - 50.0 * np.cos(2.0 * np.pi * times(2.0 * count) / 2.0)


def found_in(residual: Array, u: Array) -> SlowNoise | None:
    """With a misfit of twice the noise, which follows from the input, on top."""
    time_s = PERIOD_S * np.arange(u.size)
    misfit = 2.0 * ((u - 50.0) / 50.0) ** 3
    return slow_noise_in(
        [ResidualContext(time_s, u, np.gradient(u, time_s), u, residual + misfit)], MOTION_S
    )


INPUTS = {"rest": with_rest(120.0), "cycles": with_cycles(60)}


@pytest.mark.parametrize("colour", [0.0, 0.9])
@pytest.mark.parametrize("kind", INPUTS)
def test_noise_does_not_wander(kind: str, colour: float) -> None:
    """White noise, and noise that is coloured by 90 % with 1 s: one in a hundred at most."""
    u = INPUTS[kind]
    taken = 0
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        noise = (1.0 - colour) ** 0.5 * rng.standard_normal(u.size)
        noise += colour**0.5 * coloured(rng, u.size, 1.0, PERIOD_S)
        noise[500:520] = np.nan
        taken += found_in(noise, u) is not None
    assert taken <= 1


def test_noise_at_the_limit_comes_as_often_as_stated() -> None:
    """A correlation time of 2 s, which is the null itself: one in a hundred draws."""
    u = INPUTS["rest"]
    noise = (coloured(np.random.default_rng(seed), u.size, 2.0, PERIOD_S) for seed in range(DRAWS))
    assert sum(found_in(row, u) is not None for row in noise) <= MOST_FALSE


@pytest.mark.parametrize(
    ("u", "at_rest"), [(with_rest(300.0), True), (with_cycles(150), False)], ids=["rest", "cycles"]
)
def test_a_wander_is_found_and_measured(u: Array, at_rest: bool) -> None:
    """Twice as large as white noise, with 20 s: nine in ten of 20 draws are found in 300 s.

    A run of 15 correlation times knows the size of a wander to a fifth or so, one draw; the median
    of them to a tenth, and its mean over the run takes another twentieth off: 20 % are allowed.
    """
    drawn = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        drawn.append(
            found_in(rng.standard_normal(u.size) + 2.0 * coloured(rng, u.size, 20.0, PERIOD_S), u)
        )
    found = [wander for wander in drawn if wander is not None]
    assert len(found) >= 18
    assert all(wander.at_rest == at_rest for wander in found)
    assert float(np.median([wander.rms for wander in found])) == pytest.approx(2.0, rel=0.2)
    assert all(wander.time_s >= 6.0 for wander in found)


@pytest.mark.parametrize("time_s", [3.0, 7.0, 12.0, 30.0, 100.0])
def test_a_relaxation_is_no_wander(time_s: float) -> None:
    """Ten times the noise after the motion, as creep and warm-up leave it, with a slope besides."""
    u = with_rest(120.0)
    after_s = np.maximum(PERIOD_S * np.arange(u.size) - 40.0, 0.0)
    relaxing = 10.0 * np.exp(-after_s / time_s) - 0.05 * after_s
    relaxing = np.where(after_s > 0.0, relaxing - relaxing[after_s > 0.0].mean(), 0.0)
    for seed in range(5):
        assert found_in(np.random.default_rng(seed).standard_normal(u.size) + relaxing, u) is None


def test_what_comes_with_the_motion_is_no_wander() -> None:
    """A wander of ten times the noise that stops where the input rests; and one that neither a rest
    nor equal cycles show."""
    u = with_rest(120.0)
    rng = np.random.default_rng(0)
    slow = 10.0 * coloured(rng, u.size, 20.0, PERIOD_S) + rng.standard_normal(u.size)
    noise = rng.standard_normal(u.size)
    moving = PERIOD_S * np.arange(u.size) < 40.0
    assert found_in(np.where(moving, slow, noise), u) is None
    assert found_in(slow[:800], u[:800]) is None


def test_an_input_that_wanders_brings_its_own() -> None:
    """An input that moves by 1 % of its range while it rests, which the residual follows."""
    u = INPUTS["rest"]
    rng = np.random.default_rng(1)
    slow = np.where(PERIOD_S * np.arange(u.size) < 40.0, 0.0, coloured(rng, u.size, 20.0, PERIOD_S))
    noise = 0.2 * rng.standard_normal(u.size)
    time_s = PERIOD_S * np.arange(u.size)
    for moves, is_told in ((0.0, True), (0.5, False)):
        part = ResidualContext(time_s, u, u, u + moves * slow, noise + slow)
        assert (slow_noise_in([part], MOTION_S) is not None) == is_told


def test_an_excursion_is_told_with_its_place() -> None:
    """A bump of 20 s about 100 s, and nothing else: its middle, and words in the unit of people."""
    u = INPUTS["rest"]
    time_s = PERIOD_S * np.arange(u.size)
    bump = 0.05 * np.exp(-(((time_s - 100.0) / 10.0) ** 2))
    noise = 0.005 * np.random.default_rng(2).standard_normal(u.size)
    part = ResidualContext(time_s, u, np.gradient(u, time_s), u, noise + bump)
    (told,) = slow_noise_issues([part], MOTION_S, channel="angle", unit="deg", factor=100.0)
    assert told.code == "slow-wander"
    assert told.code in CODES
    assert "also while the input rests" in told.message
    assert "deg rms" in told.message
    place_s = float(told.message.split("near ")[1].removesuffix(" s"))
    assert place_s == pytest.approx(100.0, abs=3.0)
    found = disturbance_issues([part], MOTION_S, None, channel="angle", unit="deg", factor=100.0)
    assert told in found


def test_covariance_of_block_means() -> None:
    """Stands on a double sum over 400 points a block, good for (h/τ)²/6 = 4e-6 and below 1e-4."""
    begins_s, ends_s = np.array([0.0, 2.0, 7.0]), np.array([2.0, 5.0, 8.0])
    points = [
        b + (e - b) * (np.arange(400) + 0.5) / 400 for b, e in zip(begins_s, ends_s, strict=True)
    ]
    expected = [
        [np.exp(-np.abs(one[:, None] - other) / 3.0).mean() for other in points] for one in points
    ]
    np.testing.assert_allclose(covariance_of_means(begins_s, ends_s, 3.0), expected, rtol=1e-4)


def test_chance_of_a_sum_of_squares() -> None:
    """Closed form: Σ of two squares each is exponential, so that w₁E₁ − w₂E₂ > 0 has the chance
    w₁/(w₁ + w₂); and all of one sign."""
    for one, other in ((1.0, 1.0), (3.0, 1.0), (0.01, 1.0)):
        weights = np.array([one, one, -other, -other])
        assert chance_of_positive(weights) == pytest.approx(one / (one + other), abs=1e-5)
    assert chance_of_positive(np.array([1.0, 2.0, 3.0])) == pytest.approx(1.0, abs=1e-4)
    assert chance_of_positive(-np.array([1.0, 2.0, 3.0])) == pytest.approx(0.0, abs=1e-4)
