"""Arc geometry against printed golden numbers, closed forms and numerical derivatives."""

from __future__ import annotations

import numpy as np
import pytest

from softid.errors import InputError, UsageError
from softid.models.geometry import ArcGeometry, sinc, sinc_slope

PAPER = ArcGeometry(fixed_length_mm=150.0, diameter_mm=20.0)
SHORT = ArcGeometry(fixed_length_mm=40.0, diameter_mm=20.0)
"""Its branch ends at θ = 2·L0/d = 4, before a full turn; that of PAPER ends at 2π."""


def test_distance_of_the_three_golden_contractions():
    """D at x = 10, 30, 60 mm, computed twice from Ru Eq 1; printed to 1e-6 mm."""
    found = PAPER.distance_mm([10.0, 30.0, 60.0])
    assert np.abs(found - [143.494296, 122.694977, 79.799599]).max() < 5e-7


def test_both_printed_equations_agree_for_the_diameter_and_not_for_the_radius():
    """Ru Eq 2 with d as the diameter equals Eq 1: 109.4 mm at θ = 2; as a radius it is 124.7 mm."""
    theta = 2.0
    length = 150.0 - 20.0 * theta
    by_equation_2 = 2.0 * np.sin(theta / 2) * (length / theta + 20.0 / 2)
    assert float(PAPER.distance_mm(20.0 * theta)) == pytest.approx(by_equation_2, rel=1e-14)
    assert by_equation_2 == pytest.approx(109.4, abs=0.05)
    as_radius = ArcGeometry(fixed_length_mm=150.0, diameter_mm=40.0)
    assert float(as_radius.distance_mm(40.0)) == pytest.approx(124.7, abs=0.05)


def test_slope_at_rest_is_minus_one_half():
    """dD/dL = 1/2 at θ = 0: the chord of a straight muscle is the mean of its two sides."""
    for geometry in (PAPER, SHORT):
        assert float(geometry.distance_slope(0.0)) == -0.5


@pytest.mark.parametrize("geometry", [PAPER, SHORT])
def test_slope_equals_the_central_difference(geometry):
    """Central difference with h = 1e-4 mm: truncation 1e-10, rounding 1e-10."""
    x = np.linspace(-10.0, 0.98 * geometry.largest_contraction_mm, 301)
    h = 1e-4
    numerical = (geometry.distance_mm(x + h) - geometry.distance_mm(x - h)) / (2 * h)
    assert np.abs(geometry.distance_slope(x) - numerical).max() < 1e-8


def test_sinc_and_its_slope_keep_relative_precision_near_zero():
    """Leading Taylor terms 1 − u²/6 and −u/3 + u³/30, exact to 1e-15 below u = 1e-3.

    The closed form of the slope is off by 1e-4 at u = 1e-6: it subtracts two ones.
    """
    u = np.array([1e-12, 1e-8, 1e-6, 1e-4, 1e-3])
    assert sinc_slope(u) == pytest.approx(-u / 3 + u**3 / 30, rel=1e-13)
    assert sinc(u) == pytest.approx(1 - u**2 / 6 + u**4 / 120, rel=1e-15)
    assert sinc_slope(np.zeros(1)).tolist() == [0.0]


def test_series_and_closed_form_meet():
    """Both branches of sinc and of its slope agree across the switch at 0.5 to rounding."""
    below, above = np.array([0.5 - 1e-13]), np.array([0.5])
    assert sinc(below) == pytest.approx(sinc(above), rel=1e-12)
    assert sinc_slope(below) == pytest.approx(sinc_slope(above), rel=1e-12)


@pytest.mark.parametrize("geometry", [PAPER, SHORT])
def test_contraction_of_a_distance_round_trips_over_the_whole_branch(geometry):
    """x → D → x; rounding of D (3e-14 mm) over the slope (≥ 0.1) bounds the error by 1e-12 mm."""
    x = np.linspace(0.0, 1.0, 2001)[1:-1] * geometry.largest_contraction_mm
    back = geometry.contraction_from_distance_mm(geometry.distance_mm(x))
    assert np.abs(back - x).max() < 2e-12


def test_distance_falls_strictly_on_the_branch_and_not_beyond_rest():
    """The branch (0, min(2π, 2·L0/d)) is where the inverse is unique; extension is two-valued."""
    for geometry in (PAPER, SHORT):
        inside = np.linspace(0.0, geometry.largest_contraction_mm, 5001)[1:]
        assert np.all(np.diff(geometry.distance_mm(inside)) < 0)
    extended = PAPER.distance_mm(np.linspace(-60.0, 0.0, 500))
    assert extended.max() == pytest.approx(PAPER.longest_distance_mm, abs=1e-3)
    assert 150.0 < extended.max() < 154.0
    assert extended[0] < 150.0


def test_noise_above_the_fixed_length_is_continued_and_does_not_bias_the_lowest_level():
    """Mean contraction at rest under 0.2 mm of noise in D stays 0 within 4 standard errors.

    Holding D at L0 instead gives the mean of a folded normal law, 2·0.2/√(2π) = 0.16 mm, which is
    28 standard errors away.
    """
    noise = np.random.default_rng(5).normal(0.0, 0.2, 5000)
    x = PAPER.contraction_from_distance_mm(150.0 + noise)
    standard_error = 2 * 0.2 / np.sqrt(noise.size)
    assert abs(x.mean()) < 4 * standard_error
    assert x.std() == pytest.approx(2 * 0.2, rel=0.05)
    held = PAPER.contraction_from_distance_mm(np.minimum(150.0 + noise, 150.0))
    assert held.mean() > 20 * standard_error
    assert PAPER.continued(150.0 + noise).sum() == (noise > 0).sum()


def test_missing_samples_stay_missing():
    """A NaN is a drop-out of the sensor, not a value out of range."""
    assert np.isnan(PAPER.contraction_from_distance_mm([100.0, np.nan])).tolist() == [False, True]


@pytest.mark.parametrize("distance", [0.0, -3.0, 160.0, np.inf])
def test_a_distance_that_no_arc_reaches_is_refused(distance):
    """The message has the value, the range and the remedy."""
    with pytest.raises(InputError, match=r"range of an arc with L0 = 150 mm") as caught:
        PAPER.contraction_from_distance_mm([100.0, distance])
    assert caught.value.value == distance
    assert "check the unit" in str(caught.value)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_a_length_that_is_none_is_refused(value):
    """Lengths are positive numbers."""
    with pytest.raises(UsageError, match="diameter_mm is not a positive length"):
        ArcGeometry(fixed_length_mm=150.0, diameter_mm=value)


def test_angle_and_length_are_linear_in_the_contraction():
    """θ = (L0 − L)/d and L = L0 − x, and back from L."""
    x = np.array([0.0, 10.0, 60.0])
    assert PAPER.angle_rad(x).tolist() == [0.0, 0.5, 3.0]
    assert PAPER.length_mm(x).tolist() == [150.0, 140.0, 90.0]
    assert PAPER.contraction_from_length_mm(PAPER.length_mm(x)).tolist() == x.tolist()
