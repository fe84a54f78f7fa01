"""How inner functions are compiled."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from numba import njit

if TYPE_CHECKING:
    from numba.core.dispatcher import Dispatcher

F = TypeVar("F", bound=Callable[..., Any])

NO_FOLDER = "no locator available"
"""What numba says where it can keep nothing."""

_OPTIONS: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "_nrt": False,
    "fastmath": {"contract", "nsz"},
}

SUMMING = {"contract", "nsz", "reassoc"}
"""What a function that only sums may rearrange, so that it takes vector instructions."""


def kernel(function: F) -> Dispatcher[F]:
    """Compile a function that is called from Python, and keep it on disk.

    Parameters
    ----------
    function
        What to compile.
    """
    return _kept(function, {"nogil": True, "error_model": "numpy"})


def bare_kernel(function: F) -> Dispatcher[F]:
    """`kernel` for a function that makes no arrays, as `inner`.

    Parameters
    ----------
    function
        What to compile.
    """
    return _kept(function, _OPTIONS)


def _kept(function: F, options: dict[str, Any]) -> Dispatcher[F]:
    """Compile and keep on disk; where no folder can be written to, compile in every run.

    Such a machine is a container that runs under an unknown user without a home. numba refuses to
    keep anything there, which must not stop a fit.
    """
    compiled: Dispatcher[F]
    try:
        compiled = njit(cache=True, **options)(function)
        load_alone(compiled)
    except RuntimeError as refusal:
        if NO_FOLDER not in str(refusal):
            raise
        compiled = njit(**options)(function)
    return compiled


def load_alone(compiled: Any) -> None:
    """Load a compiled function from disk without what only a compilation needs.

    numba would first import all functions that it can compile, scipy's linear algebra among them,
    which takes longer than a fit. Where its internals differ it does so as ever.

    Parameters
    ----------
    compiled
        Compiled with ``cache=True``.
    """
    try:
        from numba.core.runtime import nrt

        cache = compiled._cache
        load, guard = cache._load_overload, cache._guard_against_spurious_io_errors
        start = nrt.rtsys.initialize
    except (AttributeError, ImportError):
        return

    def load_overload(signature: Any, target: Any) -> Any:
        start(target)
        with guard():
            return load(signature, target)

    cache.load_overload = load_overload


inner: Any = njit(**_OPTIONS)
"""For a function that is called within a step. It counts no references to its arrays, which would
take longer than its arithmetic, so it must not make any: no views, copies or new arrays. It is kept
on disk as part of the kernel that calls it."""

inlined: Any = njit(inline="always", **_OPTIONS)
"""For a function that is written out where it is called, and nowhere compiled by itself; as
`inner`, it must not make any arrays."""
