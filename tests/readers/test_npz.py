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


def test_texts_are_named_when_they_are_asked_for(write_log: WriteFile) -> None:
    data = saved(**COLUMNS, mode=np.array(list("abcde")))
    log = load(write_log(data, "log.npz"))
    assert "mode" in log.issues[0].message
