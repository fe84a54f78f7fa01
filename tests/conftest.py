"""Fixtures shared by all tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

MEASURED_VARIABLE = "SOFTID_MEASURED_DATA"


@pytest.fixture(scope="session")
def measured() -> Path:
    """Folder of measured logs, named by an environment variable or lying beside the checkout."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get(MEASURED_VARIABLE, beside))
    if not folder.is_dir():
        pytest.skip(f"no measured logs: set {MEASURED_VARIABLE} to their folder")
    return folder
