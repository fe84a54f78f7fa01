"""Averages of logs that are sampled far faster than anything moves."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import TRUTH, linear_problem
from scipy import signal

from softid.diagnosis.logs.decimation import (
    MOST_KEPT_SAMPLES,
    SAMPLES_PER_MOTION,
    AveragedLog,
    decimated,
    samples_to_average,
    with_other_intersample,
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
        (MOST_KEPT_SAMPLES, 100.0, 1),
        (MOST_KEPT_SAMPLES + 1, 100.0, 2),
        (10 * MOST_KEPT_SAMPLES, 100.0, 10),
        (10 * MOST_KEPT_SAMPLES, 4.5 * SAMPLES_PER_MOTION * 0.001, 4),
        (10 * MOST_KEPT_SAMPLES, 0.9 * SAMPLES_PER_MOTION * 0.001, 1),
    ],
)
def test_how_many_samples_a_mean_holds(samples: int, motion_s: float, count: int) -> None:
    """Stands on the two limits: 6000 samples stay in all, and 30 in a time constant."""
    assert samples_to_average([regular(samples)], motion_s) == count


def test_logs_count_together_and_the_slowest_sets_the_limit() -> None:
    """Two logs of 6000 samples are 12000; 30 samples of 2 ms in 0.09 s leave a mean of 1.5."""
    fast, slow = (
        regular(MOST_KEPT_SAMPLES, name="fast"),
        regular(MOST_KEPT_SAMPLES, 0.002, name="slow"),
    )
    assert samples_to_average([fast, slow], 100.0) == 2
    assert samples_to_average([fast, slow], 0.09) == 1


def test_irregular_logs_are_left_alone() -> None:
    """A mean of samples at uneven times is no value at their mean time; 30 % off is uneven."""
    even = regular(10 * MOST_KEPT_SAMPLES)
    for share, count in ((0.1, 10), (0.3, 1)):
        time_s = np.array(even.time_s)
        time_s[500] += share * 0.001
        uneven = Log.from_arrays(time_s, {"pressure": time_s, "angle": time_s})
        assert samples_to_average([uneven], 100.0) == count
        both = samples_to_average([even, uneven], 100.0)
        assert both == (20 if count == 10 else 1)


def test_means_by_hand() -> None:
    """Two groups of three and one sample over: times, values and masks worked out by hand."""
    log = Log.from_arrays(
        [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
        {"pressure": [1, 2, 6, 0, 0, 3, 9], "angle": [0, 3, 6, 1, 1, 1, 9]},
    ).with_masked([False, False, False, False, True, False, True])
    short = decimated(log, 3)
    assert short.time_s == pytest.approx([0.1, 0.4])
    assert short.pressure_kpa.tolist() == [3.0, 1.0]
    assert short.channels["angle"].values.tolist() == [3.0, 1.0]
    assert short.masked is not None
    assert short.masked.tolist() == [False, True]
    assert (short.name, short.input, short.outputs) == (log.name, log.input, log.outputs)


def test_back_to_samples_by_hand() -> None:
    """Samples of a mean that does not count, and those that fill none, do not count; nor do ones
    that never did."""
    log = Log.from_arrays(np.arange(7.0), {"pressure": np.arange(7), "angle": np.arange(7)})
    spoilt = log.with_masked([False, True, False, False, False, False, False])
    short = decimated(spoilt, 2).with_masked([False, False, True]).with_intersample("held")
    assert isinstance(short, AveragedLog)
    recorded = short.at_samples()
    assert recorded.masked.tolist() == [True, True, False, False, True, True, True]
    assert recorded.intersample == "held"
    assert recorded.channels["angle"].values.tolist() == list(range(7))


def test_a_missing_sample_takes_its_group_out_of_the_residual() -> None:
    """The mean of what was not recorded is not known, and must not count."""
    log = Log.from_arrays(
        [0.0, 0.1, 0.2, 0.3], {"pressure": [1, 2, 3, 4], "angle": [1.0, np.nan, 2.0, 4.0]}
    )
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
    (π f T)²/6; the straight line through the new inputs has the means of the old ones."""
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
    assert means == pytest.approx(wave.reshape(-1, count).mean(axis=1)[1:-1])


