"""The noise of an output without the motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from noise import ar1

from softid.diagnosis.residual.noise_floor import (
    NoiseFloor,
    _without_events,
    fastest_part,
    input_span,
    noise_floor,
    of_single_samples,
    rest_spans,
    still_spans,
)
from softid.diagnosis.residual.structure import ResidualContext

Array = npt.NDArray[np.float64]

PERIOD_S = 0.02
MOTION_S = 0.2
SEEDS = range(20)


def with_rests() -> tuple[Array, Array]:
    """Two rests of 40 s with a sine of 20 s between them."""
    time_s = PERIOD_S * np.arange(5000)
    moving = (time_s >= 40.0) & (time_s < 60.0)
    return time_s, np.where(moving, 50.0 * np.sin(time_s), 0.0)


def floor_of(
    residual: Array,
    u: Array,
    time_s: Array,
    *,
    motion_s: float = MOTION_S,
    begins_at_rest: bool = False,
) -> NoiseFloor:
    still = np.zeros(time_s.size)
    part = ResidualContext(time_s, still, still, u, residual, begins_at_rest)
    return noise_floor([part], motion_s)


def at_rest(seed: int, phi: float) -> NoiseFloor:
    """The floor of noise on which, while the input moves, a large misfit stands."""
    time_s, u = with_rests()
    residual = ar1(np.random.default_rng(seed), time_s.size, phi) + u
    return floor_of(residual, u, time_s)


@pytest.mark.parametrize("phi", [0.0, 0.8, 0.95])
def test_rests_tell_the_variance_as_well_as_they_say(phi: float) -> None:
    """Known truth, 1: over 20 seeds the errors are as large as stated, and fair.

    In units of the stated standard deviation their root mean square is 1 ± 0.16 for 20 draws,
    of which three times is allowed, and the mean is 0 ± 0.22, of which four times is.
    """
    floors = [at_rest(seed, phi) for seed in SEEDS]
    assert all(floor.from_rest for floor in floors)
    off = np.array([(floor.variance - 1.0) / floor.relative_sd for floor in floors])
    assert 0.5 < np.sqrt(np.mean(off**2)) < 1.5
    assert abs(float(np.mean(off))) < 0.9


def test_a_rest_of_sixteen_seconds_tells_noise_of_one_second() -> None:
    """Noise alone is seldom taken for more than the noise of its rest, as far as that is known.

    Stands on three standard deviations. A variance from some ten independent samples is skew, so
    that more than the normal 0.1 % go beyond: of 60 at most three may.
    """
    time_s = PERIOD_S * np.arange(2350)
    u = np.where(time_s >= 17.0, 50.0 * np.sin(time_s), 0.0)
    beyond = 0
    for seed in range(60):
        noise = ar1(np.random.default_rng(seed), time_s.size, 0.98)
        floor = floor_of(noise, u, time_s)
        assert floor.from_rest
        beyond += np.mean(noise**2) > floor.variance * (1.15 + 3.0 * floor.relative_sd)
    assert beyond <= 3
    short = floor_of(noise[250:], u[250:], time_s[250:])
    assert not short.from_rest


def test_a_push_during_a_rest_is_no_noise() -> None:
    """The same with and without a push of 1.6 s, 20 times the noise, in one rest."""
    time_s, u = with_rests()
    push = np.where((time_s > 12.0) & (time_s < 13.6), 20.0, 0.0)
    residual = ar1(np.random.default_rng(3), time_s.size, 0.95)
    quiet = floor_of(residual, u, time_s)
    pushed = floor_of(residual + push, u, time_s)
    assert pushed.from_rest
    assert pushed.variance == pytest.approx(quiet.variance, rel=3.0 * quiet.relative_sd)


def test_colour_is_paid_for() -> None:
    """Closed form: the samples count as for a mean, fewer by (1 + φ)/(1 − φ) = 9 for φ = 0.8.

    For a variance they are fewer by (1 + φ²)/(1 − φ²) = 4.6 only, so the error is never too small.
    """
    white, slow = at_rest(0, 0.0), at_rest(0, 0.8)
    assert slow.relative_sd / white.relative_sd == pytest.approx(3.0, rel=0.15)


@pytest.mark.parametrize(
    ("still_s", "from_rest"), [(16.0 + 5.0 * MOTION_S, True), (14.0 + 5.0 * MOTION_S, False)]
)
def test_a_rest_is_long_and_settled(still_s: float, from_rest: bool) -> None:
    """Fifteen seconds must be left after five time constants in which the motion dies out."""
    time_s = PERIOD_S * np.arange(4000)
    u = np.where(time_s < 40.0, 50.0 * np.sin(time_s), 0.0)
    u = np.where(time_s >= 40.0 + still_s, 50.0 * np.sin(time_s), u)
    residual = np.random.default_rng(0).standard_normal(time_s.size)
    assert floor_of(residual, u, time_s).from_rest is from_rest


def test_the_zero_of_a_rest_does_not_count() -> None:
    """Each rest has its own level: a static misfit is no noise."""
    time_s, u = with_rests()
    noise = np.random.default_rng(1).standard_normal(time_s.size)
    level = np.where(time_s < 50.0, 100.0, -30.0)
    moved = floor_of(noise + level, u, time_s)
    plain = floor_of(noise, u, time_s)
    assert moved.variance == pytest.approx(plain.variance, rel=1e-6)


def test_without_a_rest_the_fastest_part_tells_it() -> None:
    """Closed form: second differences of white noise have the variance 6σ²; smooth motion none.

    Over 20 seeds, with the stated standard deviation, as above.
    """
    time_s = PERIOD_S * np.arange(3000)
    u = 50.0 * np.sin(time_s)
    off = []
    for seed in SEEDS:
        residual = 2.0 * np.random.default_rng(seed).standard_normal(time_s.size)
        floor = floor_of(residual + u, u, time_s)
        assert not floor.from_rest
        off.append((floor.variance / 4.0 - 1.0) / floor.relative_sd)
    assert 0.4 < np.sqrt(np.mean(np.square(off))) < 1.6
    assert abs(float(np.mean(off))) < 0.9


def test_outliers_add_to_the_noise_of_single_samples() -> None:
    """Closed form: 1, −2, 1 of one sample has six times its square, as white noise has; of four
    alike in a row two steps are left, four times the square for four of them."""
    single, row = np.zeros(1000), np.zeros(1000)
    single[500], row[500:504] = 3.0, 3.0
    assert of_single_samples([single]) == pytest.approx(9.0 / 998)
    assert of_single_samples([row]) == pytest.approx(4.0 * 9.0 / 6.0 / 998)
    assert fastest_part([single]).variance == 0.0


def test_gaps_are_not_differences() -> None:
    """A step that lies between two used stretches is no noise, at rest or not."""
    time_s = PERIOD_S * np.arange(3000)
    u = 50.0 * np.sin(time_s)
    residual = 0.1 * np.random.default_rng(0).standard_normal(time_s.size)
    residual[::7] = np.nan
    residual += np.where(np.cumsum(np.isnan(residual)) % 2 == 0, 0.0, 50.0)
    floor = floor_of(residual, u, time_s)
    assert floor.variance == pytest.approx(0.01, rel=0.2)


@pytest.mark.parametrize("rested", [False, True])
def test_noise_that_grows_with_the_reading(rested: bool) -> None:
    """Its mean square over the whole log, not that of its usual or its resting part.

    Noise at rest has a tenth of its size at the largest reading. A tenth is allowed where all of
    5,000 samples move: their mean square is off by 3 %, the floor by 3 %, and its quantile by
    another 3 %, for the size changes within its blocks, too; twice that where a fifth of them do.
    """
    time_s, u = with_rests()
    if not rested:
        u = 50.0 * np.sin(time_s)
    size = 0.1 + np.abs(u) / 50.0
    for seed in SEEDS:
        noise = size * np.random.default_rng(seed).standard_normal(time_s.size)
        floor = floor_of(noise, u, time_s)
        assert floor.from_rest == rested
        assert floor.variance == pytest.approx(float(np.mean(noise**2)), rel=0.2 if rested else 0.1)


def test_white_noise_is_told_fairly() -> None:
    """Within 1.5 % of its variance, in 6,000 blocks whose quantiles are uncertain by 40 % each."""
    time_s = PERIOD_S * np.arange(200_000)
    u = 50.0 * np.sin(time_s)
    noise = np.random.default_rng(6).standard_normal(time_s.size)
    floor = floor_of(noise, u, time_s)
    assert floor.variance == pytest.approx(float(np.mean(noise**2)), rel=0.015)


def test_a_rest_without_a_measured_sample_tells_nothing() -> None:
    """Of two rests one is lost: the other one tells the noise; with both lost its fastest part."""
    time_s, u = with_rests()
    residual = ar1(np.random.default_rng(3), time_s.size, 0.8)
    whole = floor_of(residual, u, time_s)
    residual[time_s >= 60.0] = np.nan
    one = floor_of(residual, u, time_s)
    assert one.from_rest
    assert one.relative_sd == pytest.approx(2.0**0.5 * whole.relative_sd, rel=0.2)
    residual[time_s < 40.0] = np.nan
    assert not floor_of(residual, u, time_s).from_rest


def test_what_lies_on_both_sides_of_a_gap_is_not_joined() -> None:
    """A piece of 4 s without a sample stays: two runs, and no neighbours across the gap."""
    time_s = PERIOD_S * np.arange(2000)
    residual = np.random.default_rng(0).standard_normal(time_s.size)
    residual[(time_s > 16.0) & (time_s < 21.0)] = np.nan
    rest = _without_events(residual, time_s)
    assert rest.size == residual.size
    assert np.array_equal(np.isnan(rest), np.isnan(residual))


@pytest.mark.parametrize(
    ("begins_at_rest", "begin", "from_rest"),
    [(True, 0, True), (False, 0, False), (True, 250, False)],
)
def test_a_motion_that_begins_at_rest_need_not_die_out(
    begins_at_rest: bool, begin: int, from_rest: bool
) -> None:
    """However slow it is: a time constant of 100 s leaves nothing of a rest of 40 s, unless it is
    the first and nothing has moved before. By hand, one that begins 5 s after a move is no such."""
    time_s, u = with_rests()
    noise = np.random.default_rng(3).standard_normal(time_s.size)
    u = np.where(np.arange(time_s.size) < begin, 50.0, u)
    floor = floor_of(noise, u, time_s, motion_s=100.0, begins_at_rest=begins_at_rest)
    assert floor.from_rest is from_rest


def context(time_s: Array, u: Array) -> ResidualContext:
    still = np.zeros(time_s.size)
    return ResidualContext(time_s, still, still, u, still)


@pytest.mark.parametrize("rate_hz", [50.0, 100.0, 1000.0])
def test_noise_of_the_gauge_ends_no_rest(rate_hz: float) -> None:
    """A rest of 40 s beside steps of 100 kPa, with noise of 1 % of them: the range of 500 samples
    is six deviations, of which four are allowed; the median of 25 is off by a quarter of one. All
    but the dying motion and a piece at each end is found, over 20 seeds."""
    time_s = np.arange(0.0, 80.0, 1.0 / rate_hz)
    course = np.where(time_s < 40.0, 100.0 * (time_s % 4.0 < 2.0), 0.0)
    for seed in SEEDS:
        u = course + np.random.default_rng(seed).standard_normal(time_s.size)
        (rest,) = rest_spans(context(time_s, u), MOTION_S, float(np.ptp(course)))
        assert time_s[rest.start] <= 40.0 + 5.0 * MOTION_S + 0.51
        assert time_s[rest.stop - 1] > 79.4


def test_a_log_that_is_one_rest_moves_by_the_noise_of_its_gauge_alone() -> None:
    """60 s with 0.05 kPa of it beside a log with steps of 100 kPa: 5 time constants are left out.

    By itself it would be as good as any motion.
    """
    time_s = np.arange(0.0, 60.0, 0.01)
    noise = 0.05 * np.random.default_rng(0).standard_normal(time_s.size)
    steps = context(time_s, 100.0 * (time_s % 4.0 < 2.0) + noise)
    rest = context(time_s, 30.0 + noise)
    span = input_span([steps, rest])
    assert rest_spans(rest, MOTION_S, span) == (slice(100, 6000),)
    assert rest_spans(steps, MOTION_S, span) == ()
    quiet = noise_floor([steps, replace(rest, residual=noise)], MOTION_S)
    assert quiet.from_rest


def test_a_spike_is_no_motion_and_a_pulse_is_one() -> None:
    """One or two samples of a piece of fifty, or fifteen of them: 0.15 s of a valve that opens."""
    time_s = np.arange(0.0, 40.0, 0.01)
    for samples, count in ((1, 1), (2, 1), (15, 2)):
        u = np.zeros(time_s.size)
        u[2010 : 2010 + samples] = 100.0
        assert len(still_spans(u, time_s, 2.0)) == count


def test_a_slow_ramp_moves_when_it_has_gone_further_than_the_tolerance() -> None:
    """Of 0.1 kPa/s: 2 kPa are gone after 20 s, and as far again after 20 s more, under noise of a
    quarter of that, by which the median of a piece is off by 1 s; the largest of several decides,
    and a piece is lost. What swings about one level by twice as much does not rest."""
    time_s = np.arange(0.0, 60.0, 0.01)
    noise = 0.5 * np.random.default_rng(0).standard_normal(time_s.size)
    spans = still_spans(0.1 * time_s + noise, time_s, 2.0)
    lengths = [time_s[span.stop - 1] - time_s[span.start] for span in spans]
    assert lengths[:2] == pytest.approx([20.0, 20.0], abs=4.0)
    swinging = 4.0 * np.sin(2.0 * np.pi * 7.0 * time_s)
    assert still_spans(swinging + noise, time_s, 2.0) == ()


@pytest.mark.parametrize(
    ("phi", "rate", "variance"),
    [(0.0, 0.3, 1.0), (0.0, -0.3, 1.0), (0.98, 0.3, None)],
    ids=["rising", "falling", "in slow noise"],
)
def test_a_straight_drift_is_no_noise(phi: float, rate: float, variance: float | None) -> None:
    """Known truth: beside white noise of variance 1 the rests drift by 12. In slow noise, which
    wanders as far, a drift cannot be told from it and stays."""
    time_s, u = with_rests()
    for seed in SEEDS:
        noise = ar1(np.random.default_rng(seed), time_s.size, phi) + rate * time_s
        floor = floor_of(noise, u, time_s)
        if variance is None:
            assert floor.variance > 5.0
        else:
            assert abs(floor.variance - variance) < 4.0 * floor.relative_sd


def test_what_wanders_is_noise_though_a_line_takes_most_of_it() -> None:
    """Stands on the definition: a random walk is slow noise, and more than its fastest part."""
    time_s, u = with_rests()
    for seed in SEEDS:
        steps = np.random.default_rng(seed).standard_normal((2, time_s.size))
        walk = np.cumsum(0.1 * steps[0]) + steps[1]
        assert floor_of(walk, u, time_s).variance > 1.5
