"""Single samples that are far off those beside them."""

from __future__ import annotations

import numpy as np
import pytest

from softid.diagnosis.residual.single_spikes import pairs_in, spikes_in


def test_a_coarse_residual_has_no_spikes() -> None:
    """More than half of the samples equal their neighbours: nothing says what is usual."""
    residual = np.round(0.35 * np.random.default_rng(0).standard_normal(2000))
    assert not spikes_in(residual).any()
    fine = np.random.default_rng(1).standard_normal(2000)
    fine[[500, 900]] = (12.0, -12.0)
    assert np.flatnonzero(spikes_in(fine)).tolist() == [500, 900]


@pytest.mark.parametrize("still", [True, False])
def test_two_side_by_side_where_the_input_does_not_jump(still: bool) -> None:
    """Neither is off both of its neighbours, and both are off those of the pair. A pulse of three
    samples, a step and a pair of ten deviations are none."""
    residual = np.random.default_rng(2).standard_normal(2000)
    residual[[300, 301]] += (94.0, 90.0)
    residual[600:603] += 90.0
    residual[900:] += 90.0
    residual[[1200, 1201]] += 10.0
    found = pairs_in(residual, np.full(residual.size, still))
    assert np.flatnonzero(found).tolist() == ([300, 301] if still else [])
    assert 300 not in np.flatnonzero(spikes_in(residual))


@pytest.mark.parametrize("fall", [5.0, 20.0, 33.0])
@pytest.mark.parametrize("rise", [5.0, 20.0, 100.0])
def test_corners_of_a_motion_are_none(rise: float, fall: float) -> None:
    """Peaks with straight sides, and with sides that decay by a share a sample, of a hundred times
    the noise; a single sample of that height on a slope is one.
    """
    rng = np.random.default_rng(3)
    at = np.arange(41) - 20
    sides = [np.maximum(100.0 + np.where(at < 0, rise * at, -fall * at), 0.0)]
    sides.append(100.0 * np.where(at < 0, 1.0 - rise / 101.0, 1.0 - fall / 200.0) ** np.abs(at))
    for peak in sides:
        residual = np.tile(peak, 40) + rng.standard_normal(40 * at.size)
        assert not spikes_in(residual).any()
    slope = np.cumsum(rng.standard_normal(1000) + 3.0)
    slope[500] += 100.0
    assert 500 in np.flatnonzero(spikes_in(slope))


@pytest.mark.parametrize("width", [3.0, 4.0, 6.0])
def test_what_a_filter_smoothed_has_none(width: float) -> None:
    """Peaks that turn round within several samples, smoothly or in a cusp as a filter that looks
    ahead leaves at a step, of hundreds of times the fast noise; a single reading off them is one.
    """
    rng = np.random.default_rng(4)
    at = np.arange(61) - 30
    for peak in (np.exp(-((at / width) ** 2)), np.exp(-np.abs(at) / width)):
        residual = np.tile(peak, 30) + 0.001 * rng.standard_normal(30 * at.size)
        assert not spikes_in(residual).any()
        residual[505] += 0.5
        assert np.flatnonzero(spikes_in(residual)).tolist() == [505]
