"""`import softid` costs nothing, and every name it promises is there."""

from __future__ import annotations

import subprocess
import sys

import softid

HEAVY = ("numpy", "scipy", "numba", "pandas", "matplotlib", "lmfit", "pint", "rich")


def test_every_public_name_can_be_had() -> None:
    for name in softid.__all__:
        assert getattr(softid, name) is not None


def test_import_is_light() -> None:
    """In a process of its own, since this one has imported everything."""
    code = f"import softid, sys; print([m for m in {HEAVY!r} if m in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout.strip() == "[]"
