"""Scores of a simulated output against numbers by hand."""

from __future__ import annotations

import numpy as np
import pytest

from softid.errors import InputError
from softid.results import FitStatistics
from softid.scores import fit_percent, fit_statistics


def scored(y: np.ndarray, s: np.ndarray) -> FitStatistics:
    return fit_statistics(y, s, log="a", channel="angle", unit="rad", in_sample=True)


def test_scores_by_hand() -> None:
    """y = 0, 2, 4, ŷ = 1, 2, 3: errors −1, 0, 1, ‖y − ȳ‖ = √8, var ratio 1/4."""
    y, s = np.array([0.0, 2.0, 4.0]), np.array([1.0, 2.0, 3.0])
    found = scored(y, s)
    assert found.rmse == pytest.approx(np.sqrt(2.0 / 3.0))
    assert found.nrmse == pytest.approx(0.5)
    assert found.fit_percent == fit_percent(y, s) == pytest.approx(50.0)
    assert found.r2 == pytest.approx(0.75)
    assert found.vaf == pytest.approx(75.0)


def test_vaf_forgives_an_offset_that_fit_does_not() -> None:
    """A shift by 2 leaves var(y − ŷ) = 0, but ‖y − ŷ‖ = √12 > ‖y − ȳ‖ = √8."""
    y = np.array([0.0, 2.0, 4.0])
    found = scored(y, y + 2.0)
    assert found.vaf == pytest.approx(100.0)
    assert found.fit_percent == pytest.approx(100.0 * (1.0 - np.sqrt(1.5)))


def test_fit_statistics_leaves_out_unused_samples() -> None:
    """The masked sample and the missing one would ruin the score; the display unit is passed on."""
    y = np.array([0.0, 1.0, 2.0, 3.0, np.nan])
    s = np.array([0.0, 1.0, 2.0, 99.0, 4.0])
    used = np.array([True, True, True, False, True])
    found = fit_statistics(
        y,
        s,
        log="a",
        channel="angle",
        unit="rad",
        in_sample=False,
        used=used,
        display_unit="deg",
        display_factor=57.3,
    )
    assert (found.n, found.rmse, found.fit_percent) == (3, 0.0, 100.0)
    assert (found.kind, found.in_sample) == ("simulated", False)
    assert (found.display_unit, found.display_factor) == ("deg", 57.3)


def test_constant_measurement_has_no_relative_score() -> None:
    """0/0: the rmse stands, the relative scores are undefined."""
    y = np.ones(4)
    assert scored(y, y + 1.0).rmse == 1.0
    same = scored(y, y)
    assert np.isnan([same.nrmse, same.fit_percent, same.r2, same.vaf, fit_percent(y, y)]).all()
    odd = np.full(1000, 0.1)  # whose mean is not 0.1
    assert odd.mean() != 0.1
    assert np.isnan([scored(odd, odd + 1.0).nrmse, scored(odd, odd).vaf]).all()


def test_nothing_to_compare_is_an_error() -> None:
    """No sample is there on both sides."""
    with pytest.raises(InputError, match="no sample"):
        scored(np.array([np.nan]), np.array([1.0]))
