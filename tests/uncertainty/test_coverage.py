"""Nominal 95 % intervals cover about 95 % whatever the colour of the noise."""

from __future__ import annotations

import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

SCRIPT = Path(__file__).resolve().parents[1] / "benchmarks" / "coverage_of_intervals.py"


@pytest.fixture(scope="module")
def script() -> dict[str, Any]:
    """The benchmark's functions: the table in the docstring and these tests are one measurement."""
    return runpy.run_path(str(SCRIPT))


@pytest.mark.parametrize("noise", ["white", "AR(1) 0.9", "50 % AR 0.99 + 50 % white"])
def test_coverage_of_few_draws(script: dict[str, Any], noise: str) -> None:
    """60 draws of four regressors: mean at least 90 %, four standard deviations below 95.

    The textbook covariance covers 35 % of coloured noise, so that the test would see it.
    """
    found = script["coverage"](script["NOISES"][noise], draws=60, n=1000, seed=3)
    assert found["softid"].mean() >= 90.0
    if noise != "white":
        assert found["white"].mean() < 60.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("noise", "least"),
    [
        ("white", 93.0),
        ("AR(1) 0.9", 93.0),
        ("AR(1) 0.99", 93.0),
        ("90 % AR 0.9 + 10 % white", 93.0),
        ("90 % AR 0.99 + 10 % white", 92.0),
        ("50 % AR 0.99 + 50 % white", 92.0),
        ("10 % AR 0.99 + 90 % white", 88.0),
        ("AR(1) 0.999", 92.0),
        ("AR(2) ringing", 93.0),
    ],
)
def test_coverage_of_many_draws(script: dict[str, Any], noise: str, least: float) -> None:
    """The docstring's table: 300 draws, one standard error 1.3 %, mean of four regressors."""
    coverage: Callable[..., dict[str, np.ndarray]] = script["coverage"]
    found = coverage(script["NOISES"][noise], draws=300, n=2000, seed=11)["softid"]
    assert least <= found.mean() <= 99.0


@pytest.mark.slow
def test_a_block_for_each_log_covers(script: dict[str, Any]) -> None:
    """Logs of unequal size: 84 % pooled, 97 % apart, 300 draws, one standard error 1.3 %."""
    found = script["unequal_logs"](draws=300, seed=12)
    assert found["a block for each log"] >= 92.0
    assert found["one block"] < 90.0
