"""Loading of compiled functions from disk."""

from __future__ import annotations

from pathlib import Path

from fresh_process import printed_by

LOAD = """
import sys
import numpy as np
from softid.kernels.muscle import coefficients
coefficients(np.ones(3), np.ones(7))
hits = sum(coefficients.stats.cache_hits.values())
print(hits, "numba.np.linalg" in sys.modules, "scipy.linalg" in sys.modules)
"""


def test_a_function_on_disk_is_loaded_without_what_compiles(tmp_path: Path) -> None:
    """The first run compiles with all of numba; the second takes it from disk without scipy."""
    said = [printed_by(LOAD, NUMBA_CACHE_DIR=str(tmp_path)).split() for _ in range(2)]
    assert said == [["0", "True", "True"], ["1", "False", "False"]]
