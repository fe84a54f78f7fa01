"""What can be wrong with a file before anybody looks inside: one sentence each, and at once."""

from __future__ import annotations

import gzip
import os
import re
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from softid.errors import InputError
from softid.readers import READERS, files, load

WriteFile = Callable[..., Path]

GOOD = "time_s,pressure_kpa,angle_deg\n0,1,2\n1,2,3\n"
TWO_GIGABYTES = 2 * 2**30
BAGS = (".bag", ".db3", ".mcap")
ANY_SIZE = (".parquet", *BAGS)
BINARY = [f"log{suffix}" for suffix in (".npz", ".mat", *ANY_SIZE)]


def refused(path: Path) -> InputError:
    with pytest.raises(InputError) as caught:
        load(path)
    error = caught.value
    assert error.exit_code == 3
    assert str(path) in str(error)
    assert error.remedy
    assert "\n" not in str(error)
    return error


def test_missing_file(tmp_path: Path) -> None:
    assert "no such file" in str(refused(tmp_path / "none.csv"))


def test_folder(tmp_path: Path) -> None:
    assert "folder" in str(refused(tmp_path))


def test_something_that_is_no_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.csv")
    assert "not a regular file" in str(refused(tmp_path / "pipe.csv"))


def test_no_permission(write_log: WriteFile, monkeypatch: pytest.MonkeyPatch) -> None:
    """Root may read everything, so the refusal of the system is played."""
    path = write_log(GOOD)

    def deny(self: Path) -> bytes:
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr(Path, "read_bytes", deny)
    assert "no permission" in str(refused(path))


def test_a_disk_that_fails(write_log: WriteFile, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_log(GOOD)

    def fail(self: Path) -> bytes:
        raise OSError(5, "Input/output error", str(self))

    monkeypatch.setattr(Path, "read_bytes", fail)
    assert "Input/output error" in str(refused(path))


@pytest.mark.parametrize("suffix", sorted(READERS))
def test_empty_files(write_log: WriteFile, suffix: str) -> None:
    assert "the file is empty" in str(refused(write_log(b"", f"log{suffix}")))


@pytest.mark.parametrize("suffix", [".csv", ".csv.gz", ".mat", ".npz", *ANY_SIZE])
def test_two_gigabytes_are_refused_at_once(tmp_path: Path, suffix: str) -> None:
    """A sparse file: read, it would take seconds and 2 GB; refused, milliseconds."""
    path = tmp_path / f"log{suffix}"
    path.touch()
    os.truncate(path, TWO_GIGABYTES)
    start = time.perf_counter()
    error = refused(path)
    assert time.perf_counter() - start < 1.0
    if suffix not in ANY_SIZE:  # of which any size may be read, but this is none
        assert "2048 MB, more than the 512 MB" in str(error)
        assert "Parquet" in str(error.remedy)


def test_a_gzip_bomb_stops_at_the_limit(
    write_log: WriteFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "SIZE_LIMIT_BYTES", 3 * 2**20)
    path = write_log(gzip.compress(b"0" * (16 * 2**20)), "log.csv.gz")
    assert path.stat().st_size < 2**20
    assert "over 3 MB unpacked" in str(refused(path))


def test_truncated_gzip(write_log: WriteFile) -> None:
    packed = gzip.compress((GOOD * 1000).encode())
    half = packed[: len(packed) // 2]
    assert f"ends too early, after {len(half)} by" in str(refused(write_log(half, "log.csv.gz")))


@pytest.mark.parametrize("content", [GOOD.encode(), b"\x1f\x8b" + bytes(20)])
def test_what_is_no_gzip(write_log: WriteFile, content: bytes) -> None:
    said = str(refused(write_log(content, "log.csv.gz")))
    assert "not a sound gzip file; " in said  # and not what the library calls it


def test_an_empty_gzip(write_log: WriteFile) -> None:
    assert "empty" in str(refused(write_log(gzip.compress(b""), "log.txt.gz")))


@pytest.mark.parametrize(
    ("content", "what"),
    [
        (b"PK\x03\x04rest", "a zip archive"),
        (b"PAR1rest", "Parquet"),
        (b"MATLAB 5.0 MAT-file", "a MAT file"),
        (b"\x89HDF\r\n\x1a\n", "HDF5"),
        (b"#ROSBAG V2.0\n", "a ROS 1 bag"),
        (b"SQLite format 3\x00", "an SQLite file"),
        (b"\x89MCAP0\r\n", "MCAP"),
    ],
)
def test_another_format_under_a_wrong_name(write_log: WriteFile, content: bytes, what: str) -> None:
    error = refused(write_log(content))
    assert f"the content is {what}" in str(error)
    assert "rename" in str(error.remedy)


def test_gzip_is_known_by_its_content(write_log: WriteFile) -> None:
    """A log that lost the .gz of its name is read as if it had it; a damaged one is refused."""
    packed = gzip.compress(GOOD.encode())
    assert load(write_log(packed)).time_s.tolist() == [0.0, 1.0]
    assert "ends too early" in str(refused(write_log(packed[:-9], "cut.csv")))
    assert "the content is Parquet" in str(refused(write_log(gzip.compress(b"PAR1"), "odd.csv")))


def test_zeros_are_not_an_empty_file(write_log: WriteFile) -> None:
    """A logger that lost power leaves a file of its size and nothing in it."""
    assert "4096 bytes of nothing but zeros" in str(refused(write_log(bytes(4096))))


@pytest.mark.parametrize("name", BINARY)
@pytest.mark.parametrize("content", [b"PK\x03\x04" + bytes(60), b"PAR1" * 9, bytes(range(200))])
def test_no_library_speaks(write_log: WriteFile, name: str, content: bytes) -> None:
    """The user reads what is wrong with the file, not what a library calls it."""
    said = str(refused(write_log(content, name)))
    assert not re.search(r"Error|Arrow|Bad[A-Z]|struct|unpack |pickle", said), said


@pytest.mark.parametrize("name", BINARY)
def test_text_under_a_binary_name(write_log: WriteFile, name: str) -> None:
    assert "that can be read" in str(refused(write_log(GOOD, name)))


def test_what_is_compressed_as_a_whole_is_to_be_unpacked(write_log: WriteFile) -> None:
    error = refused(write_log(GOOD, "log.db3.zstd"))
    assert "compressed as a whole (got '.zstd'); unpack it first, with unzstd" in str(error)


def test_of_a_folder_a_file_is_asked_for(tmp_path: Path) -> None:
    """Of a recording of ROS 2 only one, for all its files are read together."""
    assert "name the files in it" in str(refused(tmp_path))
    (tmp_path / "metadata.yaml").touch()
    assert "name one of the files of the bag" in str(refused(tmp_path))


@pytest.mark.parametrize("name", ["log.xlsx", "log", "log.gz", ".csv", "log.bag.active"])
def test_unknown_endings_list_the_known_ones(write_log: WriteFile, name: str) -> None:
    error = refused(write_log(GOOD, name))
    assert "no reader knows" in str(error)
    assert ".csv, .txt" in str(error.remedy)
    assert ".parquet" in str(error.remedy)
