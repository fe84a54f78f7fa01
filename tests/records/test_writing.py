"""Files are there whole or not at all."""

from __future__ import annotations

import errno
import os
import signal
import stat
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from handmade import simulation, step_log

from softid.errors import OutputError
from softid.records import (
    plot_fingerprints,
    recorded_plots,
    simulation_csv,
    to_jsonable,
    write_atomic,
    write_folder,
)
from softid.records.simulated import column_name


def fail_with(monkeypatch: pytest.MonkeyPatch, function: str, number: int) -> None:
    def failing(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, function, failing)


def test_text_is_written_as_it_is(tmp_path: Path) -> None:
    """Bytes for bytes: no platform line ends, UTF-8, the umask's permissions."""
    path = tmp_path / "a.csv"
    write_atomic(path, "θ\n1\r\n")
    assert path.read_bytes() == "θ\n1\r\n".encode()
    umask = os.umask(0)
    os.umask(umask)
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~umask
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES, errno.EROFS, errno.EIO])
@pytest.mark.parametrize("function", ["fsync", "replace"])
def test_a_failed_write_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, function: str
) -> None:
    """A full disk shows at flush, a read-only one at rename: one sentence, the old file stays."""
    path = tmp_path / "params.json"
    path.write_text("old")
    fail_with(monkeypatch, function, number)
    with pytest.raises(OutputError) as caught:
        write_atomic(path, "new", overwrite=True)
    assert os.strerror(number).lower() in str(caught.value)
    assert caught.value.remedy
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_really_full_device_is_an_output_error() -> None:
    """Linux' /dev/full answers every write with ENOSPC; its folder is no place for our files."""
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full on this system")
    with pytest.raises(OutputError, match="device, not a file"):
        write_atomic(Path("/dev/full"), "x", overwrite=True)


def test_missing_parent(tmp_path: Path) -> None:
    """`write_atomic` makes no folders; the error says which path and what to do."""
    with pytest.raises(OutputError, match="make the folder first"):
        write_atomic(tmp_path / "no" / "a.json", "x")


def test_below_a_file(tmp_path: Path) -> None:
    """A path through a file cannot be made by any permission."""
    (tmp_path / "a").write_text("")
    with pytest.raises(OutputError, match="file"):
        write_folder(tmp_path / "a" / "b", {"x": "1"})
    with pytest.raises(OutputError, match="a file, not a folder"):
        write_folder(tmp_path / "a", {"x": "1"})


def test_an_interrupt_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C between two files of a set: the new folder must not appear half full."""
    calls = []

    def interrupt(descriptor: int) -> None:
        calls.append(descriptor)
        if len(calls) == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_folder(tmp_path / "new" / "deep", {"a": "1", "b": "2"})
    assert list(tmp_path.iterdir()) == []


def test_a_folder_is_whole_or_absent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All files appear at once in a new folder; a refusal touches none of an old one."""
    folder = tmp_path / "out" / "step"
    paths = write_folder(folder, {"a.txt": "1", "b.png": b"2"})
    assert [p.read_bytes() for p in paths] == [b"1", b"2"]
    with pytest.raises(OutputError, match=r"b\.png: the file exists already"):
        write_folder(folder, {"c.txt": "3", "b.png": b"4"})
    assert sorted(p.name for p in folder.iterdir()) == ["a.txt", "b.png"]
    fail_with(monkeypatch, "fsync", errno.ENOSPC)
    with pytest.raises(OutputError, match="no space left"):
        write_folder(folder, {"a.txt": "9"}, overwrite=True)
    assert (folder / "a.txt").read_text() == "1"
    assert sorted(p.name for p in folder.iterdir()) == ["a.txt", "b.png"]


