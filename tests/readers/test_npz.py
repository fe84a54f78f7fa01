"""NumPy archives: plain arrays are channels, pickles are refused."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from softid.errors import InputError
from softid.readers import files, load

WriteFile = Callable[..., Path]

COLUMNS = {
    "time_s": np.arange(5) * 0.1,
    "pressure_bar": np.linspace(0, 1, 5),
    "angle_deg": np.arange(5),
}


def saved(compressed: bool = False, **arrays: object) -> bytes:
    stream = io.BytesIO()
    (np.savez_compressed if compressed else np.savez)(stream, **arrays)  # type: ignore[arg-type]
    return stream.getvalue()


@pytest.mark.parametrize("compressed", [False, True])
def test_arrays_become_channels(write_log: WriteFile, compressed: bool) -> None:
    data = saved(compressed, **COLUMNS, gain=2.5, note="x")
    log = load(write_log(data, "log.npz"))
    np.testing.assert_array_equal(log.time_s, COLUMNS["time_s"])
    np.testing.assert_array_equal(log.pressure_kpa, COLUMNS["pressure_bar"] * 100)
    assert dict(log.metadata) == {"gain": "2.5", "note": "x"}


def test_structured_arrays_and_dates(write_log: WriteFile) -> None:
    """Steps of 20 ms from numpy's own clock type."""
    stamps = np.datetime64("2024-01-01T00:00:00") + np.arange(4) * np.timedelta64(20, "ms")
    run = np.zeros(4, dtype=[("pressure_kpa", "f8"), ("angle_deg", "f4")])
    run["pressure_kpa"] = np.arange(4)
    log = load(write_log(saved(time=stamps, run=run), "log.npz"))
    np.testing.assert_allclose(log.time_s, [0, 0.02, 0.04, 0.06], atol=1e-12)
    assert log.pressure_kpa.tolist() == [0, 1, 2, 3]
    assert log.metadata["start"].startswith("2024-01-01T00:00:00")


def test_pickles_are_refused(write_log: WriteFile) -> None:
    data = saved(**COLUMNS, evil=np.array([{"a": 1}], dtype=object))
    with pytest.raises(InputError, match="pickled objects") as caught:
        load(write_log(data, "log.npz"))
    assert "plain arrays" in str(caught.value.remedy)


def test_a_zip_bomb_is_refused_by_its_directory(
    write_log: WriteFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "SIZE_LIMIT_BYTES", 2**20)
    with pytest.raises(InputError, match="8 MB unpacked"):
        load(write_log(saved(True, t=np.zeros(2**20)), "log.npz"))


def test_a_truncated_archive(write_log: WriteFile) -> None:
    data = saved(**COLUMNS)
    with pytest.raises(InputError, match="not an NPZ archive that can be read"):
        load(write_log(data[: len(data) // 2], "log.npz"))


@pytest.mark.parametrize(("lost", "size"), [("angle_deg", 4), ("pressure_bar", 9), ("time_s", 6)])
def test_a_channel_of_another_length_is_no_channel_less(
    write_log: WriteFile, lost: str, size: int
) -> None:
    """The array that a role needs is named with both lengths; a flag that chooses another helps."""
    arrays = COLUMNS | {lost: np.arange(size) * 0.1, "spare": np.arange(5) * 0.1}
    path = write_log(saved(**arrays), "log.npz")
    with pytest.raises(InputError, match=f"the array {lost} has {size} values, but .* have 5") as e:
        load(path)
    assert "one value per sample" in str(e.value)
    channel, unit = lost.split("_")
    assert load(path, channels={channel: f"spare:{unit}"}).time_s.size == 5
    with pytest.raises(InputError, match=f"{lost} has {size} values"):
        load(path, channels={channel: f"{lost}:{unit}"})


def test_an_odd_array_that_nobody_needs_is_told(write_log: WriteFile) -> None:
    """Gains, maps and notes lie beside the channels of many files."""
    log = load(write_log(saved(**COLUMNS, gains=np.arange(3), torque_nmm=np.arange(7)), "log.npz"))
    told = {issue.code: issue.message for issue in log.issues}
    assert "left out gains (3 long), torque_nmm (7 long)" in told["column-left-out"]
    assert "so no column was taken as torque" in told["channel-not-settled"]
    assert {i.severity for i in log.issues if i.code == "channel-not-settled"} == {"warning"}


def test_texts_are_named_when_they_are_asked_for(write_log: WriteFile) -> None:
    data = saved(**COLUMNS, mode=np.array(list("abcde")))
    log = load(write_log(data, "log.npz"))
    assert "mode" in log.issues[0].message
