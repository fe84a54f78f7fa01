"""Whether a first run has to compile."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

FIT = """
import numpy as np
import softid
from softid.kernels.compilation import needs_compiling
time_s = 0.01 * np.arange(400)
pressure = np.where(time_s < 1.0, 20.0, 150.0) + 30.0 * (time_s > 2.5)
angle = 0.3 * np.convolve(pressure, np.exp(-time_s / 0.2) / 20.0)[:400]
noise = np.random.default_rng(0).normal(0.0, 0.05, 400)
log = softid.Log.from_arrays(time_s, {"pressure": pressure, "angle": angle + noise})
print(needs_compiling())
softid.fit(log, model="muscle")
"""


@pytest.mark.slow
def test_a_second_run_finds_every_kernel(tmp_path: Path) -> None:
    """An empty cache has to be filled; after one plain fit nothing is missing in it."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    environment["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    said = [
        subprocess.run(
            [sys.executable, "-c", FIT],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()[0]
        for _ in range(2)
    ]
    assert said == ["True", "False"]
