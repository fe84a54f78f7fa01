"""What the input does between its samples: jumps, knots, and the rows that are no samples."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from softid.intersample import BEFORE, Intersample, jumps, knots, lost_intervals
from softid.log import Log
from softid.models import Oscillator
from softid.simulation import simulate

Array = npt.NDArray[np.float64]

TIME_S = np.arange(0.0, 4.0, 0.01)
STEP = np.where(TIME_S < 1.995, 0.0, 100.0)
"""A jump between the samples at 1.99 s and 2.00 s."""


def test_a_step_is_a_jump_and_a_valve_is_none() -> None:
    """By construction: a lag of two samples is seen half way, noise alone never jumps."""
    rng = np.random.default_rng(0)
    assert jumps(STEP).tolist() == [199]
    assert jumps(STEP + rng.normal(0.0, 0.3, STEP.size)).tolist() == [199]
    lagged = 100.0 * -np.expm1(-np.maximum(TIME_S - 1.995, 0.0) / 0.02)
    assert jumps(lagged).size == 0
    assert jumps(100.0 * np.sin(3.0 * TIME_S)).size == 0
    assert jumps(50.0 + rng.normal(0.0, 0.3, STEP.size)).size == 0
    assert jumps(np.array([0.0, 1.0])).size == 0


def test_a_spike_of_one_sample_is_no_step() -> None:
    """A drop-out of the gauge goes and comes back: nothing is flat beside it."""
    spiked = np.zeros(50)
    spiked[20] = 100.0
    assert jumps(spiked).size == 0


def test_knots_lie_just_before_the_jump() -> None:
    """The last level, a thousandth of the interval before the sample that has the next one."""
    knot_s, level = knots(TIME_S, STEP, "held")
    np.testing.assert_allclose(knot_s, [2.0 - BEFORE * 0.01], rtol=0.0, atol=1e-12)
    assert level.tolist() == [0.0]


def test_a_bend_is_followed_by_a_cubic() -> None:
    """A sine of 3 Hz at 50 Hz, sampled irregularly: straight lines take (ωh)²/12 of it."""
    rng = np.random.default_rng(0)
    time_s = 0.02 * np.arange(200) + rng.uniform(-0.004, 0.004, 200)

    def course(at_s: Array) -> Array:
        return 50.0 + 40.0 * np.sin(2.0 * np.pi * 3.0 * at_s)

    knot_s, level = knots(time_s, course(time_s), "smooth")
    assert knot_s.size > 100
    rows_s, rows = np.append(time_s, knot_s), np.append(course(time_s), level)
    order = np.argsort(rows_s)
    fine_s = np.linspace(time_s[0], time_s[-1], 100_001)
    swing = np.exp(-2j * np.pi * 3.0 * fine_s)
    true = abs(np.mean((course(fine_s) - 50.0) * swing))
    cut = abs(np.mean((np.interp(fine_s, time_s, course(time_s)) - 50.0) * swing))
    kept = abs(np.mean((np.interp(fine_s, rows_s[order], rows[order]) - 50.0) * swing))
    assert 1.0 - cut / true == pytest.approx((6.0 * np.pi * 0.02) ** 2 / 12.0, rel=0.15)
    assert abs(kept / true - 1.0) < 0.05 * (1.0 - cut / true)


@pytest.mark.parametrize(("lost_s", "bends"), [(0.05, True), (1.4, False)])
def test_no_cubic_spans_what_was_long_lost(lost_s: float, bends: bool) -> None:
    """The trough of a sine of 1 Hz, read at 100 Hz: lost over 50 ms the slopes beside tell of it,
    over more than a period they lead to three times its height, on the other side."""
    time_s = 0.01 * np.arange(-100, 300)
    time_s = time_s[np.abs(time_s - 0.75) > 0.5 * lost_s]
    knot_s, _ = knots(time_s, np.cos(2.0 * np.pi * (time_s - 0.25)), "smooth")
    assert (np.abs(knot_s - 0.75).min(initial=1.0) < 0.01) == bends


def test_corners_and_noise_do_not_bend() -> None:
    """Nobody knows the course of either between samples; a cubic has its own area."""
    corner = np.maximum(TIME_S - 2.0, 0.0)
    assert knots(TIME_S, corner, "smooth")[0].size == 0
    assert knots(TIME_S, STEP, "smooth")[0].size == 0
    noise = 30.0 * TIME_S + np.random.default_rng(1).normal(0.0, 0.4, TIME_S.size)
    assert knots(TIME_S, noise, "smooth")[0].size < 0.05 * TIME_S.size
    assert knots(TIME_S[:3], np.array([0.0, 1.0, 4.0]), "smooth")[0].size == 0
    time_s = np.array([0.0, 0.9, 2.0, 3.1, 4.0])
    knot_s, level = knots(time_s, time_s**3, "smooth")
    np.testing.assert_allclose(knot_s, [1.45, 2.55])
    for at, height, begin, end in zip(knot_s, level, time_s[1:3], time_s[2:4], strict=True):
        sides = (begin**3 + height) * (at - begin) + (height + end**3) * (end - at)
        assert 0.5 * sides == pytest.approx((end**4 - begin**4) / 4.0, rel=1e-12)


def test_what_is_held_at_its_jumps_may_bend_elsewhere() -> None:
    """Steps, and then a chirp: the knots of both, in order, for the course between jumps is one."""
    u = STEP + np.where(TIME_S > 3.0, 20.0 * np.sin(40.0 * TIME_S), 0.0)
    held_s, held = knots(TIME_S, u, "held")
    bend_s, bend = knots(TIME_S, u, "smooth")
    assert bend_s.size > 50
    assert bend_s.min() > 2.9
    np.testing.assert_allclose(held_s, [2.0 - BEFORE * 0.01, *bend_s], rtol=0.0, atol=1e-12)
    assert held.tolist() == [0.0, *bend]


def test_every_change_of_a_staircase_has_a_knot() -> None:
    """A staircase of five levels changes four times; as straight lines it has no knots."""
    knot_s, level = knots(TIME_S[:5], np.array([0.0, 1.0, 1.0, 3.0, 2.0]), "zoh")
    expected = TIME_S[[1, 3, 4]] - BEFORE * 0.01
    np.testing.assert_allclose(knot_s, expected, rtol=0.0, atol=1e-12)
    assert level.tolist() == [0.0, 1.0, 3.0]
    assert knots(TIME_S, STEP, "straight")[0].size == 0


def test_a_staircase_is_followed_exactly() -> None:
    """A first-order lag behind a sine that is held at every sample, by its exact recursion."""
    u = 50.0 + 50.0 * np.sin(3.0 * TIME_S)
    decay = np.exp(-0.01 / 0.1)
    exact = [u[0]]
    for level in u[:-1]:
        exact.append(level + (exact[-1] - level) * decay)
    log = Log.from_arrays(TIME_S, {"pressure": u, "angle": 0.01 * u}).with_intersample("zoh")
    values = {"M": 0.0, "N": 10.0, "Q": 100.0, "G": 1.0, "offset": 0.0}
    found = simulate(Oscillator(order="first", x_unit="rad", u_unit="kPa"), values, log)
    np.testing.assert_allclose(found.outputs["angle"], 0.01 * np.array(exact), atol=1e-4)


def test_rows_of_a_held_log_are_its_samples_again() -> None:
    """A knot is in the segment, counts in no residual, and is gone in what a user sees."""
    log = Log.from_arrays(TIME_S, {"pressure": STEP, "angle": 0.01 * STEP})
    held = log.with_intersample("held")
    assert log.with_intersample(None) is log
    assert log.with_intersample("straight").segments()[0].is_sample is None
    (segment,) = held.segments()
    assert segment.time_s.size == TIME_S.size + 1
    assert int(segment.used["angle"].sum()) == TIME_S.size
    plain = segment.without_knots()
    np.testing.assert_array_equal(plain.time_s, TIME_S)
    np.testing.assert_array_equal(plain.input, STEP)
    first = segment.part(slice(210)).without_knots()
    np.testing.assert_array_equal(first.time_s, TIME_S[:209])
    (straight,) = log.segments()
    assert straight.without_knots() is straight
    values = {"M": 0.0, "N": 10.0, "Q": 100.0, "G": 1.0, "offset": 0.0}
    model = Oscillator(order="first", x_unit="rad", u_unit="kPa")
    found = simulate(model, values, held)
    assert found.outputs["angle"].shape == TIME_S.shape
    exact = -np.expm1(-np.maximum(TIME_S - 2.0, 0.0) / 0.1)
    np.testing.assert_allclose(found.outputs["angle"], exact, atol=1e-4)
    early = simulate(model, values, log).outputs["angle"] - exact
    assert early.max() > 0.03  # half a sample of 10 ms on a time constant of 100 ms


@pytest.mark.parametrize("intersample", ["held", "zoh"])
def test_a_jump_while_samples_were_lost_is_expected_in_their_middle(
    intersample: Intersample,
) -> None:
    """By construction: its step is at each of four places, as high, and the mean lies half way."""
    lost = (TIME_S > 1.965) & (TIME_S < 1.995)
    time_s, u = TIME_S[~lost], STEP[~lost]
    knot_s, level = knots(time_s, u, intersample)
    assert knot_s.size == 2 * 4 - 1
    course_s = np.concatenate((time_s, knot_s))
    course = np.concatenate((u, level))[np.argsort(course_s)]
    course_s = np.sort(course_s)
    for when, value in ((1.965, 0.0), (1.975, 25.0), (1.985, 50.0), (1.995, 75.0), (2.005, 100.0)):
        assert np.interp(when, course_s, course) == pytest.approx(value, abs=1e-9)


def test_pairs_of_samples_have_few_knots() -> None:
    """Pairs 1 µs apart every 0.4 s: between two pairs a step every 20 ms, a tenth of the mean
    interval, where one every microsecond would make 400,000 of them."""
    first_s = 0.4 * np.arange(100)
    time_s = np.sort(np.concatenate((first_s, first_s + 1e-6)))
    knot_s, level = knots(time_s, np.sin(time_s), "zoh")
    assert knot_s.size == level.size == 100 + 99 * (2 * 20 - 1)


RANDOM = np.random.default_rng(0)


@pytest.mark.parametrize(
    "interval_s",
    [RANDOM.uniform(0.1, 2.0, 400), RANDOM.exponential(1.0, 400)],
    ids=["uniform", "random times"],
)
def test_an_irregular_clock_has_lost_nothing(interval_s: np.ndarray) -> None:
    """Written when it changes: intervals are of all lengths, and it is held over each."""
    time_s = np.cumsum(interval_s)
    u = np.arange(time_s.size) % 7.0
    assert lost_intervals(time_s).size == 0
    knot_s, level = knots(time_s, u, "zoh")
    assert np.array_equal(level, u[:-1])
    assert np.allclose(knot_s, time_s[1:], atol=1e-2)
