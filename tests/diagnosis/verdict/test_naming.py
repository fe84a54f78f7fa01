"""Which links may be named as causes, and which verdict follows."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from handmade import fit_result
from handmade_diagnosis import cause, estimate, remainder
from handmade_rounds import bare_link

from softid.diagnosis.verdict.naming import (
    asks_for_the_others,
    doubt_of,
    may_be_chance,
    most_variation,
    nameable,
)
from softid.diagnosis_results import Doubt, Remainder, Variation
from softid.effects import effect_of
from softid.results import ParameterEstimate

PREDICTABLE = remainder(structured=True, explained=0.7)
RANDOM = replace(PREDICTABLE, structure_share=0.01)
WHOLE = 1.0


def model(squares: float) -> Any:
    return SimpleNamespace(squares=squares)


@pytest.mark.parametrize(
    ("left", "named"),
    [
        (remainder(structured=False, explained=0.1), (True, True)),
        (replace(RANDOM, explained_share=0.94), (True, True)),
        (replace(PREDICTABLE, explained_share=0.94), (True, True)),
        (replace(PREDICTABLE, explained_share=0.93), (False, False)),
        (replace(RANDOM, explained_share=0.93), (True, False)),
        (replace(RANDOM, explained_share=0.61), (True, False)),
        (replace(RANDOM, explained_share=0.60), (False, False)),
    ],
)
def test_what_may_be_named(left: Remainder, named: tuple[bool, ...]) -> None:
    """Stands on the rule: nothing is left; almost all; a random rest; a rest that has a cause.

    The links take 0.6 and 0.2 of the misfit, on both sides of the 0.3 that a dominant one needs.
    """
    assert nameable([bare_link(100.0), bare_link(40.0)], model(20.0), left, gain=0.55) == named


def test_a_dominant_link_is_measured_against_the_whole_misfit() -> None:
    """The second takes nine tenths of what the first left, which is a twentieth of the whole."""
    left = replace(RANDOM, explained_share=0.8)
    assert nameable([bare_link(100.0), bare_link(5.0)], model(0.5), left, gain=0.9) == (True, False)
    assert nameable([bare_link(100.0), bare_link(70.0)], model(40.0), left, gain=0.9) == (
        True,
        True,
    )
    assert nameable([], model(100.0), left, gain=0.0) == ()


def test_a_random_rest_allows_no_name_without_a_gain() -> None:
    """What is held out must lose half of its error."""
    left = replace(RANDOM, explained_share=0.8)
    assert nameable([bare_link(100.0)], model(20.0), left, gain=0.51) == (True,)
    assert nameable([bare_link(100.0)], model(20.0), left, gain=0.49) == (False,)


DRIFT = effect_of("sensor_drift")
RATE = estimate("sensor_drift_rate", 0.01, "rad/s")
OVER_ZERO = replace(RATE, ci95=(-0.001, 0.02))


@pytest.mark.parametrize(
    ("rate", "after", "named"),
    [
        (RATE, 1.97, True),
        (RATE, 1.99, False),
        (OVER_ZERO, 1.0, False),
        (replace(RATE, at_bound=True), 1.0, False),
    ],
)
def test_what_a_name_needs(rate: ParameterEstimate, after: float, named: bool) -> None:
    """A hundredth of the error of 2 on what is held out, and a size that is seen."""
    told = cause("sensor_drift", [rate], before=2.0, after=after)
    assert (doubt_of(told, DRIFT, fit_result(), WHOLE) is None) is named


@pytest.mark.parametrize(("second", "named"), [(-1.0, True), (1.0, False)])
def test_a_curve_stands_on_its_shape(second: float, named: bool) -> None:
    """Closed form: variances of 25 and a correlation of 0.9999 leave 0.0025 for the difference of
    two knots, which is 2 or 0, and 50 for their sum, so z' C⁻¹ z is 800 or 0.04."""
    curve = effect_of("static_curve")
    names = ("static_curve_k2", "static_curve_k3")
    knots = [replace(estimate(n, 1.0, "rad"), ci95=(-9.0, 9.0)) for n in names]
    knots[1] = replace(knots[1], value=second)
    shape = 25.0 * np.array([[1.0, 0.9999], [0.9999, 1.0]])
    fitted = replace(fit_result(), free=names, covariance=shape)
    told = cause("static_curve", knots, before=2.0, after=1.0)
    assert (doubt_of(told, curve, fitted, WHOLE) is None) is named
    assert doubt_of(told, curve, replace(fitted, covariance=None), WHOLE) is Doubt.MAY_BE_ZERO


