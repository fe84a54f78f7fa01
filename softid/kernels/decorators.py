"""How inner functions are compiled."""

from __future__ import annotations

from typing import Any

from numba import njit

_OPTIONS: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "_nrt": False}

inner: Any = njit(**_OPTIONS)
"""For a function that is called within a step. It counts no references to its arrays, which would
take longer than its arithmetic, so it must not make any: no views, copies or new arrays."""

inlined: Any = njit(forceinline=True, **_OPTIONS)
"""The same, written out where it is called."""
