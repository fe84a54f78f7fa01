"""How many threads matrix libraries take."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
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
    with _matrix_libraries("scipy.linalg" in sys.modules).limit(limits=1, user_api="blas"):
        yield


@cache
def _matrix_libraries(of_scipy: bool) -> ThreadpoolController:
    """Those that are loaded; scipy brings one of its own. To look for them takes 1 ms."""
    del of_scipy
    return ThreadpoolController()