@pytest.mark.parametrize(("at_bound", "named"), [(True, False), (False, True)])
def test_a_relaxation_has_a_time_of_its_own(at_bound: bool, named: bool) -> None:
    """At a bound of its time a creep is a damper, or a spring."""
    times = [replace(estimate("creep_tau", 0.05, "s"), at_bound=at_bound)]
    told = cause("creep", [estimate("creep_k", 1.0, "1"), *times], before=2.0, after=1.0)
    assert (doubt_of(told, effect_of("creep"), fit_result(), WHOLE) is None) is named


@pytest.mark.parametrize(("second", "named"), [(-1.0, True), (1.0, False)])
def test_a_knot_at_its_bound_is_judged_with_the_others(second: float, named: bool) -> None:
    """The same closed form: a bound that the common slope ran into says nothing of the shape."""
    names = ("static_curve_k2", "static_curve_k3")
    knots = [replace(estimate(n, 1.0, "rad"), at_bound=True) for n in names]
    knots[1] = replace(knots[1], value=second, at_bound=False)
    shape = 25.0 * np.array([[1.0, 0.9999], [0.9999, 1.0]])
    fitted = replace(fit_result(), free=names, covariance=shape)
    told = cause("static_curve", knots, before=2.0, after=1.0)
    assert (doubt_of(told, effect_of("static_curve"), fitted, WHOLE) is None) is named


@pytest.mark.parametrize(
    ("after", "ci95", "named"),
    [
        (1.81, (0.01, 0.31), False),
        (1.81, (0.01, 0.29), True),
        (1.81, (0.0, 0.1), False),
        (1.81, None, True),
        (1.79, (0.01, 0.31), True),
    ],
)
def test_a_slight_cause_has_a_size(
    after: float, ci95: tuple[float, float] | None, named: bool
) -> None:
    """Of an error of 2 on what is held out less than a tenth goes: then the ends of the interval
    must be within a factor of 30. Where more goes, no size is asked for."""
    size = replace(estimate("coulomb_friction_Fc", 0.05, "1"), ci95=ci95)
    told = cause("coulomb_friction", [size], before=2.0, after=after)
    assert (doubt_of(told, effect_of("coulomb_friction"), fit_result(), WHOLE) is None) is named


@pytest.mark.parametrize(
    ("ci95", "vb", "named"),
    [
        ((0.01, 0.31), 2.0, False),
        ((0.01, 0.29), 2.0, True),
        ((0.01, 0.31), 0.1, True),
        (None, 2.0, True),
    ],
)
def test_the_corner_of_a_law_is_not_named(
    ci95: tuple[float, float] | None, vb: float, named: bool
) -> None:
    """Half of the error goes. A friction of any size whose excess is still there at the largest
    speed, 2 rad/s, is some other damping; at the smallest, 0.1 rad/s, it is dry friction."""
    size = replace(estimate("coulomb_friction_Fc", 0.05, "1"), ci95=ci95)
    speed = replace(estimate("coulomb_friction_vb", vb, "rad/s"), lower=0.1, upper=2.0)
    told = cause(
        "coulomb_friction.stribeck", [size, replace(speed, at_bound=True)], before=2.0, after=1.0
    )
    doubt = doubt_of(told, effect_of("coulomb_friction.stribeck"), fit_result(), WHOLE)
    assert doubt is (None if named else Doubt.AT_BOUND)


@pytest.mark.parametrize(
    ("value", "at_bound", "named"),
    [(2.0, True, False), (0.1, True, True), (1.9, False, True)],
)
def test_a_friction_that_comes_up_slowly_is_damping(
    value: float, at_bound: bool, named: bool
) -> None:
    """At its largest speed the law is another one; at its smallest it is a sudden change."""
    speed = estimate("asymmetric_damping_v0", value, "rad/s")
    speed = replace(speed, at_bound=at_bound, lower=0.1, upper=2.0)
    told = cause("asymmetric_damping", [speed], before=2.0, after=1.0)
    assert (doubt_of(told, effect_of("asymmetric_damping"), fit_result(), WHOLE) is None) is named


@pytest.mark.parametrize(
    ("value", "at_bound", "ci95", "named"),
    [
        (0.02, True, None, False),
        (0.03, False, (0.015, 0.045), False),
        (0.03, False, (0.025, 0.035), True),
        (5.0, True, (1.0, 9.0), False),
    ],
)
def test_nothing_rings_for_ever(
    value: float, at_bound: bool, ci95: tuple[float, float] | None, named: bool
) -> None:
    """A resonance whose damping may be the least there is, 0.02, undoes a filter of the record."""
    zeta = replace(estimate("line_resonance_zeta", value, "1"), lower=0.02, upper=5.0)
    zeta = replace(zeta, at_bound=at_bound, ci95=ci95)
    told = cause("line_resonance", [zeta], before=2.0, after=1.0)
    doubt = doubt_of(told, effect_of("line_resonance"), fit_result(), WHOLE)
    assert doubt is (None if named else Doubt.AT_BOUND)


