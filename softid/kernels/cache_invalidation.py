"""Compiled code on disk that is thrown away when any source that it was made from has changed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any


def follow_sources(kernel: Any, modules: Sequence[ModuleType]) -> None:
    """Let a kernel's cache depend on the sources of the modules that it calls, too.

    numba looks at the kernel's own file only, and would go on with old code where another file of
    an installation that is worked on has changed. Where its internals differ nothing happens.

    Parameters
    ----------
    kernel
        Compiled with ``cache=True``; what it calls in other modules must not be cached itself.
    modules
        The modules that it calls.
    """
    try:
        cache = kernel._cache._cache_file
        stamps = [Path(str(module.__file__)).stat() for module in modules]
        cache._source_stamp = (cache._source_stamp, *((s.st_mtime, s.st_size) for s in stamps))
    except (AttributeError, OSError):
        return
