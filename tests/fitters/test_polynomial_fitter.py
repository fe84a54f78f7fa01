"""Zhao's quartic protocol on sweeps of the printed curves."""

from __future__ import annotations

import numpy as np
import pytest
from noise import ar1

from softid.errors import IdentificationError, InputError, UsageError
from softid.fitters.order_choice import level_blocks
from softid.fitters.polynomial import (
    branches,
    choose_order,
    curve_stderr,
    inverse,
    predict,
    quartic,
    quartics,
)
from softid.models.polynomial import evaluate
from softid.models.zhao2021 import (
    ANGLE_COEFFICIENTS,
    PRESSURE_KPA,
    TORQUE_COEFFICIENTS,
    compare_with_finite_element,
)

LEVELS_KPA = np.array(PRESSURE_KPA)
MIDDLE, SIDE = ANGLE_COEFFICIENTS["middle"], ANGLE_COEFFICIENTS["side"]


def _triangle(n: int, low: float = 10.0, high: float = 80.0):
    return low + (high - low) * (1 - np.abs(np.linspace(-1, 1, n)))


@pytest.mark.parametrize("truth", [*ANGLE_COEFFICIENTS.values(), *TORQUE_COEFFICIENTS.values()])
def test_printed_coefficients_come_back_from_the_eight_levels(truth):
    """Tables 4 and 5 from exact values at 10, 20, …, 80 kPa.

    Raw-kPa coefficients carry the basis' condition number, 2.4e8 · 1e-16 = 3e-8 of the largest
    scaled term; 1e-6 relative leaves room for the smaller ones. The curve itself agrees to 1e-13.
    """
    fit = quartic(LEVELS_KPA, evaluate(truth, LEVELS_KPA))
    assert fit.coefficients == pytest.approx(truth, rel=1e-6)
    fine = np.linspace(10, 80, 701)
    assert predict(fit, fine) == pytest.approx(evaluate(truth, fine), rel=1e-12)
    assert fit.condition_raw == pytest.approx(2.4e8, rel=0.03)
    assert fit.condition_scaled == pytest.approx(17.0, abs=0.5)
    assert fit.n == 8


def test_the_recovered_quartic_gives_the_papers_errors():
    """0.2246 rad at 80 kPa and 9.16 % at 50 kPa against Table 2, from a sweep and not the table."""
    pressure = _triangle(400)
    fit = quartic(pressure, evaluate(MIDDLE, pressure))
    rows = compare_with_finite_element(fit.coefficients)
    assert max(abs(r.error_rad) for r in rows) == pytest.approx(0.2246, abs=5e-5)
    assert max(r.error_percent for r in rows) == pytest.approx(9.16, abs=0.006)


def test_monotonicity_is_judged_over_the_fitted_range():
    """Φ_mid falls from 79.1 kPa, Φ_LR between 62.7(7) and 68.8 kPa; up to 60 kPa both rise."""
    middle = quartic(LEVELS_KPA, evaluate(MIDDLE, LEVELS_KPA))
    side = quartic(LEVELS_KPA, evaluate(SIDE, LEVELS_KPA))
    assert not middle.monotone
    assert middle.backward_kpa[0] == pytest.approx((79.1, 80.0), abs=0.05)
    assert side.backward_kpa[0] == pytest.approx((62.77, 68.8), abs=0.01)
    assert "62.8 to 68.8 kPa" in next(i.message for i in side.issues if i.code == "not-monotone")
    assert quartic(LEVELS_KPA[:6], evaluate(SIDE, LEVELS_KPA[:6])).monotone


def test_white_noise_gives_errors_that_cover():
    """Standard errors of the curve at 40 kPa: 300 repetitions at 20 samples a level.

    The ratio of error to standard error has unit variance; its sample variance over 300 draws
    scatters by √(2/300) = 8 %, so 4 of those bound the test, plus 5 % for the estimated memory.
    """
    rng = np.random.default_rng(11)
    pressure = np.repeat(LEVELS_KPA, 20)
    exact, at = evaluate(MIDDLE, pressure), np.array([40.0])
    ratios = []
    for _ in range(300):
        fit = quartic(pressure, exact + rng.normal(0, 0.02, pressure.size))
        band = curve_stderr(fit, at)
        assert band is not None
        ratios.append(float((predict(fit, at) - evaluate(MIDDLE, at))[0] / band[0]))
    assert np.mean(np.square(ratios)) == pytest.approx(1.0, abs=0.37)


def test_coloured_noise_widens_the_errors():
    """AR(1) noise with φ = 0.9 has (1 + φ)/(1 − φ) = 19 times the variance in slow means.

    Over a slow sweep the standard error must then be several times that of white noise; √19 = 4.4
    is the limit, and the estimate of φ from 800 samples lowers it a little.
    """
    rng = np.random.default_rng(2)
    pressure = _triangle(800)
    white = rng.normal(0, 0.02, pressure.size)
    coloured = 0.02 * ar1(rng, pressure.size, 0.9)
    bands = [
        curve_stderr(quartic(pressure, evaluate(MIDDLE, pressure) + e), [45.0])
        for e in (white, coloured)
    ]
    assert 2.5 < bands[1][0] / bands[0][0] < 6.5
    assert quartic(pressure, evaluate(MIDDLE, pressure) + white).residual_white
    seen = quartic(pressure, evaluate(MIDDLE, pressure) + coloured)
    assert seen.residual_white is False
    assert "coloured-residual" in [i.code for i in seen.issues]


