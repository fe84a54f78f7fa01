"""What is dropped is said, what cannot be repaired is refused, with the file's own row numbers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from softid.errors import InputError
from softid.identification.preparation import as_log_set, require_excitation
from softid.log import Log
from softid.readers import load

WriteFile = Callable[..., Path]

HEADER = "# a preamble line\ntime_s,pressure_kpa,angle_deg\n"  # so the first sample is row 3


def cleaned(write_log: WriteFile, *rows: str) -> Log:
    return load(write_log(HEADER + "\n".join(rows) + "\n"))


def refused(write_log: WriteFile, *rows: str) -> str:
    with pytest.raises(InputError) as caught:
        cleaned(write_log, *rows)
    assert caught.value.remedy
    return str(caught.value)


def test_time_running_backward_names_row_value_and_remedy(write_log: WriteFile) -> None:
    said = refused(write_log, "0,0,0", "0.1,1,1", "0.05,2,2", "0.2,3,3")
    assert "row 5" in said
    assert "backward, from 0.1 s to 0.05 s" in said
    assert "cut the log there" in said


def test_a_clock_that_restarts_is_one_backward_step(write_log: WriteFile) -> None:
    said = refused(write_log, "0,0,0", "0.1,1,1", "0,2,2", "0.1,3,3")
    assert "row 5" in said


def test_rows_that_repeat_are_dropped(write_log: WriteFile) -> None:
    log = cleaned(write_log, "0,0,0", "0.1,1,1", "0.1,1,1", "0.1,1,1", "0.2,3,")
    assert log.time_s.tolist() == [0.0, 0.1, 0.2]
    issue = log.issues[0]
    assert (issue.code, issue.severity) == ("duplicate-rows", "info")
    assert "dropped 2 of 5 samples" in issue.message
    assert "row 5" in issue.message


def test_rows_that_repeat_a_gap_are_the_same(write_log: WriteFile) -> None:
    log = cleaned(write_log, "0,0,0", "0.1,1,", "0.1,1,", "0.2,3,3")
    assert [i.code for i in log.issues] == ["duplicate-rows", "missing-output"]


def test_of_rows_that_share_a_time_the_first_stays(write_log: WriteFile) -> None:
    """An average would be a sample that nobody measured."""
    log = cleaned(write_log, "0,0,0", "0.1,1,10", "0.1,2,20", "0.2,3,30")
    np.testing.assert_allclose(np.rad2deg(log.channels["angle"].values), [0, 10, 30], rtol=1e-14)
    (issue,) = log.issues
    assert (issue.code, issue.severity) == ("duplicate-times", "warning")
    assert "dropped 1 of 4" in issue.message
    assert "row 5" in issue.message


def test_samples_without_input_are_dropped_and_leave_a_stall(write_log: WriteFile) -> None:
    rows = [f"{k / 10},{'' if 10 <= k < 20 else k},{k}" for k in range(30)]
    log = cleaned(write_log, *rows)
    assert len(log) == 20
    (issue,) = log.issues
    assert issue.code == "missing-input"
    assert "10 of 30" in issue.message
    assert "row 13" in issue.message
    assert len(log.segments()) == 2  # 1.1 s is longer than the stall of 10 periods


def test_leading_and_trailing_gaps_of_the_input(write_log: WriteFile) -> None:
    log = cleaned(write_log, "0,,0", "1,1,1", "2,2,2", "3,NaN,3")
    assert log.time_s.tolist() == [1.0, 2.0]


def test_missing_outputs_stay_and_are_not_used(write_log: WriteFile) -> None:
    log = cleaned(write_log, "0,0,0", "1,1,NaN", "2,2,2")
    assert log.segments()[0].used["angle"].tolist() == [True, False, True]
    (issue,) = log.issues
    assert issue.code == "missing-output"
    assert "row 4" in issue.message


def test_infinities_count_as_missing(write_log: WriteFile) -> None:
    log = cleaned(write_log, "0,0,0", "1,inf,1", "2,2,-inf", "3,3,3", "4,4,1e300")
    assert log.time_s.tolist() == [0.0, 2.0, 3.0, 4.0]
    assert np.isnan(log.channels["angle"].values).tolist() == [False, True, False, True]


def test_samples_without_a_time_are_dropped(write_log: WriteFile) -> None:
    log = cleaned(write_log, "0,0,0", ",1,1", "2,2,2")
    assert log.time_s.tolist() == [0.0, 2.0]
    assert log.issues[0].code == "missing-time"


@pytest.mark.parametrize(
    ("rows", "what"),
    [
        (("0,,0", "1,,1", "2,,2"), "the pressure holds no number at all"),
        (("0,0,NaN", "1,1,NaN", "2,2,NaN"), "the angle holds no number at all"),
        ((",0,0", ",1,1", ",2,2"), "no sample has a time"),
        (("0,1,2",), "only one sample is left; "),
        (
            ("0,1,2", "0,1,2", "0,1,3"),
            "only one sample is left of 3, for the others have no time, no pressure or the time of",
        ),
        (("0,1,2", "1,,3"), "only one sample is left"),
        (("NaN,1,2", "1,,3"), "no sample is left"),
    ],
)
def test_what_cannot_be_used(write_log: WriteFile, rows: tuple[str, ...], what: str) -> None:
    assert what in refused(write_log, *rows)


def test_a_constant_input_loads_for_inspection_but_cannot_be_identified(
    write_log: WriteFile,
) -> None:
    log = cleaned(write_log, "0,5,0", "1,5,1", "2,5,2")
    with pytest.raises(InputError, match="pressure is constant") as caught:
        require_excitation(as_log_set(log))
    assert caught.value.value == "5 kPa"
    assert "log.csv" in str(caught.value)
    require_excitation(as_log_set(cleaned(write_log, "0,5,0", "1,5.1,1", "2,5,2")))
