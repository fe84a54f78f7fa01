"""Counters that begin again at the end of their range."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from softid.errors import InputError
from softid.readers import load
from softid.readers.overflow import counted_on

WriteFile = Callable[..., Path]
STEPS_MS = np.array([20, 21, 19, 20, 40, 20, 20, 20, 20, 20])


@pytest.mark.parametrize("bits", [16, 32])
def test_a_counter_goes_on(bits: int) -> None:
    """Known truth, also where a cell is empty on both sides of the end."""
    truth = 2.0**bits - 70.0 + np.cumsum(STEPS_MS)
    counts = truth % 2.0**bits
    np.testing.assert_array_equal(counted_on(counts).values, truth)
    assert counted_on(counts).at.tolist() == [3]
    counts[[2, 3]] = np.nan
    found = counted_on(counts)
    np.testing.assert_array_equal(found.values, np.where(np.isnan(counts), np.nan, truth))
    assert found.at.tolist() == [4]


def test_a_counter_that_overflows_often() -> None:
    """16 bits of milliseconds hold 65.5 s: three minutes overflow twice."""
    truth = 20.0 * np.arange(9000)
    np.testing.assert_array_equal(counted_on(truth % 2.0**16).values, truth)


@pytest.mark.parametrize(
    "counts",
    [
        [0.0, 20.0, 40.0, 0.0, 20.0],
        [65000.0, 65020.0, 65040.0, 4.0, 24.0],
        [65480.5, 65500.5, 65520.5, 4.5, 24.5],
        [65490.0, 65510.0, 65530.0, 65490.0, 65510.0],
        [0.0, 20.0, 40.0, 60.0],
    ],
    ids=["begun anew", "half a second lost", "no whole numbers", "out of order", "runs forward"],
)
def test_what_is_no_overflow_stays(counts: list[float]) -> None:
    assert counted_on(np.array(counts)).values.tolist() == counts


def test_the_time_of_a_file_goes_on_and_says_so(write_log: WriteFile) -> None:
    """The second is counted from the first cell as before; one begun anew is refused."""
    rows = [f"{(65480 + 20 * k) % 65536};{k};{k}" for k in range(6)]
    log = load(write_log("\n".join(("t_ms;pressure_kpa;angle_deg", *rows))))
    np.testing.assert_allclose(log.time_s, 65.48 + 0.02 * np.arange(6), rtol=0.0, atol=1e-9)
    (issue,) = [issue for issue in log.issues if issue.code == "counter-overflow"]
    assert "row 5" in issue.message
    assert "once" in issue.message
    anew = [f"{20 * (k % 3)};{k};{k}" for k in range(6)]
    with pytest.raises(InputError, match="runs backward"):
        load(write_log("\n".join(("t_ms;pressure_kpa;angle_deg", *anew))))
