"""Compiled code follows every source that it was made from."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ENTRY = """
from numba import njit
import inner
from softid.kernels.cache_invalidation import follow_sources

@njit(cache=True)
def outer():
    return inner.value()

follow_sources(outer, (inner,))
print(outer(), sum(outer.stats.cache_hits.values()))
"""
INNER = "from numba import njit\n@njit\ndef value():\n    return {}\n"


def test_a_changed_callee_is_compiled_anew(tmp_path: Path) -> None:
    """Three runs: compiled, taken from disk, and compiled again once the callee says 22, not 1."""
    (tmp_path / "entry.py").write_text(ENTRY)
    paths = os.pathsep.join([str(tmp_path), *sys.path])
    answers = []
    for number in (1, 1, 22):
        if not answers or number != 1:
            (tmp_path / "inner.py").write_text(INNER.format(number))
        answers.append(
            subprocess.run(
                [sys.executable, "entry.py"],
                cwd=tmp_path,
                env={**os.environ, "PYTHONPATH": paths, "NUMBA_CACHE_DIR": str(tmp_path / "disk")},
                capture_output=True,
                text=True,
                check=True,
            ).stdout.split()
        )
    assert answers == [["1", "0"], ["1", "1"], ["22", "0"]]
