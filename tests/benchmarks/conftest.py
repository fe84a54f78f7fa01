"""Benchmarks run when asked for: ``pytest --benchmark-only tests/benchmarks``."""

from __future__ import annotations

from pathlib import Path

import pytest


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    asked = config.getoption("benchmark_only", default=False)
    return None if asked or collection_path.suffix != ".py" else True
