"""One recording: what it refuses, how it falls into segments, and that nobody can change it."""

from __future__ import annotations

import numpy as np
import pytest

from softid.errors import InputError, UsageError
from softid.log import STALL_MIN_PERIODS, STALL_MIN_S, Log, LogSet


def make_log(time_s: object = None, **options: object) -> Log:
    time = np.arange(6) * 0.1 if time_s is None else np.asarray(time_s, float)
    channels = {
        "pressure": np.linspace(0.0, 5.0, time.size),
        "angle": np.linspace(0.0, 1.0, time.size),
        "flex": np.ones(time.size),
    }
    return Log.from_arrays(time, channels, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("time_s", "what"),
    [
        ([0.0], "sample"),
        ([0.0, 0.2, 0.1], "does not increase"),
        ([0.0, 0.1, 0.1], "does not increase"),
        ([0.0, np.nan, 0.1], "."),
    ],
)
def test_times_must_increase(time_s: list[float], what: str) -> None:
    with pytest.raises(InputError, match=what):
        make_log(time_s)


def test_a_channel_must_have_one_sample_per_time() -> None:
    with pytest.raises(InputError, match="3 samples, the time 2"):
        Log.from_arrays([0.0, 1.0], {"pressure": [0.0, 1.0], "angle": [0.0, 1.0, 2.0]})


def test_a_missing_input_is_refused_and_a_missing_output_is_not_used() -> None:
    with pytest.raises(InputError, match="input pressure has 1 missing"):
        Log.from_arrays([0.0, 1.0], {"pressure": [0.0, np.nan], "angle": [0.0, 1.0]})
    log = Log.from_arrays([0.0, 1.0], {"pressure": [0.0, 1.0], "angle": [0.0, np.nan]})
    assert log.segments()[0].used["angle"].tolist() == [True, False]


@pytest.mark.parametrize(
    ("options", "what"),
    [
        ({"input": "torque"}, "no channel torque"),
        ({"outputs": ["torque"]}, "no channel torque"),
        ({"input": "angle", "outputs": ["angle"]}, "input and output at once"),
    ],
)
def test_roles_must_name_channels(options: dict[str, object], what: str) -> None:
    with pytest.raises(UsageError, match=what) as caught:
        make_log(**options)
    assert caught.value.exit_code == 2


def test_the_log_falls_apart_at_stalls_only() -> None:
    """A stall is longer than max(0.5 s, 10 periods), as the docstring of `Log.stall_s` says."""
    period = 0.1
    longest = max(STALL_MIN_S, STALL_MIN_PERIODS * period)
    steps = np.array([*[period] * 5, longest * 1.01, *[period] * 5, longest * 0.99, period])
    log = make_log(np.concatenate([[0.0], np.cumsum(steps)]))
    assert log.stall_s == pytest.approx(longest)
    assert [(s.start, s.stop) for s in log.segments()] == [(0, 6), (6, 14)]
    rejoined = np.concatenate([s.input for s in log.segments()])
    np.testing.assert_array_equal(rejoined, log.pressure_kpa)


def test_a_single_sample_between_stalls_is_dropped() -> None:
    log = make_log([0.0, 0.1, 0.2, 5.0, 10.0, 10.1, 10.2])
    assert [(s.start, s.stop) for s in log.segments()] == [(0, 3), (4, 7)]


def test_masked_samples_add_up_and_leave_the_residuals() -> None:
    log = make_log().with_masked([True, *[False] * 5]).with_masked([*[False] * 5, True])
    assert log.segments()[0].used["angle"].tolist() == [False, True, True, True, True, False]


def test_between_is_half_open() -> None:
    part = make_log().between(0.1, 0.3)
    np.testing.assert_allclose(part.time_s, [0.1, 0.2])
    assert part.channels["flex"].values.shape == (2,)
    with pytest.raises(InputError):
        make_log().between(0.1, 0.2)


def test_other_roles_leave_the_data_alone() -> None:
    log = make_log().with_roles(input="angle", outputs=["flex"])
    assert (log.input, log.outputs) == ("angle", ("flex",))
    assert log.channels["pressure"].values is not None


def test_nothing_can_be_changed() -> None:
    log = make_log()
    with pytest.raises(ValueError, match="read-only"):
        log.time_s[0] = 1.0
    with pytest.raises(TypeError):
        log.channels["new"] = log.channels["angle"]  # type: ignore[index]


def test_a_set_of_logs_has_one_pair_of_roles_and_no_name_twice() -> None:
    logs = LogSet((make_log(name="a"), make_log(name="b")))
    assert (len(logs), logs.input, logs.outputs, logs.input_unit) == (
        2,
        "pressure",
        ("angle",),
        "kPa",
    )
    with pytest.raises(UsageError, match="two logs are called a"):
        LogSet((make_log(name="a"), make_log(name="a")))
    with pytest.raises(UsageError, match="angle"):
        LogSet((make_log(name="a"), make_log(name="b", outputs=["flex"])))
    with pytest.raises(UsageError, match="no log"):
        LogSet(())


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"outputs": ["bend"]}, "add it to the channels"),
        ({"outputs": ["pressure"]}, "outputs= in Python"),
    ],
)
def test_a_remedy_is_one_that_python_has_too(options: dict[str, object], word: str) -> None:
    """An option of the commands alone tells a caller of the library nothing."""
    with pytest.raises(UsageError) as caught:
        make_log(**options)
    assert word in str(caught.value.remedy)