def test_a_creep_at_its_longest_time_is_too_slow_for_the_logs() -> None:
    """Not another law, as a bound of a size would say: a longer log would tell."""
    tau = replace(estimate("creep_tau", 96.0, "s"), upper=96.0, at_bound=True, ci95=None)
    told = cause("creep", [estimate("creep_k", 1.0, "1"), tau], before=2.0, after=1.0)
    assert doubt_of(told, effect_of("creep"), fit_result(), WHOLE) is Doubt.TOO_SLOW


@pytest.mark.parametrize(("at_bound", "named"), [(True, False), (False, True)])
def test_a_time_twenty_times_as_long_at_one_level_is_not_named(at_bound: bool, named: bool) -> None:
    """No chamber swells so far: the lag stands for something else that differs by level."""
    ratio = replace(estimate("pneumatic_lag_ratio", 20.0, "1"), at_bound=at_bound)
    told = cause("pneumatic_lag.level", [ratio], before=2.0, after=1.0)
    doubt = doubt_of(told, effect_of("pneumatic_lag.level"), fit_result(), WHOLE)
    assert doubt is (None if named else Doubt.AT_BOUND)


def test_a_loop_that_never_closes_or_does_at_once_is_not_named() -> None:
    """Over the longest distance the branch has not arrived, and the law is nearly a spring; over
    the shortest it is dry friction, which the catalogue has."""
    for value, named in ((0.6, False), (0.01, False), (0.1, True)):
        distance = replace(estimate("hysteresis_zs", value, "rad"), at_bound=not named)
        distance = replace(distance, lower=0.01, upper=0.6)
        told = cause("hysteresis", [distance], before=2.0, after=1.0)
        assert (doubt_of(told, effect_of("hysteresis"), fit_result(), WHOLE) is None) is named


@pytest.mark.parametrize(("at_bound", "named"), [(True, False), (False, True)])
def test_a_ring_at_the_sampling_limit_is_not_named(at_bound: bool, named: bool) -> None:
    """At its shortest period it is what the input does between two samples."""
    period = replace(estimate("line_resonance_period", 0.06, "s"), at_bound=at_bound)
    told = cause("line_resonance", [period], before=2.0, after=1.0)
    assert (doubt_of(told, effect_of("line_resonance"), fit_result(), WHOLE) is None) is named


def test_an_obstacle_may_be_as_stiff_as_it_is_asked_to_be() -> None:
    """Its size has one sign, so that a bound says no more than that it is stiff."""
    stop = replace(estimate("contact_kw", 1e6, "1"), at_bound=True)
    contact = effect_of("contact")
    told = cause("contact", [stop], before=2.0, after=1.0)
    assert doubt_of(told, contact, fit_result(), WHOLE) is None


@pytest.mark.parametrize(
    ("doubts", "chance"),
    [
        ([Doubt.MAY_GAIN_NOTHING], True),
        ([Doubt.MAY_BE_ZERO, Doubt.UNKNOWN_SIZE], True),
        ([Doubt.MAY_BE_ZERO, Doubt.AT_BOUND], False),
        ([Doubt.VARIES], False),
        ([None], False),
    ],
)
def test_what_may_be_chance(doubts: list[Doubt | None], chance: bool) -> None:
    """A law at its bound or with a size that varies stands for something else, not for nothing."""
    described = [replace(cause("creep", [], before=2.0, after=1.9), doubt=d) for d in doubts]
    assert may_be_chance(described) is chance


@pytest.mark.parametrize(("without", "named"), [(1.02, True), (1.005, False), (None, False)])
def test_a_cause_that_the_others_need(without: float | None, named: bool) -> None:
    """By itself it doubles the error of 1; the others leave so much without it, and 1 with it."""
    told = cause("sensor_drift", [RATE], before=1.0, after=2.0)
    told = replace(told, holdout_rmse_without=without)
    assert (doubt_of(told, DRIFT, fit_result(), WHOLE) is None) is named


@pytest.mark.parametrize(
    ("interval", "without", "named"),
    [
        ((0.0, 0.05), None, True),
        ((-0.01, 0.05), None, False),
        ((-0.01, 0.05), 2.0, True),
        (None, None, True),
    ],
)
def test_a_cause_that_may_gain_nothing_is_none(
    interval: tuple[float, float] | None, without: float | None, named: bool
) -> None:
    """Unless leaving it out says that the others need it, or nothing says how sure its gain is.

    An interval that ends at zero holds no loss: all parts of what is held out gain.
    """
    told = cause("sensor_drift", [RATE], before=2.0, after=1.9)
    told = replace(told, gain_ci95=interval, holdout_rmse_without=without)
    assert (doubt_of(told, DRIFT, fit_result(), WHOLE) is None) is named