def test_branches_and_chambers_are_fitted_apart():
    """A loop of ±0.1 rad in two chambers: each of the four fits is exact, one curve for all is not.

    Exact data, so 1e-10; the common curve of a chamber misses by half the loop, 0.1 rad.
    """
    pressure = np.tile(_triangle(201), 2)
    labels = ["middle"] * 201 + ["side"] * 201
    direction = np.tile(np.where(np.arange(201) <= 100, 1.0, -1.0), 2)
    shape = np.where(np.arange(402) < 201, evaluate(MIDDLE, pressure), evaluate(SIDE, pressure))
    angle = shape - 0.1 * direction
    fits = quartics(pressure, angle, chambers=labels)
    assert [(f.chamber, f.branch) for f in fits] == [
        ("middle", "up"),
        ("middle", "down"),
        ("side", "up"),
        ("side", "down"),
    ]
    for fit in fits:
        truth = np.array(ANGLE_COEFFICIENTS[fit.chamber])
        truth[-1] += -0.1 if fit.branch == "up" else 0.1
        assert fit.rmse < 1e-10
        assert predict(fit, [20.0, 60.0]) == pytest.approx(evaluate(truth, [20.0, 60.0]), abs=1e-9)
    (middle, _) = quartics(pressure, angle, chambers=labels, by_branch=False)
    assert middle.rmse == pytest.approx(0.1, rel=0.02)
    alone = quartic(pressure[:201], angle[:201], branch="down", chamber="middle")
    assert alone.coefficients == fits[1].coefficients


def test_branches_ignore_noise_and_keep_plateaus():
    """A staircase up and down with ±0.5 kPa noise: levels of 10 kPa, turn at 80 kPa.

    By construction the first 8 levels are up; the top level may be split, the rest is down.
    """
    rng = np.random.default_rng(0)
    levels = np.r_[np.arange(10, 81, 10), np.arange(70, 9, -10)]
    pressure = np.repeat(levels, 25) + rng.uniform(-0.5, 0.5, levels.size * 25)
    found = branches(pressure)
    assert np.all(found[: 7 * 25] == 1)
    assert np.all(found[8 * 25 :] == -1)
    assert branches(np.full(5, 3.0)).tolist() == [0] * 5
    assert branches([1.0, np.nan, 2.0]).tolist() == [1, 0, 1]
    assert branches([0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0]).tolist() == [1, 1, 1, 1, -1, -1, 1]


def test_without_noise_every_change_is_a_turn():
    """By construction: with a reversal of 0 the smallest step back is a branch of its own."""
    pressure = [0.0, 1.0, 1.0 - 1e-9, 2.0, 3.0, 2.0]
    assert branches(pressure, reversal_kpa=0.0).tolist() == [1, 1, -1, 1, 1, -1]
    assert branches([3.0, 3.0], reversal_kpa=0.0).tolist() == [0, 0]
    for nothing in (-1.0, float("nan")):
        with pytest.raises(UsageError, match=r"reversal_kpa.*give 0 or more"):
            branches(pressure, reversal_kpa=nothing)


def test_order_four_is_chosen_for_the_papers_curves():
    """The truth is a quartic; over 400 sweeps the rule found it in 386 and never went below.

    At 96 % a run of 40 sweeps finds it fewer than 34 times with probability 0.2 %.
    """
    chosen = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        pressure = _triangle(400) if seed % 2 else np.repeat(LEVELS_KPA, 20)
        angle = evaluate(SIDE, pressure) + rng.normal(0, 0.01, pressure.size)
        choice = choose_order(pressure, angle)
        chosen.append(choice.order)
        assert choice.reason.startswith(f"order {choice.order} ")
    assert min(chosen) == 4
    assert chosen.count(4) >= 34
    assert choice.orders == tuple(range(1, 8))
    assert choice.blocks == 6  # eight ranges of the sweep without the first and the last


def test_a_line_is_chosen_for_a_line():
    """Torque at fixed angle is linear in the pressure (Zhao §5.2.2): order 1 suffices."""
    rng = np.random.default_rng(4)
    pressure = _triangle(300)
    torque = 3.0 + 0.5 * pressure + rng.normal(0, 1.0, 300)
    assert choose_order(pressure, torque).order == 1


def test_held_out_error_is_at_the_noise_and_blocks_are_levels():
    """Interpolating a quartic across one missing level of eight adds little: 1 to 1.5 σ."""
    rng = np.random.default_rng(8)
    pressure = np.repeat(LEVELS_KPA, 50) + rng.normal(0, 0.1, 400)
    fit = quartic(pressure, evaluate(MIDDLE, pressure) + rng.normal(0, 0.02, 400))
    assert fit.held_out_rmse is not None
    assert 0.9 * 0.02 < fit.held_out_rmse < 1.5 * 0.02
    assert level_blocks(pressure).tolist() == np.repeat(np.arange(8), 50).tolist()
    assert np.unique(level_blocks(_triangle(500))).size == 8


