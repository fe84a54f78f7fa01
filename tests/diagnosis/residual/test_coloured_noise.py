"""Slow noise where no rest shows it, and misfits that are none."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from noise import coloured
from scipy.signal import lfilter

from softid.diagnosis.residual.coloured_noise import (
    CHANCE_SHARE,
    LEAST_SQUARE,
    ColourTest,
    _activities,
    _p_of_white,
    _runs,
    colour_test,
)
from softid.diagnosis.residual.structure import ResidualContext, _folds, _Smooth, _standardised
from softid.diagnosis_results import NotNoise

Array = npt.NDArray[np.float64]

MOTION_S, RATE_HZ, LENGTH_S = 0.2, 100.0, 48.0
DRAWS = 16
TIME_S = np.arange(0.0, LENGTH_S, 1.0 / RATE_HZ)


def slow_noise(rng: np.random.Generator, time_s: float) -> Array:
    """Noise that correlates by 1/e after that time."""
    return coloured(rng, TIME_S.size, time_s, 1.0 / RATE_HZ)


def steps(rng: np.random.Generator) -> Array:
    """A level every two seconds."""
    levels = rng.uniform(0.0, 100.0, round(LENGTH_S / 2.0))
    return np.repeat(levels, TIME_S.size // levels.size)


def lagging(u: Array, time_s: float) -> Array:
    """The input behind a lag."""
    kept = np.exp(-1.0 / (RATE_HZ * time_s))
    found: Array = lfilter([1.0 - kept], [1.0, -kept], u - u[0]) + u[0]
    return found


def found_in(residual: Array, u: Array, *slopes: Array) -> ColourTest:
    x = lagging(u, MOTION_S)
    part = ResidualContext(TIME_S, x, np.gradient(x, TIME_S), u, residual)
    return colour_test([part], MOTION_S, slopes=slopes, rng=np.random.default_rng(0))


@pytest.mark.parametrize("white", [0.1, 0.5])
@pytest.mark.parametrize("time_s", [0.3, 1.0])
def test_slow_noise_is_told(white: float, time_s: float) -> None:
    """Known truth: whiteness is asked once at 1e-4, normality and size on four widths.

    A size must follow from the motion by more than chance does in one of 10,000 logs. The
    correlation time is known to about √(2τ/T), a fifth for 1 s in 48 s, in the median.
    """
    told = []
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        u = steps(rng)
        noise = (1.0 - white) ** 0.5 * slow_noise(rng, time_s)
        noise += white**0.5 * rng.standard_normal(TIME_S.size)
        told.append(found_in(noise, u))
    times = [found.correlation_s for found in told if found.correlation_s is not None]
    assert len(times) >= 0.9 * DRAWS
    assert np.median(times) == pytest.approx(time_s, rel=0.3)


@pytest.mark.parametrize("white", [0.0, 0.3])
@pytest.mark.parametrize("time_s", [0.014, 0.045])
def test_noise_that_the_means_forget_is_told(white: float, time_s: float) -> None:
    """Known truth: means of a quarter of a second and less are white, with no time of their own.

    Two coefficients that nearly cancel have a time of seconds, which is none of the noise's.
    """
    told = []
    for seed in range(1000, 1000 + DRAWS):
        rng = np.random.default_rng(seed)
        u = steps(rng)
        noise = (1.0 - white) ** 0.5 * slow_noise(rng, time_s)
        told.append(found_in(noise + white**0.5 * rng.standard_normal(TIME_S.size), u))
    times = [found.correlation_s for found in told if found.correlation_s is not None]
    assert len(times) >= 0.9 * DRAWS
    assert np.median(times) <= 0.1


def test_what_is_forgotten_sooner_than_a_motion_is_brief() -> None:
    """Known truth: noise of 6 ms beside a motion of 0.2 s; a misfit lasts as long as the motion."""
    rng = np.random.default_rng(7)
    u = steps(rng)
    assert found_in(slow_noise(rng, 0.006), u).is_brief
    for misfit in (lagging(u, 0.3) - lagging(u, 0.2), np.abs(lagging(u, 0.2) - 50.0)):
        rows = 0.5 * (misfit - misfit.mean()) / misfit.std() + rng.standard_normal(u.size)
        assert not found_in(rows, u).is_brief


MISFITS = {
    "a lag that is not modelled": lambda u: lagging(u, 0.3) - lagging(u, 0.2),
    "a creep that is not modelled": lambda u: lagging(u, 1.5) - u.mean(),
    "a curve that is bent": lambda u: np.abs(lagging(u, 0.2) - 50.0),
    "a sine on the output": lambda u: np.sin(2.0 * np.pi * 0.5 * TIME_S),
}


@pytest.mark.parametrize("slow", [0.0, 0.5])
@pytest.mark.parametrize("kind", MISFITS)
def test_a_misfit_is_no_slow_noise(kind: str, slow: float) -> None:
    """Known truth: white noise of 1, and a misfit of 2 rms that the motion or a line brings.

    Slow noise of half the misfit's power beside it hides none.
    """
    taken = 0
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        u = steps(rng)
        misfit = MISFITS[kind](u)
        rows = 2.0 * (misfit - misfit.mean()) / misfit.std()
        rows += rng.standard_normal(u.size) + slow**0.5 * 2.0 * slow_noise(rng, 1.0)
        taken += found_in(rows, u).correlation_s is not None
    assert taken <= 1


MARKS = {
    NotNoise.GROWS_WITH_SPEED: lambda u, rng: (
        (lagging(u, 0.3) - lagging(u, 0.2)) * np.sign(rng.standard_normal(u.size))
    ),
    NotNoise.STRAYS: lambda u, rng: 9.0 * (np.abs(TIME_S - 10.0) < 0.2),
    NotNoise.SPECTRUM: lambda u, rng: np.sin(2.0 * np.pi * 0.5 * TIME_S),
}


@pytest.mark.parametrize("mark", MARKS)
def test_what_speaks_against_noise_is_told(mark: NotNoise) -> None:
    """Known truth: white noise that is loud where the motion is quick, one bump, one line."""
    rng = np.random.default_rng(11)
    u = steps(rng)
    rows = MARKS[mark](u, rng)
    rows = 2.0 * rows / rows.std() + 0.3 * rng.standard_normal(u.size)
    assert found_in(rows, u) == ColourTest(against=mark)


def test_errors_of_the_parameters_are_no_misfit() -> None:
    """Known truth: an error of one parameter is no noise by itself, and is one beside its slope."""
    rng = np.random.default_rng(4)
    u = steps(rng)
    slope = lagging(u, 0.3) - lagging(u, 0.2)
    noise = slow_noise(rng, 1.0) + 0.3 * rng.standard_normal(u.size)
    rows = noise + slope / slope.std()
    assert found_in(rows, u).against is not None
    assert found_in(rows, u, slope[:, None]).correlation_s is not None


def test_what_is_slower_than_colour_is_left_to_others() -> None:
    """A wander of 20 s is as good as a drift: not taken for noise in more than a few draws."""
    taken = 0
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        u = steps(rng)
        rows = slow_noise(rng, 20.0) + 0.1 * rng.standard_normal(u.size)
        taken += found_in(rows, u).correlation_s is not None
    assert taken <= 0.1 * DRAWS


def test_a_size_follows_by_chance_in_one_of_ten_thousand_logs() -> None:
    """Known truth: normal innovations, whose size follows from nothing. Of 60,000 draws 6 are meant
    to lie beyond; none, or more than 18, would be another level."""
    rng = np.random.default_rng(0)
    u = steps(rng)
    x = lagging(u, MOTION_S)
    part = ResidualContext(TIME_S, x, np.gradient(x, TIME_S), u, np.zeros(u.size))
    (run,) = _runs(part, np.empty((u.size, 0)), _activities([part])[0], 0.24)
    smooth = _Smooth(_standardised(run.activity), _folds([run.time_s]))
    beyond = 0
    for _ in range(3):
        sizes = np.log(rng.standard_normal((run.time_s.size, 20_000)) ** 2 + LEAST_SQUARE)
        (shares,) = smooth.predicted_shares(sizes - sizes.mean(axis=0))
        beyond += int(np.sum(shares > CHANCE_SHARE / run.time_s.size))
    assert 1 <= beyond <= 18


def test_white_runs_are_white_however_short_they_are() -> None:
    """Closed form: nothing was fitted, so that P(χ² of 20 > 28.87) = 9 % lie below 0.05."""
    rng = np.random.default_rng(0)
    for count in (2, 20):
        p = [_p_of_white(np.split(rng.standard_normal(400), count)) for _ in range(400)]
        assert 0.05 < np.mean(np.array(p) < 0.05) < 0.13


def test_quick_motion_and_a_log_at_rest_beside_it() -> None:
    """Noise is told where means are of few samples, and where one log has a constant input."""
    taken = 0
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        parts = []
        for u in (steps(rng), np.full(TIME_S.size, 50.0)):
            x = lagging(u, 0.05)
            rows = slow_noise(rng, 0.5) + 0.3 * rng.standard_normal(TIME_S.size)
            parts.append(ResidualContext(TIME_S, x, np.gradient(x, TIME_S), u, rows))
        taken += colour_test(parts, 0.05, rng=rng).correlation_s is not None
    assert taken >= DRAWS - 2


def test_too_few_samples_tell_nothing() -> None:
    """Closed form: 150 samples make no 200 means."""
    rng = np.random.default_rng(0)
    time_s = TIME_S[:150]
    rows = slow_noise(rng, 1.0)[:150]
    part = ResidualContext(time_s, time_s, np.ones(150), time_s, rows)
    assert colour_test([part], MOTION_S, rng=rng) == ColourTest()


def test_noise_of_pairs_of_samples_is_told() -> None:
    """Every second sample 1 µs before the next: means over median intervals would be 20,000 times
    as many as the samples, and none of them has another beside it."""
    rng = np.random.default_rng(3)
    rows = slow_noise(rng, 0.5) + 0.3 * rng.standard_normal(TIME_S.size)
    u = steps(rng)
    x, v = lagging(u, MOTION_S), np.gradient(lagging(u, MOTION_S), TIME_S)
    time_s = TIME_S.copy()
    time_s[::2] = time_s[1::2] - 1e-6
    found = colour_test([ResidualContext(time_s, x, v, u, rows)], MOTION_S, rng=rng)
    assert found.correlation_s == pytest.approx(0.5, rel=0.5)


def test_lost_samples_and_several_logs() -> None:
    """Blanks end a run of means; noise of two logs is told as that of one."""
    rng = np.random.default_rng(3)
    parts = []
    for _ in range(2):
        rows = slow_noise(rng, 0.5) + 0.3 * rng.standard_normal(TIME_S.size)
        rows[1000:1100] = np.nan
        rows[rng.random(rows.size) < 0.05] = np.nan
        u = steps(rng)
        x = lagging(u, MOTION_S)
        parts.append(ResidualContext(TIME_S, x, np.gradient(x, TIME_S), u, rows))
    found = colour_test(parts, MOTION_S, rng=rng)
    assert found.correlation_s == pytest.approx(0.5, rel=0.5)


def two_logs(rng: np.random.Generator, *residuals: Array) -> ColourTest:
    """Residuals of logs with steps of their own."""
    parts = []
    for rows in residuals:
        u = steps(rng)
        x = lagging(u, MOTION_S)
        parts.append(ResidualContext(TIME_S, x, np.gradient(x, TIME_S), u, rows))
    return colour_test(parts, MOTION_S, rng=rng)


@pytest.mark.parametrize(
    "ratio", [2.0, *(pytest.param(ratio, marks=pytest.mark.slow) for ratio in (1.0, 1.6, 5.0))]
)
def test_one_log_may_be_louder_than_another(ratio: float) -> None:
    """Known truth: two logs of slow noise. Together their innovations are a mixture of two normal
    laws, whose kurtosis is no normal one; each by itself is.

    As for one log, all but some of the draws are told: 0.9 of them, and one more may be missed.
    """
    told = 0
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        found = two_logs(rng, slow_noise(rng, 0.5), ratio * slow_noise(rng, 0.5))
        told += found.correlation_s is not None
    assert told >= 0.9 * DRAWS - 1


@pytest.mark.parametrize("size", [pytest.param(1.0, marks=pytest.mark.slow), 6.0])
@pytest.mark.parametrize("kind", MISFITS)
def test_a_misfit_in_one_log_does_not_pass_beside_noise_in_another(kind: str, size: float) -> None:
    """Known truth: slow noise in one log and, in the other, a misfit of twice the white noise, as
    loud as the first log or six times louder."""
    taken = 0
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        u = steps(rng)
        x = lagging(u, MOTION_S)
        misfit = MISFITS[kind](u)
        rows = 2.0 * (misfit - misfit.mean()) / misfit.std() + rng.standard_normal(u.size)
        quiet = ResidualContext(TIME_S, x, np.gradient(x, TIME_S), u, slow_noise(rng, 0.5))
        parts = [quiet, ResidualContext(TIME_S, x, np.gradient(x, TIME_S), u, size * rows)]
        taken += colour_test(parts, MOTION_S, rng=rng).correlation_s is not None
    assert taken <= 1
