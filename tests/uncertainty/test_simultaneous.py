"""Two channels of one recording whose noise is partly the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from noise import ar1

from softid.uncertainty import ResidualBlock, sandwich_covariance

N = 1500
NAMES = ("zero", "sine", "step")


def design() -> np.ndarray:
    t = np.linspace(0.0, 1.0, N)
    return np.column_stack((np.ones(N), np.sin(10.0 * np.pi * t), 1.0 - np.exp(-t / 0.1)))


def slow(rng: np.random.Generator) -> np.ndarray:
    return ar1(rng, N, 0.9)


def blocks_of(noises: list[np.ndarray], recordings: list[int | None]) -> list[ResidualBlock]:
    """Both channels show the same response; residuals of their common least-squares fit."""
    x = design()
    both = np.vstack([x] * len(noises))
    estimate = np.linalg.lstsq(both, np.concatenate(noises), rcond=None)[0]
    return [
        ResidualBlock(f"channel {k}", (x,), (e - x @ estimate,), recording=recording)
        for k, (e, recording) in enumerate(zip(noises, recordings, strict=True))
    ]


def sd(blocks: list[ResidualBlock]) -> np.ndarray:
    return np.array(sandwich_covariance(blocks, NAMES).sd, float)


def test_the_same_noise_twice_tells_no_more_than_once() -> None:
    """Two copies of a channel: the error is that of one. Without a recording they pass for two
    measurements and the error is 1/√2 of it.
    """
    e = slow(np.random.default_rng(1))
    once = sd(blocks_of([e], [0]))
    assert sd(blocks_of([e, e], [0, 0])) == pytest.approx(once, rel=0.02)
    for apart in ([None, None], [0, 1]):
        assert sd(blocks_of([e, e], apart)) == pytest.approx(once / np.sqrt(2.0), rel=0.02)


def test_opposite_noise_cancels() -> None:
    """The mean of u + e and u − e is u: variance u² in place of (u² + e²)/2, so with u = e/2 the
    errors are √0.4 = 0.632 of those of channels that err apart.

    One draw scatters by a fifth, so the mean of 100 by 2 %, and lies 4 % above, since the widest of
    several time scales counts.
    """
    rng = np.random.default_rng(2)
    ratios = []
    for _ in range(100):
        e, u = slow(rng), 0.5 * slow(rng)
        noises = [u + e, u - e]
        ratios.append(sd(blocks_of(noises, [0, 0])) / sd(blocks_of(noises, [None, None])))
    ratio = np.mean(ratios, axis=0) / np.sqrt(0.4)
    assert np.all((ratio > 0.98) & (ratio < 1.10)), ratio


def test_what_cancels_altogether_is_not_believed() -> None:
    """u = e/100: no estimate of the noise is good to 1e-4 of its variance, so the errors stay those
    of channels that err apart and do not vanish.
    """
    rng = np.random.default_rng(2)
    e, u = slow(rng), 0.01 * slow(rng)
    noises = [u + e, u - e]
    found = sd(blocks_of(noises, [0, 0]))
    assert np.all(found > 0.5 * sd(blocks_of(noises, [None, None])))


def test_stated_errors_are_the_true_spread() -> None:
    """Common and own noise of one size, own noise white in one channel and slow in the other: 200
    draws, whose spread is itself known to 5 %. The widest of several time scales counts, so that
    slow noise gives errors up to a fifth too large; taken apart, the channels' are a fifth too
    small where the response is quick.
    """
    rng = np.random.default_rng(3)
    x = np.vstack([design()] * 2)
    found, stated, apart = [], [], []
    for k in range(200):
        common = slow(rng)
        noises = [common + rng.normal(size=N), common + slow(rng)]
        found.append(np.linalg.lstsq(x, np.concatenate(noises), rcond=None)[0])
        if k % 10 == 0:
            stated.append(sd(blocks_of(noises, [0, 0])))
            apart.append(sd(blocks_of(noises, [None, None])))
    spread = np.std(found, axis=0)
    ratio = np.mean(stated, axis=0) / spread
    assert np.all((ratio > 0.95) & (ratio < 1.3)), ratio
    assert np.mean(apart, axis=0)[1] / spread[1] < 0.85


def test_independent_channels_keep_their_errors() -> None:
    """Chance alone adds and takes as much: over 40 draws the mean changes by less than 5 %."""
    rng = np.random.default_rng(4)
    ratios = []
    for _ in range(40):
        blocks = blocks_of([slow(rng), slow(rng)], [0, 0])
        ratios.append(sd(blocks) / sd([replace(b, recording=None) for b in blocks]))
    assert np.mean(ratios, axis=0) == pytest.approx(1.0, abs=0.05)


def test_samples_of_one_channel_only_say_nothing_of_what_is_shared() -> None:
    """Channels that are never used at the same sample err apart."""
    rng = np.random.default_rng(5)
    blocks = blocks_of([slow(rng), slow(rng)], [0, 0])
    even = np.arange(N) % 2 == 0
    parts = [
        replace(b, residuals=(np.where(even == (k == 0), b.residuals[0], np.nan),))
        for k, b in enumerate(blocks)
    ]
    alone = [replace(b, recording=None) for b in parts]
    finest = sandwich_covariance(parts, NAMES).noise
    assert finest == sandwich_covariance(alone, NAMES).noise
    assert np.all(np.isfinite(sd(parts)))
