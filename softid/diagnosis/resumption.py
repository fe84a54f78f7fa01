"""The checkpoint of a diagnosis, and what it belongs to.

What a diagnosis does follows from its arguments and from the program. A run goes on from what an
interrupted one has kept only where both are the same to the last digit.
"""

from __future__ import annotations

import contextlib
import inspect
from collections.abc import Iterable, Iterator, Mapping
from hashlib import sha256
from os import stat_result
from pathlib import Path

from softid.effects import effects_of
from softid.errors import UsageError
from softid.parallel import KnownObjects, kept_in
from softid.records.checkpoint import Checkpoint
from softid.records.params import versions


@contextlib.contextmanager
def resumable(path: str | Path | None, arguments: Mapping[str, object]) -> Iterator[bool]:
    """Keep in a file what the ``with`` block shares out and does, and take what is kept there.

    Yields whether an interrupted run has left anything.

    Parameters
    ----------
    path
        The file; without one nothing is kept.
    arguments
        All that the answer follows from.

    Raises
    ------
    UsageError
        The path is none, or leads to something that is no checkpoint.
    """
    if path is None:
        yield False
        return
    with Checkpoint(_file(path), _key(arguments)) as checkpoint, kept_in(checkpoint):
        yield checkpoint.goes_on


def _file(path: str | Path) -> Path:
    try:
        return Path(path).expanduser()
    except (TypeError, RuntimeError) as error:  # a number, or the home of nobody
        raise UsageError(
            "this is no path",
            where="checkpoint",
            value=str(path),
            remedy="name a file that does not exist yet",
        ) from error


def _key(arguments: Mapping[str, object]) -> str:
    """The same for the same program with the same arguments."""
    laws = effects_of(())
    sources = [*_own_sources(), *_sources_of((*laws, arguments.get("model")))]
    stamps = [(str(source), *_stamp(source.stat())) for source in sources]
    told = KnownObjects(dict(arguments), laws, all_numbers=True).digest
    return sha256(repr((versions(), stamps, told)).encode()).hexdigest()


def _own_sources() -> list[Path]:
    return sorted(Path(__file__).parents[1].rglob("*.py"))


def _sources_of(things: Iterable[object]) -> list[Path]:
    """Where their classes are written, also those of a user's script."""
    files = set()
    for thing in things:
        with contextlib.suppress(TypeError):  # its class was built in, or typed at a prompt
            files.add(inspect.getsourcefile(type(thing)))
    return sorted(path for file in files if file and (path := Path(file)).is_file())


def _stamp(file: stat_result) -> tuple[int, int]:
    return file.st_mtime_ns, file.st_size
