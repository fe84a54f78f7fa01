"""Whether a first run has to compile, and where what it compiled is kept."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from fresh_process import printed_by
from numba import njit
from numba.core.caching import CacheImpl

from softid.kernels import when_compiling
from softid.kernels.decorators import bare_kernel, kernel

FIT = """
import numpy as np
import softid
from softid.kernels import when_compiling
time_s = 0.01 * np.arange(400)
pressure = np.where(time_s < 1.0, 20.0, 150.0) + 30.0 * (time_s > 2.5)
angle = 0.3 * np.convolve(pressure, np.exp(-time_s / 0.2) / 20.0)[:400]
noise = np.random.default_rng(0).normal(0.0, 0.05, 400)
log = softid.Log.from_arrays(time_s, {"pressure": pressure, "angle": angle + noise})
with when_compiling(lambda: print("compiles")):
    softid.fit(log, model="muscle")
print("fitted")
"""


@pytest.mark.slow
def test_a_second_run_finds_every_kernel(tmp_path: Path) -> None:
    """An empty cache has to be filled, which is said once; after one plain fit nothing is missing.

    A list of the kernels that a fit is thought to need would name one that it no longer calls, and
    every run would claim to compile.
    """
    said = [printed_by(FIT, NUMBA_CACHE_DIR=str(tmp_path)).split() for _ in range(2)]
    assert said == [["compiles", "fitted"], ["fitted"]]


def test_where_nothing_can_be_kept_functions_are_compiled_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """numba refuses to keep anything where neither the source's nor the user's folder can be
    written to; any other refusal is not swallowed.
    """
    monkeypatch.setattr(CacheImpl, "_locator_classes", [])

    def triple(x: float) -> float:
        return 3.0 * x

    for decorated in (kernel(triple), bare_kernel(triple)):
        assert decorated.stats.cache_path is None
        assert decorated(2.0) == 6.0
    monkeypatch.setattr("softid.kernels.decorators.NO_FOLDER", "another reason")
    with pytest.raises(RuntimeError, match="cannot cache"):
        kernel(triple)


def test_only_the_first_compilation_is_reported() -> None:
    """Two functions compile and one is compiled already: one report, and none outside the block."""
    said: list[str] = []
    known, first, second, late = (njit(lambda x, k=k: x + k) for k in range(4))
    known(1)
    with when_compiling(lambda: said.append("compiles")):
        known(1)
        assert said == []
        first(1)
        second(1)
    late(1)
    assert said == ["compiles"]


ROOT = Path(__file__).resolve().parents[2]
CACHED = (
    FIT
    + """
from softid.kernels import cache_folder
print(cache_folder())
"""
)


@pytest.mark.slow
def test_a_package_that_cannot_be_written_to_is_warmed_up_in_the_users_cache(
    tmp_path: Path,
) -> None:
    """A file where the cache folder would be stops even root; numba then asks the user's folder."""
    site, home = tmp_path / "site", tmp_path / "home"
    for package in (ROOT / "softid", ROOT / "cli" / "softid_cli"):
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(package, site / package.name, ignore=ignored)
    for folder in [site / "softid" / "kernels", site / "softid" / "effects"]:
        (folder / "__pycache__").touch()
    environment = {
        name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"
    } | {"PYTHONPATH": str(site), "HOME": str(home), "XDG_CACHE_HOME": str(home / ".cache")}

    def told(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *arguments],
            env=environment,
            cwd=home,
            capture_output=True,
            text=True,
            check=True,
        )

    home.mkdir()
    warmed = told("-m", "softid_cli", "warmup")
    assert "compiling for" in warmed.stderr
    folder = warmed.stdout.split()[-1].removesuffix(".")
    assert Path(folder).is_relative_to(home)
    assert told("-c", CACHED).stdout.split() == ["fitted", folder]
