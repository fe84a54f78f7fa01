"""Fixtures shared by all tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

MEASURED_VARIABLE = "SOFTID_MEASURED_DATA"


def pytest_configure() -> None:
    """One core for each of the processes that share the tests, which share nothing out again."""
    number = os.environ.get("PYTEST_XDIST_WORKER", "").removeprefix("gw")
    if number.isdecimal() and hasattr(os, "sched_setaffinity"):
        cores = sorted(os.sched_getaffinity(0))
        os.sched_setaffinity(0, {cores[int(number) % len(cores)]})


@pytest.fixture(scope="session")
def measured() -> Path:
    """Folder of measured logs, named by an environment variable or lying beside the checkout."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get(MEASURED_VARIABLE, beside))
    if not folder.is_dir():
        pytest.skip(f"no measured logs: set {MEASURED_VARIABLE} to their folder")
    return folder