def moved(intersample: Intersample) -> Log:
    """A linear actuator under steps on a sine at 100 Hz, what lies between the samples as said."""
    time_s = 0.01 * np.arange(6000)
    steps = np.repeat(np.random.default_rng(1).uniform(0.0, 40.0, 60), 100)
    pressure = steps if intersample == "held" else steps + 30.0 * np.sin(3.0 * time_s)
    system = ([1.0], [TRUTH["M"], TRUTH["N"], TRUTH["Q"]])
    x = signal.lsim(system, pressure, time_s, interp=intersample == "straight")[1]
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": x}, outputs=("angle",))
    return log.with_intersample(intersample)


@pytest.mark.parametrize("intersample", ["straight", "held", "zoh"])
def test_averages_of_a_held_input_come_when_it_does(intersample: Intersample) -> None:
    """Stands on lsim: 1e-3 of the angle's spread is left; half an interval late would be 2.5 times.

    That is 5 ms of a motion of 0.2 s. Taken otherwise the averages leave it, and taken again as
    what they are they are the same.
    """

    def left_by(log: Log) -> float:
        problem = linear_problem([log])
        (block,) = problem.blocks(problem.unknowns(TRUTH), derivatives=False)
        return float(np.std(block.residual[100:]) / np.ptp(log.channels["angle"].values))

    log = moved(intersample)
    short = decimated(log, 5)
    assert short.intersample == intersample
    assert (short.effective_intersample, short.between_samples) == (intersample, "straight")
    assert left_by(short) < 1e-3
    other: Intersample = "zoh" if intersample == "straight" else "straight"
    wrong = with_other_intersample(short, other)
    assert wrong.intersample == other
    assert left_by(wrong) > 2.0 * left_by(short)
    again = with_other_intersample(wrong, intersample).channels["pressure"].values
    assert again.tolist() == short.channels["pressure"].values.tolist()
    assert short.as_recorded is log
    assert log.as_recorded is log
    assert with_other_intersample(log, other).intersample == other


def stepping(pieces: int, length: int = 100) -> Log:
    """A command at 100 Hz that steps every ``length`` samples, which the angle follows at once."""
    levels = 50.0 + 40.0 * (-1.0) ** np.arange(pieces) * np.linspace(0.5, 1.0, pieces)
    command = np.repeat(levels, length)
    time_s = 0.01 * np.arange(command.size)
    return Log.from_arrays(time_s, {"pressure": command, "angle": 0.1 * command})


@pytest.mark.parametrize("count", [2, 3, 5])
@pytest.mark.parametrize("intersample", ["straight", "held", "zoh"])
def test_a_jump_stays_where_it_was(intersample: Intersample, count: int) -> None:
    """Known truth: steps are drawn as recorded, to rounding; taken again they are where those are.

    The means that hold one are left out, and no others.
    """
    log = stepping(12).with_intersample(intersample)
    short = decimated(log, count)
    (segment,) = short.segments()
    inside_s = np.arange(segment.time_s[0], segment.time_s[-1], 0.0007)
    known = np.interp(inside_s, log.time_s, log.channels["pressure"].values)
    if intersample != "straight":
        known = log.channels["pressure"].values[np.floor(inside_s / 0.01 + 1e-9).astype(int)]
    drawn = np.interp(inside_s, segment.time_s, segment.input)
    assert np.allclose(drawn, known, rtol=0.0, atol=1e-6)
    straight = with_other_intersample(short, "straight")
    (again,) = with_other_intersample(straight, intersample).segments()
    assert np.array_equal(again.input, segment.input)
    samples = np.arange(100, len(log), 100)
    holding = np.unique(np.concatenate((samples - 1, samples)) // count)
    expected = [k not in holding for k in range(len(short))]
    assert segment.samples_of(segment.used["angle"]).tolist() == expected


def test_a_train_of_pulses_is_averaged() -> None:
    """Of so many jumps nothing but their knots would be left."""
    (segment,) = decimated(stepping(200, length=6), 3).segments()
    assert segment.is_sample is None
    assert segment.used["angle"].all()


def test_a_smooth_input_is_straight_between_its_new_samples() -> None:
    """They hold its bends already: there is a node for every mean and none between."""
    time_s = 0.01 * np.arange(400)
    log = Log.from_arrays(time_s, {"pressure": np.sin(20.0 * time_s), "angle": time_s})
    smooth = log.with_intersample("smooth")
    assert smooth.segments()[0].time_s.size > len(smooth)
    assert decimated(smooth, 4).segments()[0].time_s.size == 100


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