@pytest.mark.parametrize(
    ("interval", "named"), [((0.3, 0.9), True), ((0.3, 1.4), True), ((0.1, 1.4), False)]
)
def test_a_contact_anywhere_is_none(interval: tuple[float, float], named: bool) -> None:
    """Its place lies within 0.2 to 1.2 mm, and an interval that holds both says nothing."""
    place = replace(
        estimate("contact_xw", 0.6, "mm"), ci95=interval, lower=0.2, upper=1.2, at_bound=False
    )
    told = cause("contact", [estimate("contact_kw", 2.0, "1/mm"), place], before=2.0, after=1.0)
    found = doubt_of(told, effect_of("contact"), fit_result(), WHOLE)
    assert found is (None if named else Doubt.AT_BOUND)


@pytest.mark.parametrize(("longest", "named"), [(40.0, True), (50.0, False)])
def test_a_time_that_may_be_the_longest_is_no_creep(longest: float, named: bool) -> None:
    """A log that tells times up to 45 s, and an interval that ends before or beyond that."""
    tau = replace(estimate("creep_tau", 20.0, "s"), ci95=(5.0, longest), upper=45.0)
    told = cause("creep", [estimate("creep_k", 1.0, "1"), tau], before=2.0, after=1.0)
    assert (doubt_of(told, effect_of("creep"), fit_result(), WHOLE) is None) is named


@pytest.mark.parametrize(("value", "is_there"), [(3.0, True), (2.9985, True), (2.99, False)])
def test_a_share_at_its_bound_is_no_creep(value: float, is_there: bool) -> None:
    """What creeps on by three times the change that it follows is the change itself; a fit may end
    a little before the bound."""
    share = replace(estimate("creep_c", value, "1"), upper=3.0, at_bound=value == 3.0)
    told = cause("creep.series", [share, estimate("creep_tau", 2.0, "s")], before=2.0, after=1.0)
    assert (doubt_of(told, effect_of("creep.series"), fit_result(), WHOLE) is not None) is is_there


@pytest.mark.parametrize(("lowest", "named"), [(-0.029, True), (-0.031, False)])
def test_a_large_gain_may_barely_be_none(lowest: float, named: bool) -> None:
    """Of a gain of 30 % the interval may end up to 3 % below zero, as that of few blocks does."""
    told = cause("sensor_drift", [RATE], before=2.0, after=1.4)
    told = replace(told, gain_ci95=(lowest, 0.5), holdout_rmse_without=None)
    assert (doubt_of(told, DRIFT, fit_result(), 1.4) is None) is named


@pytest.mark.parametrize(("share", "named"), [(None, True), (0.029, True), (0.031, False)])
def test_a_cause_whose_size_varies_is_another(share: float | None, named: bool) -> None:
    """What letting it vary takes away may be a thirtieth of what the cause does, not more."""
    told = cause("sensor_drift", [RATE], before=2.0, after=1.0)
    varied = Variation("t", 0.2, share, 1e-9) if share is not None else None
    assert (doubt_of(replace(told, variation=varied), DRIFT, fit_result(), WHOLE) is None) is named


@pytest.mark.parametrize(("structured", "most"), [(False, 0.03), (True, 0.1)])
def test_beside_something_smaller_a_size_may_vary_more(structured: bool, most: float) -> None:
    """What else is left has a law of its own, which the size of the main cause follows a little."""
    assert most_variation(remainder(structured=structured, explained=0.9)) == most


@pytest.mark.parametrize(("without", "named"), [(None, False), (2.0, False), (3.0, True)])
def test_a_size_of_any_order_needs_a_gain(without: float | None, named: bool) -> None:
    """First of several it takes a twentieth away; beside all others it may be much more.

    A law known up to a common factor of its forces knows no force beside a free static curve.
    """
    size = replace(estimate("hysteresis_alpha", 0.1, "kPa"), ci95=(0.02, 0.9), at_bound=False)
    told = cause("hysteresis", [size], before=2.2, after=2.1)
    told = replace(told, holdout_rmse_without=without, gain_ci95=(0.02, 0.1))
    hysteresis = effect_of("hysteresis")
    assert asks_for_the_others(told, hysteresis)
    found = doubt_of(told, hysteresis, fit_result(), 1.9)
    assert (found is None) is named
    assert named or found is Doubt.UNKNOWN_SIZE
