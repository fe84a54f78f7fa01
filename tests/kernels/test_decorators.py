"""Loading of compiled functions from disk."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

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
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    environment["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    said = [
        subprocess.run(
            [sys.executable, "-c", LOAD],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()
        for _ in range(2)
    ]
    assert said == [["0", "True", "True"], ["1", "False", "False"]]
