"""Which runs compile, so that one can say why it is slow, and where what they compile is kept."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from numba.core import event

from softid.kernels.affine_simulation import move

COMPILES = "numba:compile"
"""numba's event of a function that is compiled, not loaded from disk."""


@contextmanager
def when_compiling(report: Callable[[], None]) -> Iterator[None]:
    """Call a function once, as soon as something has to be compiled.

    Parameters
    ----------
    report
        Called before the first compilation inside the ``with`` block; never when all that is needed
        lies compiled on disk.

    Examples
    --------
    >>> from numba import njit
    >>> with when_compiling(lambda: print("compiling")):
    ...     njit(lambda x: 2 * x)(21)
    compiling
    42
    """
    with event.install_listener(COMPILES, _First(report)):
        yield


class _First(event.Listener):
    """Reports the start of the first of several events."""

    def __init__(self, report: Callable[[], None]) -> None:
        self._report: Callable[[], None] | None = report

    def on_start(self, event: object) -> None:
        del event
        report, self._report = self._report, None
        if report is not None:
            report()

    def on_end(self, event: object) -> None:
        """Nothing is said at the end."""


def cache_folder() -> Path | None:
    """Where the compiled kernels are kept, or None where no folder can be written to.

    Beside the source; where that is read-only, in numba's cache folder of the user or in the folder
    that ``NUMBA_CACHE_DIR`` names.
    """
    folder = move.stats.cache_path
    return None if folder is None else Path(str(folder))
