"""Files that are there whole or not at all."""

from __future__ import annotations

import errno
import os
import secrets
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from softid.errors import OutputError
from softid.fingerprint import content_fingerprint
from softid.interrupts import uninterrupted

_REMEDIES = {
    errno.ENOSPC: "free some space or name another folder, in commands with --out",
    errno.EDQUOT: "free some space or name another folder, in commands with --out",
    errno.EACCES: "name a folder in which you may write, in commands with --out",
    errno.EPERM: "name a folder in which you may write, in commands with --out",
    errno.EROFS: "name a folder in which you may write, in commands with --out",
    errno.ENOENT: "make the folder first, or name another, in commands with --out",
    errno.ENOTDIR: "name a folder, not something below a file, in commands with --out",
    errno.ENAMETOOLONG: "choose a shorter name, in commands with --out",
}
_NEW_FILE = 0o666  # the process' umask takes away what the user does not want to give


def write_atomic(path: Path, data: str | bytes, *, overwrite: bool = False) -> None:
    """Write a file so that it is either there in full or not at all.

    The data go to a new file beside the target, are flushed to the disk and take the target's
    name in one step.

    Parameters
    ----------
    path
        Target; its folder must exist.
    data
        Text (written as UTF-8 with the line ends it has) or bytes.
    overwrite
        Whether a file of that name may be replaced.

    Raises
    ------
    OutputError
        The file exists and may not be replaced, is no plain file, or cannot be written.
    """
    target = Path(path)
    with _as_output_error(target):
        _check_target(target, overwrite=overwrite)
        target = target.resolve()
        staged = target.with_name(f".{secrets.token_hex(6)}.tmp")
        try:
            _write_synced(staged, data)
            os.replace(staged, target)
        except BaseException:
            staged.unlink(missing_ok=True)
            raise


def write_folder(
    folder: Path,
    files: Mapping[str, str | bytes],
    *,
    overwrite: bool = False,
    superseded: Mapping[str, str] | None = None,
) -> tuple[Path, ...]:
    """Write several files into one folder: all of them, or none when the folder is new.

    They are written beside their places first and take their names together at the end, which an
    interruption waits for.

    Parameters
    ----------
    folder
        Target; it and its parents are made when missing.
    files
        File name, possibly below a subfolder (``"data/a.csv"``) → text or bytes.
    overwrite
        Whether files of those names may be replaced; other files in the folder stay.
    superseded
        File name → sha256 of files of an earlier result. With ``overwrite`` they go, unless they
        were changed since or are written anew.

    Returns
    -------
    tuple of Path
        The files, in the order given.

    Raises
    ------
    OutputError
        A file exists and may not be replaced, or something cannot be written.
    """
    real = Path(folder).resolve()
    with _as_output_error(folder):
        if real.exists() and not real.is_dir():
            raise OutputError(
                "this is a file, not a folder",
                where=str(folder),
                remedy="name another folder",
            )
        for name in files:
            _check_target(Path(folder) / name, overwrite=overwrite)
        made = [p for p in real.parents if not p.exists()]
        token = f".{secrets.token_hex(6)}.tmp"
        staged = real / token if real.exists() else real.with_name(token)
        try:
            staged.mkdir(parents=True)
            for name, data in files.items():
                (staged / name).parent.mkdir(exist_ok=True)
                _write_synced(staged / name, data)
            old = _unchanged(real, superseded or {}) if overwrite else []
            with uninterrupted():
                _move_into_place(staged, real, files)
                for path in old:
                    if path.name not in files:
                        path.unlink(missing_ok=True)
        except BaseException:
            shutil.rmtree(staged, ignore_errors=True)
            _remove_empty(made)
            raise
    return tuple(Path(folder) / name for name in files)


def _move_into_place(staged: Path, folder: Path, names: Mapping[str, str | bytes]) -> None:
    if not folder.exists():
        staged.rename(folder)
        return
    for name in names:
        (folder / name).parent.mkdir(exist_ok=True)
        os.replace(staged / name, folder / name)
    shutil.rmtree(staged)


def _unchanged(folder: Path, known: Mapping[str, str]) -> list[Path]:
    """The files that are still what they were when they were recorded."""
    plain = [(folder / name, sha256) for name, sha256 in known.items() if Path(name).name == name]
    return [
        path
        for path, sha256 in plain
        if path.is_file() and content_fingerprint(path.read_bytes()) == sha256
    ]


def _remove_empty(folders: Sequence[Path]) -> None:
    for folder in folders:
        with suppress(OSError):  # somebody else has put something there meanwhile
            folder.rmdir()


def _write_synced(path: Path, data: str | bytes) -> None:
    content = data.encode() if isinstance(data, str) else data
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, _NEW_FILE)
    with os.fdopen(descriptor, "wb") as stream:
        stream.write(content)
        stream.flush()
        os.fsync(stream.fileno())


def _check_target(path: Path, *, overwrite: bool) -> None:
    if path.is_dir():
        raise OutputError(
            "this is a folder, not a file", where=str(path), remedy="name a file in it"
        )
    if path.exists() and not path.is_file():
        raise OutputError(
            "this is a device, not a file that can be replaced",
            where=str(path),
            remedy="name another file, or use the shell's > to write there",
        )
    if path.exists() and not overwrite:
        raise OutputError(
            "the file exists already",
            where=str(path),
            remedy="say --force (overwrite=True in Python) to replace it, or name another place",
        )


@contextmanager
def _as_output_error(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise OutputError(
            f"cannot be written ({reason.lower()})",
            where=str(path),
            remedy=_REMEDIES.get(error.errno or 0, "name another place, in commands with --out"),
        ) from error
