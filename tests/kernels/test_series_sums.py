"""Sums of a series in one pass, against numpy's."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.series_sums import (
    CHUNK,
    difference_powers,
    innovation_power,
    joint_powers,
    mean_and_power,
)


@pytest.mark.parametrize("n", [1, 2, 3 * CHUNK + 5])
def test_mean_and_power_are_those_of_numpy(n: int) -> None:
    """Also far from zero, where Σv² − n·m² would have lost twelve digits: to 1e-12."""
    values = 1e6 + np.random.default_rng(n).normal(size=n)
    mean, power = mean_and_power(values)
    assert mean == pytest.approx(values.mean(), rel=1e-14)
    assert power == pytest.approx(n * values.var(), rel=1e-12)


def test_joint_powers_are_those_of_numpy() -> None:
    """n times the covariance matrix, far from zero: to 1e-11."""
    rng = np.random.default_rng(5)
    a = 1e5 + rng.normal(size=1000)
    b = 0.3 * a + rng.normal(size=1000)
    (aa, ab), (_, bb) = 1000.0 * np.cov(a, b, bias=True)
    np.testing.assert_allclose(joint_powers(a, b), (ab, aa, bb), rtol=1e-11)


@pytest.mark.parametrize("n", [1, 3 * CHUNK + 5])
def test_difference_powers_are_those_of_numpy(n: int) -> None:
    """Of two series that lie far apart: to rounding of the squares of that."""
    a, b = np.random.default_rng(n).normal(size=(2, n))
    b += 1e3
    whole, apart = difference_powers(a, b)
    assert whole == pytest.approx(float((a - b) @ (a - b)), rel=1e-12)
    assert apart == pytest.approx(n * float(np.var(a - b)), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("order", [0, 1, 8])
@pytest.mark.parametrize("n", [1, 8, 9, CHUNK + 8, 2 * CHUNK + 9])
def test_innovations_are_what_the_past_does_not_foretell(order: int, n: int) -> None:
    """As one convolution of the whole series has it, to rounding; nothing of a shorter one."""
    rng = np.random.default_rng(7)
    values, phi = rng.normal(size=n), 0.1 * rng.normal(size=order)
    left = np.convolve(values, np.append(1.0, -phi), mode="full")[order:n]
    assert innovation_power(values, phi) == pytest.approx(float(left @ left), rel=1e-12, abs=0.0)
