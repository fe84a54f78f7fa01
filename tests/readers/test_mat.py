"""MATLAB files, against `scipy.io`, which writes and reads them independently."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from softid.errors import InputError
from softid.readers import files, load
from softid.readers.mat import read_mat

WriteFile = Callable[..., Path]

COLUMNS = {
    "time_s": np.arange(5) * 0.1,
    "pressure_kpa": np.array([0, 10, 20, 30, 40], np.int16),
    "angle_deg": np.linspace(0, 30, 5, dtype=np.float32),
}


def saved(variables: dict[str, object], *, compressed: bool = False) -> bytes:
    stream = io.BytesIO()
    scipy.io.savemat(stream, variables, do_compression=compressed, oned_as="column")
    return stream.getvalue()


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("nested", [False, True])
def test_variables_and_fields_of_a_struct(
    write_log: WriteFile, compressed: bool, nested: bool
) -> None:
    variables = {"run": COLUMNS} if nested else COLUMNS
    log = load(write_log(saved(variables, compressed=compressed), "log.mat"))
    np.testing.assert_array_equal(log.time_s, COLUMNS["time_s"])
    np.testing.assert_array_equal(log.pressure_kpa, COLUMNS["pressure_kpa"])
    np.testing.assert_allclose(log.channels["angle"].displayed, COLUMNS["angle_deg"], rtol=1e-14)
    assert log.source is not None
    assert log.source.file_format == "mat"


def test_every_numeric_type_equals_scipys_reading(write_log: WriteFile) -> None:
    kinds = ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8", "?"]
    variables = {f"x_{kind.strip('?') or 'b'}": np.array([0, 1, 1], kind) for kind in kinds}
    variables["wide"] = np.array([[1e300, -2.5, 70000.0]])
    data = saved(variables)
    table = read_mat(write_log(data, "log.mat"))
    expected = scipy.io.loadmat(io.BytesIO(data))
    assert set(table.head.names) == set(variables)
    for k, name in enumerate(table.head.names):
        np.testing.assert_array_equal(table.numbers(k), expected[name].ravel().astype(float))


def test_big_endian(write_log: WriteFile) -> None:
    """Written by hand after the format's description: one 3 × 1 double called v, twice."""

    def element(kind: int, payload: bytes) -> bytes:
        return struct.pack(">II", kind, len(payload)) + payload + bytes(-len(payload) % 8)

    def matrix(name: bytes) -> bytes:
        flags, shape = struct.pack(">II", 6, 0), struct.pack(">ii", 3, 1)
        numbers = struct.pack(">ddd", 1.0, 2.0, 3.0)
        parts = element(6, flags) + element(5, shape) + element(1, name) + element(9, numbers)
        return element(14, parts)

    data = b"MATLAB 5.0".ljust(124) + b"\x01\x00MI" + matrix(b"v") + matrix(b"w")
    table = read_mat(write_log(data, "log.mat"))
    assert table.head.names == ("v", "w")
    assert table.numbers(0).tolist() == [1.0, 2.0, 3.0]


def test_what_is_no_channel_becomes_metadata_or_is_left_out(write_log: WriteFile) -> None:
    others: dict[str, Any] = {
        "gain": 2.5,
        "rig": "finger 3",
        "cells": np.array(["a", 1], dtype=object),
        "wave": np.array([1 + 2j] * 5),
        "short": np.arange(3.0),
        "matrix": np.arange(10.0).reshape(5, 2),
        "image": np.zeros((5, 200)),
        "deep": {"inner": {"x": np.arange(5.0)}},
    }
    table = read_mat(write_log(saved({**COLUMNS, **others}), "log.mat"))
    assert set(table.head.names) == {*COLUMNS, "matrix_1", "matrix_2", "x"}
    second = table.head.names.index("matrix_2")
    np.testing.assert_array_equal(table.numbers(second), others["matrix"][:, 1])
    assert table.head.metadata["gain"] == "2.5"
    assert table.head.metadata["rig"] == "finger 3"
    (issue,) = table.head.issues
    assert "short" in issue.message


def test_equal_field_names_carry_their_structs_name(write_log: WriteFile) -> None:
    data = saved({"a": {"p": np.arange(3.0)}, "b": {"p": np.arange(3.0), "q": np.ones(3)}})
    assert set(read_mat(write_log(data, "log.mat")).head.names) == {"a.p", "b.p", "q"}


def test_nothing_to_line_up(write_log: WriteFile) -> None:
    with pytest.raises(InputError, match="no two channels of equal length"):
        load(write_log(saved({"t": np.arange(3.0), "p": np.arange(4.0)}), "log.mat"))


def test_a_compression_bomb_stops_at_the_limit(
    write_log: WriteFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "SIZE_LIMIT_BYTES", 2**20)
    data = saved({"t": np.zeros(2**20)}, compressed=True)
    assert len(data) < 2**17
    with pytest.raises(InputError, match="over 1 MB unpacked"):
        load(write_log(data, "log.mat"))


@pytest.mark.parametrize("kept", [0.3, 0.6, 0.95])
def test_a_truncated_file(write_log: WriteFile, kept: float) -> None:
    data = saved(COLUMNS)
    with pytest.raises(InputError):
        load(write_log(data[: int(kept * len(data))], "log.mat"))


def test_a_length_beyond_the_end_is_an_error(write_log: WriteFile) -> None:
    """A compressed element whose content announces 2 GB and holds 8 bytes."""
    inner = zlib.compress(struct.pack("<II", 14, 2**31) + bytes(8))
    data = b"MATLAB 5.0".ljust(124) + b"\x00\x01IM" + struct.pack("<II", 15, len(inner)) + inner
    with pytest.raises(InputError, match="ends in the middle"):
        load(write_log(data, "log.mat"))
