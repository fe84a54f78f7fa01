"""What a caller gives as arrays, names and numbers: what is taken, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import softid
from softid.errors import InputError, SoftidError, UsageError
from softid.log import Log

TIME_S = 0.1 * np.arange(6)
PRESSURE = np.linspace(0.0, 5.0, 6)
ANGLE = np.linspace(0.0, 1.0, 6)
NOON = datetime(2026, 11, 21, 12)
MOMENTS = pd.date_range(NOON, periods=6, freq="100ms")


def make_log(time_s: object = TIME_S, angle: object = ANGLE, **options: object) -> Log:
    return Log.from_arrays(time_s, {"pressure": PRESSURE, "angle": angle}, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "moments",
    [
        MOMENTS,
        MOMENTS.tz_localize("Europe/Berlin"),
        pd.Series(MOMENTS),
        MOMENTS - MOMENTS[0],
        np.asarray(MOMENTS),
        np.asarray(MOMENTS).astype("M8[ms]"),
        np.ma.array(np.asarray(MOMENTS)),
        [NOON + timedelta(milliseconds=100 * k) for k in range(6)],
        [timedelta(seconds=3, milliseconds=100 * k) for k in range(6)],
    ],
    ids=["index", "zone", "series", "delta", "M8", "ms", "masked", "datetime", "timedelta"],
)
def test_dates_and_durations_are_seconds_since_the_first(moments: object) -> None:
    """They lie 100 ms apart; taken as numbers they would be nanoseconds since 1970."""
    np.testing.assert_allclose(make_log(moments).time_s, TIME_S, rtol=0.0, atol=1e-9)


def test_a_masked_value_is_missing() -> None:
    hidden = np.ma.array([0, 1, 2, 3, 4, 5], mask=[0, 1, 0, 0, 0, 0])
    log = make_log(angle=hidden)
    assert log.segments()[0].used["angle"].tolist() == [True, False, True, True, True, True]
    assert make_log(angle=pd.array([0, None, 2, 3, 4, 5], dtype="Int64")).channels[
        "angle"
    ].values.tolist() == pytest.approx([0.0, np.nan, 2.0, 3.0, 4.0, 5.0], nan_ok=True)


def test_a_masked_time_is_missing() -> None:
    with pytest.raises(InputError, match=r"log, sample 2: the time is missing"):
        make_log(np.ma.array(TIME_S, mask=[0, 1, 0, 0, 0, 0]))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"time_s": TIME_S[:, None], "angle": ANGLE[:, None]}, r"time: .*shape \(6, 1\).*ravel"),
        ({"angle": ANGLE[:, None]}, r"angle: .*shape \(6, 1\).*ravel"),
        ({"angle": 1.0}, r"angle: .*shape \(\)"),
        ({"angle": [[1.0], [1.0, 2.0]]}, "angle: .*rows that differ in length"),
        ({"angle": ANGLE + 1j}, "angle, sample 1: this is not a real number"),
        ({"angle": [0.0, 1j, *ANGLE[2:]]}, "angle, sample 1: this is not a real number"),
        ({"angle": [0.0, "ERR", 2.0, 3.0, 4.0, 5.0]}, "angle, sample 2: .*'ERR'"),
        ({"angle": MOMENTS}, "angle, sample 1: .*2026"),
        ({"time_s": ["a", "b"]}, "time, sample 1: .*'a'"),
        ({"time_s": [NOON, NOON.replace(tzinfo=UTC)]}, "time: .*cannot be subtracted"),
        ({"time_s": [*TIME_S[:-1], np.inf]}, r"sample 6: the time is missing or infinite.*inf"),
        ({"time_s": [-np.inf, *TIME_S[1:]]}, r"sample 1: the time is missing or infinite.*-inf"),
    ],
)
def test_what_is_no_vector_of_real_numbers_is_refused(given: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        make_log(**given)


@pytest.mark.parametrize(
    ("change", "error", "said"),
    [
        (
            lambda: make_log(units={"angel": "deg"}),
            UsageError,
            "units: there is no such channel .*'angel'.*choose from pressure, angle",
        ),
        (lambda: make_log(outputs="angle"), UsageError, r"write outputs=\['angle'\]"),
        (lambda: make_log().with_roles(outputs="angle"), UsageError, r"outputs=\['angle'\]"),
        (lambda: make_log(outputs=["angle", "angle"]), UsageError, "angle is an output twice"),
        (lambda: make_log().with_intersample("nope"), UsageError, "'nope'.*straight, smooth"),  # type: ignore[arg-type]
        (lambda: make_log().with_masked([True]), InputError, r"shape \(1,\), the log 6"),
        (lambda: make_log().every(0), UsageError, "step: .*from 1 on .*got 0"),
        (lambda: make_log().every(1.5), UsageError, "step: .*got 1.5"),  # type: ignore[arg-type]
    ],
)
def test_a_slip_in_a_call_is_told(
    change: Callable[[], Log], error: type[SoftidError], said: str
) -> None:
    with pytest.raises(error, match=said):
        change()


def test_one_name_is_no_list_of_outputs_for_a_file_either(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("time_s,pressure_kpa,angle_deg\n0,0,0\n0.1,1,1\n0.2,2,2\n")
    with pytest.raises(UsageError, match=r"write outputs=\['angle'\]"):
        softid.load(file, outputs="angle")
