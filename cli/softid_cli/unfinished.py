"""Where an interrupted diagnosis is kept, for the same command to go on from."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from softid_cli.requests import Request

DAYS = 7.0
"""An interrupted run is kept for so many days; who has not gone on with it by then hardly will."""

MOST = 3
"""Interrupted runs that are kept at once, the last ones, since each may take some GB."""

SUFFIX = ".checkpoint"

NO_MATTER = ("out", "force", "no_plots", "as_json", "quiet")
"""Options that say what becomes of the answer, and have no part in finding it."""


def unfinished_file(request: Request) -> Path:
    """The file of this command with these logs, in the user's cache folder.

    Whether logs and program are still the same is told by what is in it. Files of others that
    nobody has gone on with for `DAYS` are removed, and so are more than `MOST`.
    """
    from softid.fingerprint import content_fingerprint

    asked = {name: value for name, value in asdict(request).items() if name not in NO_MATTER}
    name = content_fingerprint(repr((type(request).__name__, Path.cwd(), asked)))[:16]
    file = unfinished_folder() / f"{name}{SUFFIX}"
    _tidy(file)
    return file


def unfinished_folder() -> Path:
    """The folder of all of them, which need not exist."""
    import platformdirs

    return platformdirs.user_cache_path("softid") / "unfinished"


def _tidy(own: Path) -> None:
    """Keep the last few, and none for ever."""
    from softid.records.checkpoint import is_in_use

    with suppress(OSError):  # whoever else tidies, or may not
        others = [(p.stat().st_mtime, p) for p in own.parent.glob(f"*{SUFFIX}") if p != own]
        oldest = time.time() - DAYS * 86400.0
        for rank, (written, path) in enumerate(sorted(others, reverse=True), start=2):
            if (rank > MOST or written < oldest) and not is_in_use(path):
                path.unlink()
