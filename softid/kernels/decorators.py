"""How inner functions are compiled."""

from __future__ import annotations

from typing import Any

from numba import njit

_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}

inner: Any = njit(**_OPTIONS)
"""For a function that is called within a step. It counts no references to its arrays, which would
take longer than its arithmetic, so it must not make any: no views, copies or new arrays. It is kept
on disk as part of the kernel that calls it."""

inlined: Any = njit(forceinline=True, **_OPTIONS)
"""The same, written out where it is called."""

merged: Any = njit(inline="always", **_OPTIONS)
"""The same for a long function that is called once: it is not compiled by itself first."""
