"""Compiled code follows every source that it was made from."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from fresh_process import printed_by

from softid.kernels import affine_simulation, affine_sums

NOT_COMPILED = {"softid.kernels.decorators", "softid.kernels.cache_invalidation"}
"""What kernels import but are not made from."""

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


def imported(name: str) -> set[str]:
    """Modules of kernels that one is made from, those that they are made from included."""
    source = Path(str(import_module(name).__file__)).read_text(encoding="utf-8")
    nodes = ast.walk(ast.parse(source))
    named = {str(node.module) for node in nodes if isinstance(node, ast.ImportFrom)}
    own = {module for module in named if module.startswith("softid.kernels.")} - NOT_COMPILED
    return own.union(*map(imported, own))


def test_the_affine_kernels_follow_all_that_they_are_made_from() -> None:
    """A source that is left out would go on with its old code where an installation is edited."""
    for kernels, count in ((affine_simulation, 6), (affine_sums, 8)):
        followed = {module.__name__ for module in kernels.SOURCES}
        assert followed == imported(kernels.__name__)
        assert len(followed) == len(kernels.SOURCES) == count


PRODUCTS = """
import numpy as np
from softid.kernels.affine_sums import sum_products

time_s, u = 0.01 * np.arange(999.0), 1.0 + np.sin(0.1 * np.arange(999.0))
theta = np.array([3e-3, 0.0143, 3.0, 0.95, 1.5e-3, 2.0, 0.28, 1.0])
gram, kept = np.empty((12, 12)), np.empty((11, 0))
given = time_s, u, np.ones(998, np.int16), np.cos(u), np.ones(999, np.bool_)
for values in given:
    values.flags.writeable = False
place = np.zeros(2, np.int64), 999, np.array([3.0, 0.0]), np.eye(2, 9)
sum_products(0, 1, theta, *given, 1.0, 0.0, *place, 0, kept, -1, np.empty(0), gram)
print(gram.tobytes().hex(), sum(sum_products.stats.cache_hits.values()))
"""


@pytest.mark.slow
def test_the_run_that_compiles_gives_what_later_ones_do(tmp_path: Path) -> None:
    """To the last digit: a diagnosis near a limit would else answer otherwise the second time."""
    runs = [printed_by(PRODUCTS, NUMBA_CACHE_DIR=str(tmp_path)).split() for _ in range(2)]
    assert [hits for _, hits in runs] == ["0", "1"]
    assert runs[0][0] == runs[1][0]
