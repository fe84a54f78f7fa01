"""The folder that gets a command's results."""

from __future__ import annotations

from pathlib import Path

from softid.errors import OutputError

RESULTS = Path("softid-out")
"""Where results go that the user names no folder for."""


def require_place_for_results(folder: Path | None, record: str, *, force: bool) -> None:
    """Say before the work, not after it, that the results would have no place.

    Parameters
    ----------
    folder
        What the user named, if anything.
    record
        File that tells that the folder holds results.
    force
        Whether these may be replaced.

    Raises
    ------
    OutputError
        The folder is a file, holds results that may not be replaced, or nothing can be written
        where it is to be.
    """
    if folder is not None and folder.is_file():
        raise OutputError(
            "this is a file, not a folder",
            where=str(folder),
            remedy="name another folder with --out",
        )
    if folder is not None and (folder / record).exists() and not force:
        raise OutputError(
            "the folder holds results already",
            where=str(folder),
            remedy="say --force to replace them, or name another folder with --out",
        )
    _require_writable(folder or RESULTS)


def _require_writable(folder: Path) -> None:
    """Try it where the folder is, or in the nearest of its parents that is there."""
    from tempfile import TemporaryDirectory  # brings what no other command needs

    whole = folder.absolute()
    nearest = next(path for path in (whole, *whole.parents) if path.exists())
    try:
        with TemporaryDirectory(prefix=".softid-", dir=nearest):
            pass
    except OSError as error:
        raise OutputError(
            "nothing can be written here",
            where=str(folder),
            value=error.strerror or type(error).__name__,
            remedy="name another folder with --out",
        ) from None


def free_folder(wanted: Path) -> Path:
    """The folder, or the first of ``-2``, ``-3``, … that does not exist."""
    folder, number = wanted, 1
    while folder.exists():
        number += 1
        folder = wanted.with_name(f"{wanted.name}-{number}")
    return folder
