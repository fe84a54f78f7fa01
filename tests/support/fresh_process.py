"""Code that runs in a Python of its own, where nothing is imported yet."""

from __future__ import annotations

import os
import subprocess
import sys


def printed_by(code: str, **environment: str) -> str:
    """What it prints; it must end well and complain of nothing."""
    path = os.pathsep.join(folder for folder in sys.path if folder)
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": path, **environment},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout
