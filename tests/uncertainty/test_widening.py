"""Standard errors that are no smaller than what is known to scatter the parameters."""

from __future__ import annotations

import numpy as np
import pytest

from softid.uncertainty import Covariance, widened

KNOWN = Covariance(
    names=("M", "N", "Q"),
    matrix=np.array([[4.0, 1.0, np.nan], [1.0, 9.0, np.nan], [np.nan, np.nan, np.nan]]),
    sd=(2.0, 3.0, None),
    degrees_of_freedom=(20.0, 30.0, None),
    inflation=np.array([1.0, 2.0, np.nan]),
    cost_per_variance=np.array([5.0, 6.0, np.nan]),
    condition_number=7.0,
    undetermined=(("Q",),),
    noise=(),
)


def test_only_what_is_told_too_small_grows() -> None:
    """By hand: M from 2 to 6 is three times as wide, N is wider already, Q is not determined."""
    told = widened(KNOWN, {"M": 6.0, "N": 1.0, "Q": 1.0, "another": 1.0})
    assert told.sd == (6.0, 3.0, None)
    assert told.matrix[:2, :2] == pytest.approx(np.array([[36.0, 3.0], [3.0, 9.0]]))
    assert np.isnan(told.matrix[2]).all()
    assert told.inflation[:2] == pytest.approx([9.0, 2.0])
    assert told.cost_per_variance[:2] == pytest.approx([45.0, 6.0])
    assert told.degrees_of_freedom == KNOWN.degrees_of_freedom


def test_correlations_stay() -> None:
    """Invariant: D C D has the correlations of C, whatever the diagonal D."""
    told = widened(KNOWN, {"M": 3.0, "N": 30.0}).matrix[:2, :2]
    assert told[0, 1] / np.sqrt(told[0, 0] * told[1, 1]) == pytest.approx(1.0 / 6.0)


def test_nothing_known_changes_nothing() -> None:
    told = widened(KNOWN, {})
    assert told.sd == KNOWN.sd
    np.testing.assert_array_equal(told.matrix, KNOWN.matrix)
