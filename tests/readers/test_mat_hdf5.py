"""MATLAB files of version 7.3, laid out as MATLAB does it: a header, then HDF5 behind 512 bytes."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest

from softid.errors import InputError, MissingExtraError
from softid.readers import files, load
from softid.readers.mat import read_mat

h5py = pytest.importorskip("h5py", reason="h5py is in the test extra")

WriteFile = Callable[..., Path]

HEADER = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(510) + b"\x00\x02"

CLASSES = {"f": b"double", "i": b"int16", "b": b"logical", "U": b"char"}


def saved(variables: Mapping[str, object], *, compressed: bool = False) -> bytes:
    """What MATLAB would save: dimensions in the opposite order, structs as groups."""
    stream = io.BytesIO()
    with h5py.File(stream, "w", userblock_size=512) as file:
        _write(file, variables, compressed=compressed)
    data = stream.getvalue()
    return HEADER + data[len(HEADER) :]


def _write(group: h5py.Group, variables: Mapping[str, object], *, compressed: bool) -> None:
    for name, value in variables.items():
        if isinstance(value, Mapping):
            inner = group.create_group(name)
            inner.attrs["MATLAB_class"] = np.bytes_(b"struct")
            _write(inner, value, compressed=compressed)
            continue
        array = np.atleast_2d(np.asarray(value))
        stored = array.T
        if array.dtype.kind == "U":
            stored = np.array([[ord(letter)] for letter in str(value)], np.uint16)
        elif array.dtype.kind == "b":
            stored = stored.astype(np.uint8)
        made = group.create_dataset(name, data=stored, compression="gzip" if compressed else None)
        made.attrs["MATLAB_class"] = np.bytes_(CLASSES[array.dtype.kind])


COLUMNS = {
    "time_s": np.arange(5)[:, None] * 0.1,
    "pressure_kpa": np.array([[0, 10, 20, 30, 40]], np.int16),
    "angle_deg": np.linspace(0.0, 30.0, 5)[:, None],
}
"""A column, a row, a column: MATLAB makes no difference where a variable is a vector."""


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("nested", [False, True])
def test_variables_and_fields_of_a_struct(
    write_log: WriteFile, compressed: bool, nested: bool
) -> None:
    variables = {"run": COLUMNS} if nested else COLUMNS
    log = load(write_log(saved(variables, compressed=compressed), "log.mat"))
    np.testing.assert_array_equal(log.time_s, COLUMNS["time_s"].ravel())
    assert log.pressure_kpa.tolist() == [0.0, 10.0, 20.0, 30.0, 40.0]
    np.testing.assert_allclose(
        log.channels["angle"].displayed, [0.0, 7.5, 15.0, 22.5, 30.0], rtol=1e-14
    )
    assert log.source is not None
    assert log.source.file_format == "mat"


def test_a_matrix_keeps_its_columns(write_log: WriteFile) -> None:
    """Three rows and two columns in MATLAB are stored as two rows of three."""
    matrix = np.array([[1.0, 10.0], [2.0, 20.0], [3.0, 30.0]])
    table = read_mat(write_log(saved({"data": matrix}), "log.mat"))
    assert table.head.names == ("data_1", "data_2")
    assert table.numbers(1).tolist() == [10.0, 20.0, 30.0]


def test_texts_and_single_numbers_are_facts(write_log: WriteFile) -> None:
    """The letters of a text are stored as numbers; an empty array stores its own dimensions."""
    stream = io.BytesIO(saved({**COLUMNS, "rig": "finger 3", "gain": 2.5}))
    with h5py.File(stream, "r+") as file:
        file.create_dataset("none", data=np.array([0, 5], np.uint64)).attrs["MATLAB_empty"] = 1
        file.create_dataset("#refs#/a", data=np.arange(5.0))
    table = read_mat(write_log(stream.getvalue(), "log.mat"))
    assert set(table.head.names) == set(COLUMNS)
    assert dict(table.head.metadata) == {"rig": "finger 3", "gain": "2.5"}
    assert table.head.issues == ()


def test_what_is_no_array_of_numbers_is_told_as_what_it_is(write_log: WriteFile) -> None:
    """A timetable stores six numbers that say where its columns are, in no documented way."""
    stream = io.BytesIO(saved(COLUMNS))
    with h5py.File(stream, "r+") as file:
        cells = file.create_dataset("cells", (5,), h5py.ref_dtype)
        cells.attrs["MATLAB_class"] = np.bytes_(b"cell")
        file.create_dataset("waves", data=np.ones(5, np.dtype([("real", "f8"), ("imag", "f8")])))
        table = file.create_dataset("rec", data=np.arange(6, dtype=np.uint32)[:, None])
        table.attrs["MATLAB_class"] = np.bytes_(b"timetable")
        table.attrs["MATLAB_object_decode"] = 3
    head = read_mat(write_log(stream.getvalue(), "log.mat")).head
    assert set(head.names) == set(COLUMNS)
    (issue,) = head.issues
    for part in ("cells (cell)", "waves (complex)", "rec (timetable)"):
        assert part in issue.message


def test_equal_field_names_carry_their_structs_name(write_log: WriteFile) -> None:
    data = saved({"a": {"p": np.arange(3.0)}, "b": {"p": np.arange(3.0), "q": np.ones(3)}})
    assert set(read_mat(write_log(data, "log.mat")).head.names) == {"a.p", "b.p", "q"}


@pytest.mark.parametrize("cut", [600, 1500, -100])
def test_a_damaged_file(write_log: WriteFile, cut: int) -> None:
    """Cut off anywhere: one sentence, in no words of a library."""
    with pytest.raises(InputError, match="ends too early") as caught:
        load(write_log(saved(COLUMNS)[:cut], "log.mat"))
    assert "-v7" in str(caught.value.remedy)


def test_a_compression_bomb_stops_at_the_limit(
    write_log: WriteFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Refused by what is announced, before anything is unpacked."""
    data = saved({"t": np.zeros(2**18)}, compressed=True)
    monkeypatch.setattr(files, "SIZE_LIMIT_BYTES", 2**20)
    assert len(data) < 2**17
    with pytest.raises(InputError, match="over 1 MB unpacked"):
        load(write_log(data, "log.mat"))


def test_without_h5py_the_extra_is_named(
    write_log: WriteFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write_log(saved(COLUMNS), "log.mat")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(MissingExtraError, match=r"pip install softid\[mat73\]") as caught:
        load(file)
    assert "-v7" in str(caught.value.remedy)
