"""Parquet: the same log as the CSV, columns read on request, an optional dependency."""

from __future__ import annotations

import sys
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from softid.errors import InputError, MissingExtraError
from softid.readers import files, load
from softid.readers.parquet import ParquetTable

pa = pytest.importorskip("pyarrow", reason="pyarrow is in the test extra")
pq = pytest.importorskip("pyarrow.parquet")

WriteFile = Callable[..., Path]

COLUMNS: dict[str, Any] = {
    "time_s": [0.0, 0.1, 0.2],
    "pressure_bar": [0.0, 0.5, 1.0],
    "angle_deg": [0.0, None, 30.0],
    "mode": ["a", "b", "c"],
    "pwm": [0, 128, 255],
}


def write(path: Path, columns: dict[str, Any]) -> Path:
    pq.write_table(pa.table(columns), path)
    return path


def test_a_table_becomes_a_log(tmp_path: Path) -> None:
    log = load(write(tmp_path / "log.parquet", COLUMNS))
    assert log.time_s.tolist() == [0.0, 0.1, 0.2]
    assert log.pressure_kpa.tolist() == [0.0, 50.0, 100.0]
    assert np.isnan(log.channels["angle"].values).tolist() == [False, True, False]
    assert log.channels["pwm"].values.tolist() == [0, 128, 255]
    assert [i.code for i in log.issues] == ["column-left-out", "missing-output"]
    assert log.source is not None
    assert log.source.sha256 == files.file_fingerprint(tmp_path / "log.parquet")


def test_timestamps_and_units_of_fields(tmp_path: Path) -> None:
    start = datetime(2024, 1, 1)
    stamps = [start + timedelta(milliseconds=20 * k) for k in range(3)]
    schema = pa.schema(
        [
            pa.field("stamp", pa.timestamp("us")),
            pa.field("pressure", pa.float64(), metadata={"unit": "psi"}),
            pa.field("angle", pa.float32(), metadata={"unit": "deg"}),
        ]
    )
    table = pa.table([stamps, [0.0, 1.0, 2.0], [0.0, 1.0, 2.0]], schema=schema)
    pq.write_table(table, tmp_path / "log.parquet")
    log = load(tmp_path / "log.parquet")
    np.testing.assert_allclose(log.time_s, [0.0, 0.02, 0.04], atol=1e-12)
    assert log.pressure_kpa[1] == pytest.approx(6.894757293168361, rel=1e-12)


def test_of_a_large_file_only_the_needed_columns_are_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write(tmp_path / "log.parquet", COLUMNS)
    monkeypatch.setattr(files, "SIZE_LIMIT_BYTES", 4 * 8 * 3)
    read: list[int] = []
    numbers = ParquetTable.numbers

    def watched(self: ParquetTable, index: int) -> Any:
        read.append(index)
        return numbers(self, index)

    monkeypatch.setattr(ParquetTable, "numbers", watched)
    assert set(load(path).channels) == {"pressure", "angle"}
    assert sorted(read) == [0, 1, 2]
    assert set(load(path, input="pwm").channels) == {"pressure", "angle", "pwm"}
    monkeypatch.setattr(files, "SIZE_LIMIT_BYTES", 8)
    with pytest.raises(InputError, match="3 rows, more than"):
        load(path)


def test_text_in_a_needed_column_is_named(tmp_path: Path) -> None:
    path = write(tmp_path / "log.parquet", COLUMNS)
    with pytest.raises(InputError, match="holds string, not numbers") as caught:
        load(path, channels={"angle": "mode:deg"})
    assert "column mode" in str(caught.value)


def test_without_pyarrow_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write(tmp_path / "log.parquet", COLUMNS)
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(MissingExtraError, match=r"pip install softid\[parquet\]") as caught:
        load(path)
    assert caught.value.exit_code == 2


@pytest.mark.parametrize("cut", [4, -10])
def test_a_truncated_file(tmp_path: Path, cut: int) -> None:
    path = write(tmp_path / "log.parquet", COLUMNS)
    path.write_bytes(path.read_bytes()[:cut])
    with pytest.raises(InputError, match="not a Parquet file that can be read"):
        load(path)
