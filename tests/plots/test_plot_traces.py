"""Thinning and breaking of lines."""

from __future__ import annotations

import numpy as np
import pytest

from softid.plots.traces import (
    broken_trace,
    decimate,
    padded_limits,
    segment_spans,
    thinned_points,
)


def test_every_peak_survives_decimation() -> None:
    """Definition: single-sample peaks, one a bucket at most, keep position and height."""
    rng = np.random.default_rng(1)
    x = np.arange(100_000) * 0.001
    y = 0.1 * rng.standard_normal(x.size)
    peaks = np.arange(50) * 2000 + rng.integers(0, 100, 50)
    y[peaks] = 10.0 + np.arange(50)
    y[peaks[::2]] *= -1.0
    thin_x, thin_y = decimate(x, y, buckets=1000)
    assert thin_x.size <= 4 * 1000
    kept = dict(zip(thin_x.tolist(), thin_y.tolist(), strict=True))
    assert all(kept[x[k]] == y[k] for k in peaks)


def test_decimation_keeps_order_ends_and_envelope() -> None:
    """Definition: in each bucket's span the thinned line has the same extremes as the whole."""
    x = np.linspace(0.0, 50.0, 30_007)
    y = np.sin(x**2)
    thin_x, thin_y = decimate(x, y, buckets=100)
    assert np.all(np.diff(thin_x) > 0)
    assert (thin_x[0], thin_x[-1]) == (x[0], x[-1])
    size = -(-x.size // 100)
    for k in range(0, x.size, size):
        inside = (thin_x >= x[k]) & (thin_x <= x[min(k + size, x.size) - 1])
        assert thin_y[inside].max() == y[k : k + size].max()
        assert thin_y[inside].min() == y[k : k + size].min()


def test_breaks_survive_decimation() -> None:
    """Definition: each NaN of the line is a gap in the drawing and must be kept."""
    y = np.sin(np.arange(50_000) * 0.01)
    y[[100, 20_000, 49_998]] = np.nan
    _, thin = decimate(np.arange(50_000.0), y, buckets=200)
    assert int(np.isnan(thin).sum()) == 3


def test_a_loop_keeps_its_extremes_in_both_directions() -> None:
    """An ellipse: x is not sorted, so its extremes must be kept as well as those of y."""
    phase = np.linspace(0.0, 2 * np.pi, 40_000)
    x, y = decimate(3.0 * np.cos(phase), np.sin(phase), buckets=37)
    assert x.size <= 6 * 37
    assert (x.min(), x.max()) == pytest.approx((-3.0, 3.0), abs=1e-7)
    assert (y.min(), y.max()) == pytest.approx((-1.0, 1.0), abs=1e-7)


def test_short_lines_are_left_alone() -> None:
    """1,000 samples fit into the pixels as they are."""
    x = np.arange(1000.0)
    assert decimate(x, x)[0] is x


def test_a_line_breaks_at_segments_and_long_drop_outs_only() -> None:
    """The log's rule: max(0.5 s, 10 periods) at 10 Hz is 1 s; 0.3 s is bridged, 2 s is not."""
    time_s = np.arange(100) * 0.1
    values = np.ones(100)
    values[10:13] = np.nan
    values[40:60] = np.nan
    x, y = broken_trace(time_s, values, (0, 80))
    assert np.flatnonzero(np.isnan(y)).size == 2
    at = x[np.isnan(y)]
    assert 3.9 < at[0] < 6.0
    assert 7.9 < at[1] < 8.0


def test_a_channel_slower_than_the_clock_stays_a_line() -> None:
    """Every third sample recorded: dropping NaN must not leave isolated points."""
    time_s = np.arange(300) * 0.01
    values = np.where(np.arange(300) % 3 == 0, time_s, np.nan)
    x, y = broken_trace(time_s, values)
    assert y.size == 100
    assert np.isfinite(y).all()
    assert np.array_equal(x, y)


@pytest.mark.parametrize("values", [[np.nan, np.nan, np.nan], [np.nan, 2.0, np.nan]])
def test_almost_empty_records_do_not_fail(values: list[float]) -> None:
    """No or one sample: nothing to connect."""
    _, y = broken_trace(np.arange(3.0), np.array(values))
    assert y.size == np.isfinite(values).sum()


def test_a_cloud_keeps_its_outline() -> None:
    """Definition: the extreme points of a cloud stay, missing ones go."""
    rng = np.random.default_rng(2)
    x, y = rng.standard_normal((2, 50_000))
    y[7] = np.nan
    thin_x, thin_y = thinned_points(x, y, buckets=300)
    assert thin_x.size <= 4 * 300
    assert np.isfinite(thin_y).all()
    assert (thin_y.min(), thin_y.max()) == (np.nanmin(y), np.nanmax(y))


def test_limits_hold_everything_with_room() -> None:
    """5 % of the span on either side; none without a finite value."""
    limits = padded_limits(np.array([0.0, np.nan]), np.array([10.0]))
    assert limits == pytest.approx((-0.5, 10.5))
    assert padded_limits(np.array([np.nan])) is None
    constant = padded_limits(np.array([4.0, 4.0]))
    assert constant is not None
    assert constant[0] < 4.0 < constant[1]


def test_lone_samples_are_no_segment() -> None:
    """A segment has two samples or more."""
    assert segment_spans((0, 5, 6), 10) == (slice(0, 5), slice(6, 10))
