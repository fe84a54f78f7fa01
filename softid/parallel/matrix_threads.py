"""How many threads matrix libraries take."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from contextvars import ContextVar
from functools import cache

from threadpoolctl import ThreadpoolController


@contextlib.contextmanager
def matrices_on_one_thread() -> Iterator[None]:
    """Keep matrix libraries to one thread inside the ``with`` block, or in a decorated function.

    The matrices of a fit are narrow: a second thread hardly helps, and where another program has
    the core, both wait for it, at many times the cost of the product.

    Examples
    --------
    >>> import numpy as np
    >>> with matrices_on_one_thread():
    ...     float(np.ones(2) @ np.ones(2))
    2.0
    """
    of_scipy = "scipy.linalg" in sys.modules
    if _limited.get() == of_scipy:  # to limit the same ones once more takes 0.04 ms
        yield
        return
    token = _limited.set(of_scipy)
    try:
        with _matrix_libraries(of_scipy).limit(limits=1, user_api="blas"):
            yield
    finally:
        _limited.reset(token)


_limited: ContextVar[bool | None] = ContextVar("_limited", default=None)
"""Whether the libraries that a block around this one limits hold that of scipy; None without one
in the same thread."""


@cache
def _matrix_libraries(of_scipy: bool) -> ThreadpoolController:
    """Those that are loaded; scipy brings one of its own. To look for them takes 1 ms."""
    del of_scipy
    return ThreadpoolController()
