"""The products of a long log, half of which another thread sums."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
import numpy.typing as npt
import pytest

from softid.log import Log
from softid.models import summed_products
from softid.models.division import divide
from softid.models.muscle_law import MuscleLaw
from softid.models.oscillator import OscillatorLaw
from softid.models.products import NO_COLUMNS, Keep, Products
from softid.models.second_order import Law
from softid.segment import Segment

Array = npt.NDArray[np.float64]
N = 40_003
"""Samples: more steps than `HALVED_STEPS`, and a last stretch of 7 that is short."""

MUSCLE = MuscleLaw(np.array([3e-3, 0.0143, 3.0, 0.95, 1.5e-3, 2.0, 0.28]))
DRIVE = OscillatorLaw(np.array([0.3, 1.1, 0.0, -1.5, 0.4]))
"""A motion that forgets within a second, and one without a spring that never does."""


def segment() -> Segment:
    rng = np.random.default_rng(4)
    time_s = np.cumsum(rng.uniform(0.002, 0.006, N))
    pressure = 100.0 + 80.0 * np.sin(time_s) + np.where(time_s % 2.0 < 1.0, 0.0, 30.0)
    y = 20.0 + rng.normal(size=N)
    y[rng.random(N) < 0.1] = np.nan
    log = Log.from_arrays(time_s, {"pressure": pressure, "contraction": y})
    return log.segments()[0]


def products(law: Law, part: Segment, keep: Keep) -> Products:
    found = summed_products.sum_law(
        law, part, "contraction", np.array([1.0, -2.0]),
        relative=False, plan=divide(law, part.time_s, part.input), gain=-0.5, level=0.3, keep=keep,
    )  # fmt: skip
    assert found is not None
    return found


@pytest.mark.parametrize("law", [MUSCLE, DRIVE])
@pytest.mark.parametrize("keep", [NO_COLUMNS, Keep(7, residual=True)])
def test_halves_make_up_the_whole(law: Law, keep: Keep) -> None:
    """What one run through the log sums and keeps, to rounding, whether it forgets or not."""
    part = segment()
    with patch.object(summed_products, "HALVED_STEPS", 10 * N):
        whole = products(law, part, keep)
    halves = products(law, part, keep)
    scale = np.sqrt(np.diag(whole.gram))
    assert np.all(np.abs(halves.gram - whole.gram) <= 1e-12 * np.outer(scale, scale))
    if keep.stretch:
        assert whole.columns is not None
        assert halves.columns is not None
        most = np.abs(whole.columns).max(axis=1, keepdims=True)
        assert np.all(np.abs(halves.columns - whole.columns) <= 1e-12 * most)
        np.testing.assert_allclose(halves.left, whole.left, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("law", [MUSCLE, DRIVE])
def test_a_second_thread_changes_no_digit(law: Law) -> None:
    """The same bits where one thread takes both halves."""
    part, keep = segment(), Keep(7, residual=True)
    by_two = products(law, part, keep)
    with patch.object(summed_products, "on_two_threads", lambda first, second: (first(), second())):
        by_one = products(law, part, keep)
    np.testing.assert_array_equal(by_two.gram, by_one.gram)
    np.testing.assert_array_equal(by_two.columns, by_one.columns)
    np.testing.assert_array_equal(by_two.left, by_one.left)


def test_only_a_motion_that_forgets_is_summed_by_halves() -> None:
    """A drive keeps its place for ever, so that its second half must wait for the first."""
    part, runs = segment(), []

    def both(first, second):
        runs.append((first(), second()))
        return runs[-1]

    with patch.object(summed_products, "on_two_threads", both):
        products(MUSCLE, part, NO_COLUMNS)
        products(DRIVE, part, NO_COLUMNS)
    assert [later is not None for _, later in runs] == [True, False]


def test_what_overflows_is_not_finite() -> None:
    """A fit rejects it."""
    law = MuscleLaw(np.array([3e-3, 0.0143, 900.0, 0.95, 1.5e-3, 2.0, 0.28]))
    assert not np.isfinite(products(law, segment(), NO_COLUMNS).gram).all()