def test_a_full_disk_leaves_no_part_of_a_tree(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Recipes without data are as little use as half a file; subfolders are made with the rest."""
    tree = {"recipes/a.toml": "1", "data/a.csv": "2", "manifest.json": "3"}
    with monkeypatch.context() as full:
        fail_with(full, "fsync", errno.ENOSPC)
        with pytest.raises(OutputError, match="no space left"):
            write_folder(tmp_path / "new" / "set", tree)
    assert list(tmp_path.iterdir()) == []
    write_folder(tmp_path / "set", {"manifest.json": "0"})
    paths = write_folder(tmp_path / "set", tree, overwrite=True)
    assert [p.read_text() for p in paths] == ["1", "2", "3"]
    assert sorted(p.name for p in (tmp_path / "set").iterdir()) == [
        "data",
        "manifest.json",
        "recipes",
    ]


def test_only_unchanged_files_beside_the_new_ones_are_superseded(tmp_path: Path) -> None:
    """A record edited by hand may name anything: what is outside, or is not that file, stays."""
    out = tmp_path / "out"
    known = {"old.png": b"1", "changed.png": b"2", "../params.png": b"3", "new.png": b"4"}
    out.mkdir()
    for name, data in known.items():
        (out / name).write_bytes(data)
    (out / "changed.png").write_bytes(b"22")
    prints = plot_fingerprints(known) | {"none.png": "0" * 64}
    write_folder(out, {"new.png": b"4"}, overwrite=True, superseded=prints)
    assert sorted(p.name for p in out.iterdir()) == ["changed.png", "new.png"]
    assert (tmp_path / "params.png").exists()


@pytest.mark.parametrize(
    "content", ["", "[1]", '{"plots": ["a.png"]}', '{"plots": {"a.txt": "0"}}']
)
def test_a_record_that_says_nothing_of_plots(tmp_path: Path, content: str) -> None:
    """Whatever lies there, the new result is written; only known plots are looked for."""
    (tmp_path / "params.json").write_text(content)
    assert recorded_plots(tmp_path / "params.json") == {}
    assert recorded_plots(tmp_path / "none.json") == {}


@pytest.fixture
def is_heard() -> Iterator[None]:
    """Ctrl-C raises; tests that run in the background are started deaf to it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("is_heard")
def test_an_interrupt_waits_for_the_last_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C while files of an old folder are replaced: all are new, then it counts."""
    write_folder(tmp_path / "out", {"a": "1", "b": "1"})
    replace = os.replace

    def interrupted(source: Path, target: Path) -> None:
        signal.raise_signal(signal.SIGINT)
        replace(source, target)

    monkeypatch.setattr(os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_folder(tmp_path / "out", {"a": "2", "b": "2"}, overwrite=True)
    assert {p.name: p.read_text() for p in (tmp_path / "out").iterdir()} == {"a": "2", "b": "2"}


def test_writing_into_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`--out .` keeps what is there and adds the results."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "step.csv").write_text("t")
    write_folder(Path(), {"params.json": "{}"})
    assert sorted(p.name for p in tmp_path.iterdir()) == ["params.json", "step.csv"]


def test_a_link_is_written_through(tmp_path: Path) -> None:
    """A link to results on another disk stays a link."""
    real, link = tmp_path / "real.json", tmp_path / "link.json"
    real.write_text("old")
    link.symlink_to(real)
    write_atomic(link, "new", overwrite=True)
    assert link.is_symlink()
    assert real.read_text() == "new"


def test_simulation_csv_has_units_and_every_digit() -> None:
    """Numbers are their repr, so reading them back gives the same floats."""
    log = step_log(samples=3)
    text = simulation_csv(simulation(log), display={"angle": ("deg", 180 / np.pi)})
    lines = text.splitlines()
    assert lines[0] == "time_s,pressure_kpa,angle_deg,measured_angle_deg"
    time_s, pressure_kpa, angle_deg, measured_deg = map(float, lines[2].split(","))
    assert (time_s, pressure_kpa) == (log.time_s[1], log.pressure_kpa[1])
    assert angle_deg == (log.channels["angle"].values[1] + 0.01) * (180 / np.pi)
    assert measured_deg == log.channels["angle"].values[1] * (180 / np.pi)


@pytest.mark.parametrize(
    ("unit", "column"),
    [("N·mm", "y_nmm"), ("kPa", "y_kpa"), ("1", "y"), ("", "y"), ("°", "y_deg"), ("rad", "y_rad")],
)
def test_column_names(unit: str, column: str) -> None:
    """Names that need no quoting in any language: lower-case letters and digits."""
    assert column_name("y", unit) == column


def test_what_json_cannot_hold_is_refused() -> None:
    """A live object in a result is a mistake, not something to print as text."""
    with pytest.raises(TypeError, match="object has no JSON form"):
        to_jsonable({"x": object()})