def test_extrapolation_is_refused():
    """The message names the range and the value; the ends themselves are inside."""
    fit = quartic(LEVELS_KPA, evaluate(MIDDLE, LEVELS_KPA))
    assert predict(fit, [10.0, 80.0]).shape == (2,)
    with pytest.raises(InputError, match="fitted from 10 to 80 kPa") as caught:
        predict(fit, [50.0, 80.5])
    assert caught.value.value == 80.5


def test_inverse_on_a_monotone_stretch():
    """p → Φ → p on 10–62 kPa of the side chambers; slope ≥ 1e-3 rad/kPa there bounds it to 1e-9."""
    fit = quartic(LEVELS_KPA, evaluate(SIDE, LEVELS_KPA))
    pressure = np.linspace(10.0, 62.0, 53)
    back = inverse(fit, predict(fit, pressure), between_kpa=(10.0, 62.0))
    assert back == pytest.approx(pressure, abs=1e-8)


def test_inverse_is_refused_where_there_is_none():
    """Over the whole range the side curve turns twice; up to 62 kPa it reaches 1.59 rad."""
    fit = quartic(LEVELS_KPA, evaluate(SIDE, LEVELS_KPA))
    with pytest.raises(InputError, match="turns within 10 to 80 kPa") as caught:
        inverse(fit, 1.0)
    assert caught.value.value == pytest.approx([62.77, 68.80], abs=0.005)
    with pytest.raises(InputError, match="the curve reaches"):
        inverse(fit, 1.7, between_kpa=(10.0, 62.0))
    with pytest.raises(InputError, match="not extrapolated"):
        inverse(fit, 1.0, between_kpa=(0.0, 60.0))


def test_inverse_reaches_a_flat_end():
    """y = −(x − 2)² on [0, 2] has slope 0 at its end; √1e-16 of the range is all one can know."""
    x = np.linspace(0.0, 2.0, 9)
    fit = quartic(x, -((x - 2.0) ** 2), order=2)
    assert inverse(fit, [-4.0, -1.0, 0.0]) == pytest.approx([0.0, 1.0, 2.0], abs=1e-6)


def test_requests_that_cannot_be_met():
    """Too few levels, unknown branch, arrays of two lengths, labels of another length."""
    with pytest.raises(IdentificationError, match="4 different pressures"):
        quartic(np.tile([1.0, 2, 3, 4], 3), np.arange(12.0))
    with pytest.raises(IdentificationError, match="too few pressure levels"):
        choose_order([1.0, 1.0, 2.0], [0.0, 0.1, 1.0], orders=(3,))
    with pytest.raises(UsageError, match="no such branch"):
        quartic(LEVELS_KPA, LEVELS_KPA, branch="sideways")
    with pytest.raises(InputError, match="differ in shape"):
        quartic(LEVELS_KPA, LEVELS_KPA[:3])
    with pytest.raises(InputError, match="3 chamber labels for 8 samples"):
        quartics(LEVELS_KPA, LEVELS_KPA, chambers=["a"] * 3)
    with pytest.raises(UsageError, match="no order to try"):
        choose_order(LEVELS_KPA, LEVELS_KPA, orders=())


@pytest.mark.parametrize("output", [[], [np.nan] * 3])
def test_nothing_to_choose_an_order_from(output: list[float]) -> None:
    """No sample, or none that counts, is too few levels."""
    with pytest.raises(IdentificationError, match="too few pressure levels"):
        choose_order([0.0, 1.0, 2.0][: len(output)], output)


def test_the_reason_compares_only_with_orders_that_were_tried() -> None:
    """One order is less than no other, and a tie is no less."""
    line = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], [0.0, 1.2, 1.8, 3.1, 4.0, 5.0]
    alone, tied = choose_order(*line, orders=(1,)), choose_order(*line, orders=(1, 1))
    assert alone.reason.endswith("on levels left out")
    assert tied.reason.endswith("on levels left out, no more than any other order")
    assert choose_order(*line, orders=(0, 1)).reason.endswith(", less than any other order")


def test_of_three_levels_one_is_left_out() -> None:
    """It has no spread, so the order that misses it least is chosen."""
    choice = choose_order([0.0, 1.0, 2.0], [0.0, 1.0, 2.0], orders=(1,))
    assert (choice.order, choice.blocks) == (1, 1)


def test_missing_samples_are_left_out_and_an_exact_fit_is_said_to_be_unchecked():
    """Five levels fix five coefficients with nothing to spare; a NaN in between changes nothing."""
    pressure = np.array([10.0, 20.0, 30.0, 35.0, 40.0, 50.0])
    output = np.array([1.0, 2.0, 3.0, np.nan, 3.5, 3.7])
    fit = quartic(pressure, output)
    assert fit.n == 5
    assert fit.stderr is None
    assert "no-spare-level" in [i.code for i in fit.issues]
