"""Averages of logs that are sampled far faster than anything moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import TRUTH, linear_problem
from scipy import signal

from softid.diagnosis.logs.decimation import (
    ENOUGH,
    SAMPLES_PER_MOTION,
    decimated,
    read_as,
    samples_to_average,
)
from softid.identification.issues import extrapolation, fitted_range
from softid.intersample import Intersample
from softid.log import Log, LogSet


def regular(samples: int, period_s: float = 0.001, name: str = "log") -> Log:
    time_s = period_s * np.arange(samples)
    return Log.from_arrays(time_s, {"pressure": time_s, "angle": 2.0 * time_s}, name=name)


@pytest.mark.parametrize(
    ("samples", "motion_s", "count"),
    [
        (ENOUGH, 100.0, 1),
        (ENOUGH + 1, 100.0, 2),
        (10 * ENOUGH, 100.0, 10),
        (10 * ENOUGH, 4.5 * SAMPLES_PER_MOTION * 0.001, 4),
        (10 * ENOUGH, 0.9 * SAMPLES_PER_MOTION * 0.001, 1),
    ],
)
def test_how_many_samples_a_mean_holds(samples: int, motion_s: float, count: int) -> None:
    """Stands on the two limits: 6000 samples stay in all, and 30 in a time constant."""
    assert samples_to_average([regular(samples)], motion_s) == count


def test_logs_count_together_and_the_slowest_sets_the_limit() -> None:
    """Two logs of 6000 samples are 12000; 30 samples of 2 ms in 0.09 s leave a mean of 1.5."""
    fast, slow = regular(ENOUGH, name="fast"), regular(ENOUGH, 0.002, name="slow")
    assert samples_to_average([fast, slow], 100.0) == 2
    assert samples_to_average([fast, slow], 0.09) == 1


def test_bursts_are_left_alone() -> None:
    """A clock that trembles or loses rows is averaged; one that stands still after every second
    row is not, whatever its median interval."""
    even = regular(10 * ENOUGH)
    rng = np.random.default_rng(2)
    trembling = even.time_s + 0.0004 * rng.uniform(-1.0, 1.0, len(even))
    losing = even.time_s[rng.random(len(even)) > 0.05]
    bursts = even.time_s + 0.01 * (np.arange(len(even)) // 2)
    for time_s, count in ((trembling, 10), (losing, 10), (bursts, 1)):
        log = Log.from_arrays(time_s, {"pressure": time_s, "angle": time_s})
        assert samples_to_average([log], 100.0) == count


def test_means_by_hand() -> None:
    """Two groups of three and one sample over: times, values and masks worked out by hand.

    Half an interval before and behind a group belongs to it: (0.5 (0.5 + 1) + 1.5 + 4 + 0.5 (6 +
    4.5))/(2 · 3) and so on. Of the second group the angle at 0.3 s and 0.5 s is known.
    """
    log = Log.from_arrays(
        [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
        {"pressure": [1, 2, 6, 0, 0, 3, 9], "angle": [0, 3, 6, 1, 7, 2, 9]},
    ).with_masked([False, False, False, False, True, False, True])
    short = decimated(log, 3)
    assert short.time_s == pytest.approx([0.1, 0.4])
    first = (0.5 * 0.75 + 1.5 + 4.0 + 0.5 * 4.5) / 3.0
    second = (0.5 * 1.5 + 0.0 + 1.5 + 0.5 * 4.5) / 3.0
    assert short.pressure_kpa == pytest.approx([first, second])
    assert short.channels["angle"].values.tolist() == [3.0, 1.5]
    assert short.masked is not None
    assert short.masked.tolist() == [False, False]
    assert (short.name, short.input, short.outputs) == (log.name, log.input, log.outputs)


def test_a_group_that_is_half_missing_does_not_count() -> None:
    """Nor one of which half is masked; of more than half the others are the mean."""
    angle = [1.0, np.nan, 2.0, 4.0]
    log = Log.from_arrays([0.0, 0.1, 0.2, 0.3], {"pressure": [1, 2, 3, 4], "angle": angle})
    (masked,) = decimated(log.with_masked([False, False, True, False]), 2).segments()
    assert masked.used["angle"].tolist() == [False, False]
    (segment,) = decimated(log, 2).segments()
    assert segment.used["angle"].tolist() == [False, True]
    assert segment.outputs["angle"][1] == 3.0


def test_a_straight_line_passes_unchanged() -> None:
    """Closed form: the mean of a straight line over a group is the line at the mean time."""
    log = regular(1000)
    short = decimated(log, 7)
    assert len(short) == 142
    assert short.pressure_kpa == pytest.approx(short.time_s)
    assert short.channels["angle"].values == pytest.approx(2.0 * short.time_s)


@pytest.mark.parametrize("clock", ["trembling", "losing", "stalling"])
def test_an_uneven_clock_leaves_no_more_than_an_even_one(clock: str) -> None:
    """Stands on lsim at the samples: the response to the averages is that of the motion, to 2e-3 of
    its range; a sample taken for its neighbour is off by up to 0.02 of it.

    Behind a stall a segment begins of its own, as in the log.
    """
    log = moved("straight")
    rng = np.random.default_rng(4)
    fine_s = 0.0005 * np.arange(120_000)
    pressure = np.interp(fine_s, log.time_s, log.pressure_kpa)
    system = ([1.0], [TRUTH["M"], TRUTH["N"], TRUTH["Q"]])
    angle = signal.lsim(system, pressure, fine_s)[1]
    rows = 20 * np.arange(6000)
    if clock == "trembling":
        rows = rows + rng.integers(-9, 10, 6000)
        rows[0] = 0
    elif clock == "losing":
        rows = rows[rng.random(6000) > 0.1]
    else:
        rows = rows[(rows < 50_000) | (rows > 53_000)]
    channels = {"pressure": pressure[rows], "angle": angle[rows]}
    uneven = Log.from_arrays(fine_s[rows], channels, outputs=("angle",))
    short = decimated(uneven, 5, keeps_jumps=True)
    assert len(short.segments()) == len(uneven.segments()) == (2 if clock == "stalling" else 1)
    problem = linear_problem([short])
    z = problem.unknowns(TRUTH)
    parts = [block.residual[100:] for block in problem.blocks(z, derivatives=False)]
    spread = np.ptp(angle)
    assert max(float(np.std(part)) for part in parts) < 2e-3 * spread
    if clock == "stalling":
        assert len(short) < 1200 - 25


def test_white_noise_falls_with_the_root_of_the_count() -> None:
    """Closed form σ √((26² + 2)/24²)/√9 for an output: the weights −1, 26 and −1 of 24 on means.

    Within four standard errors of a standard deviation of 4000 values.
    """
    noise = np.random.default_rng(5).standard_normal(36000)
    time_s = 0.001 * np.arange(noise.size)
    log = Log.from_arrays(time_s, {"pressure": time_s, "angle": noise})
    found = float(np.std(decimated(log, 9).channels["angle"].values))
    assert found == pytest.approx(np.sqrt(678.0) / 72.0, rel=4.0 / np.sqrt(2.0 * 4000.0))


@pytest.mark.parametrize("hertz", [1.0, 2.0, 4.0])
def test_what_bends_within_a_mean_is_not_lost(hertz: float) -> None:
    """A sine under means over 50 ms: an output errs by 3 (π f T)⁴/40, where its mean errs by
    (π f T)²/6; the straight line through the new inputs has the means sin(π f T)/(π f T) of the
    sine, but for the (2 π f h)²/12 that straight lines between the old ones take from it."""
    count, period_s = 50, 0.001
    time_s = period_s * np.arange(20_000)
    wave = np.sin(2.0 * np.pi * hertz * time_s)
    short = decimated(Log.from_arrays(time_s, {"pressure": wave, "angle": wave}), count)
    exact = np.sin(2.0 * np.pi * hertz * short.time_s)
    phase = np.pi * hertz * count * period_s
    off = short.channels["angle"].values[1:-1] - exact[1:-1]
    assert np.max(np.abs(off)) < 3.0 * phase**4 / 40.0 + 1e-3 * phase**2
    assert 3.0 * phase**4 / 40.0 < 0.5 * phase**2 / 6.0
    u = short.channels["pressure"].values
    means = (u[:-2] + 6.0 * u[1:-1] + u[2:]) / 8.0
    whole = exact[1:-1] * np.sin(phase) / phase
    assert np.max(np.abs(means - whole)) < (2.0 * np.pi * hertz * period_s) ** 2 / 10.0


def moved(reading: Intersample) -> Log:
    """A linear actuator under steps on a sine at 100 Hz, what lies between the samples as said."""
    time_s = 0.01 * np.arange(6000)
    steps = np.repeat(np.random.default_rng(1).uniform(0.0, 40.0, 60), 100)
    pressure = steps if reading == "held" else steps + 30.0 * np.sin(3.0 * time_s)
    system = ([1.0], [TRUTH["M"], TRUTH["N"], TRUTH["Q"]])
    x = signal.lsim(system, pressure, time_s, interp=reading == "straight")[1]
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": x}, outputs=("angle",))
    return log.with_intersample(reading)


@pytest.mark.parametrize("reading", ["straight", "held", "zoh"])
def test_averages_of_a_held_input_come_when_it_does(reading: Intersample) -> None:
    """Stands on lsim: 1e-3 of the angle's spread is left; half an interval late would be 2.5 times.

    That is 5 ms of a motion of 0.2 s. Read otherwise the averages leave it, and read again as what
    they are they are the same.
    """

    def left_by(log: Log) -> float:
        problem = linear_problem([log])
        (block,) = problem.blocks(problem.unknowns(TRUTH), derivatives=False)
        return float(np.std(block.residual[100:]) / np.ptp(log.channels["angle"].values))

    log = moved(reading)
    short = decimated(log, 5, keeps_jumps=True)
    assert short.intersample == reading
    assert (short.reading, short.between_samples) == (reading, "straight")
    assert left_by(short) < 1e-3
    other: Intersample = "zoh" if reading == "straight" else "straight"
    wrong = read_as(short, other)
    assert wrong.intersample == other
    assert left_by(wrong) > 2.0 * left_by(short)
    again = read_as(wrong, reading).channels["pressure"].values
    assert again.tolist() == short.channels["pressure"].values.tolist()
    assert short.as_recorded is log
    assert log.as_recorded is log
    assert read_as(log, other).intersample == other


def stepping(pieces: int, length: int = 100) -> Log:
    """A command at 100 Hz that steps every ``length`` samples, which the angle follows at once."""
    levels = 50.0 + 40.0 * (-1.0) ** np.arange(pieces) * np.linspace(0.5, 1.0, pieces)
    command = np.repeat(levels, length)
    time_s = 0.01 * np.arange(command.size)
    return Log.from_arrays(time_s, {"pressure": command, "angle": 0.1 * command})


@pytest.mark.parametrize("count", [2, 3, 5])
@pytest.mark.parametrize("reading", ["straight", "held", "zoh"])
def test_a_jump_stays_where_it_was(reading: Intersample, count: int) -> None:
    """Known truth: steps are drawn as recorded, to rounding; read again they are where those are.

    The means that hold one are left out, and no others; averages that only choose keep all.
    """
    log = stepping(12).with_intersample(reading)
    short = decimated(log, count, keeps_jumps=True)
    (segment,) = short.segments()
    inside_s = np.arange(segment.time_s[0], segment.time_s[-1], 0.0007)
    known = np.interp(inside_s, log.time_s, log.channels["pressure"].values)
    if reading != "straight":
        known = log.channels["pressure"].values[np.floor(inside_s / 0.01 + 1e-9).astype(int)]
    drawn = np.interp(inside_s, segment.time_s, segment.input)
    assert np.allclose(drawn, known, rtol=0.0, atol=1e-6)
    other = read_as(read_as(short, "straight"), reading).segments()[0]
    assert np.array_equal(other.input, segment.input)
    samples = np.arange(100, len(log), 100)
    holding = np.unique(np.concatenate((samples - 1, samples)) // count)
    expected = [k not in holding for k in range(len(short))]
    assert segment.samples_of(segment.used["angle"]).tolist() == expected
    (rough,) = decimated(log, count).segments()
    assert rough.is_sample is None
    assert rough.used["angle"].all()


def test_a_train_of_pulses_is_averaged() -> None:
    """Of so many jumps nothing but their knots would be left."""
    (segment,) = decimated(stepping(200, length=6), 3, keeps_jumps=True).segments()
    assert segment.is_sample is None
    assert segment.used["angle"].all()


def test_a_smooth_input_is_straight_between_its_new_samples() -> None:
    """They hold its bends already: there is a node for every mean and none between."""
    time_s = 0.01 * np.arange(400)
    log = Log.from_arrays(time_s, {"pressure": np.sin(20.0 * time_s), "angle": time_s})
    smooth = log.with_intersample("smooth")
    assert smooth.segments()[0].time_s.size > len(smooth)
    assert decimated(smooth, 4).segments()[0].time_s.size == 100


def test_what_else_is_known_of_a_log_stays() -> None:
    """When a slow gauge read the input, and that the log goes on through its stalls."""
    log = regular(4000)
    time_s = log.time_s + np.where(np.arange(4000) < 2000, 0.0, 1.0)
    read_s = time_s[::7]
    known = replace(log, time_s=time_s, input_read_s=read_s, is_bridged=True)
    short = decimated(known, 4)
    assert np.array_equal(short.segments()[0].readings[0], read_s[read_s <= short.time_s[-1]][1:])
    assert len(short.segments()) == 1
    assert len(decimated(replace(known, is_bridged=False), 4).segments()) == 2


def test_one_sample_is_its_own_mean() -> None:
    """Nothing is copied."""
    log = regular(20)
    assert decimated(log, 1) is log


def test_the_range_of_averages_is_that_of_the_record() -> None:
    """Nodes of a straight line about steps lie beyond them, and no such pressure was there."""
    time_s = 0.01 * np.arange(400)
    steps = np.where(time_s % 1.0 < 0.5, 0.0, 100.0)
    log = Log.from_arrays(time_s, {"pressure": steps, "angle": steps})
    short = decimated(log, 4)
    assert short.channels["pressure"].values.min() < 0.0
    assert fitted_range(LogSet((short,)))["pressure"] == (0.0, 100.0)
    wider = Log.from_arrays(time_s, {"pressure": 1.05 * steps, "angle": steps})
    found = extrapolation(decimated(wider, 4), "pressure", {"pressure": (0.0, 100.0)})
    assert found is not None
    assert "reaches 105 kPa" in found.message
    assert extrapolation(short, "pressure", {"pressure": (0.0, 100.0)}) is None
