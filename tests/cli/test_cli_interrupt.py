"""Ctrl-C in a process of its own: one sentence, exit code 130, nothing half-written."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LOG = ROOT / "datasets_synthetic" / "data" / "demo_step.csv"

INTERRUPT_AT = """
import os, signal, sys
from pathlib import Path

# A job in the background of a shell is born deaf to Ctrl-C, and so are its children.
signal.signal(signal.SIGINT, signal.default_int_handler)

def interrupt():
    os.kill(os.getpid(), signal.SIGINT)

{setup}
sys.argv = ["softid", *{arguments!r}]
from softid_cli.entry import main
main()
"""

WHILE_IMPORTING = """
class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            interrupt()
sys.meta_path.insert(0, Finder())
"""

WHILE_WRITING = """
written = []
fsync = os.fsync
def half(descriptor):
    written.append(descriptor)
    if len(written) == 2:
        interrupt()
    fsync(descriptor)
os.fsync = half
"""

SWALLOWED = """
import softid.identification
def fit(*arguments, **options):
    try:
        interrupt()
    except KeyboardInterrupt:
        raise RuntimeError("a library's own words") from None
softid.identification.fit = fit
"""

ONCE_DONE = """
import atexit
atexit.register(interrupt)
"""

MOMENTS = {
    "importing click": WHILE_IMPORTING.format(module="click"),
    "importing numpy": WHILE_IMPORTING.format(module="numpy"),
    "importing the fit": WHILE_IMPORTING.format(module="softid.identification"),
    "importing plots": WHILE_IMPORTING.format(module="softid.plots"),
    "writing": WHILE_WRITING,
    "taken for a failure": SWALLOWED,
}


def run(setup: str, folder: Path) -> subprocess.CompletedProcess[str]:
    arguments = ["fit", str(LOG), "--model", "polynomial", "--quiet"]
    code = INTERRUPT_AT.format(setup=setup, arguments=arguments)
    path = os.pathsep.join([str(ROOT), str(ROOT / "cli")])
    return subprocess.run(
        [sys.executable, "-c", code],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="Ctrl-C is no signal here")
@pytest.mark.parametrize("moment", MOMENTS)
def test_an_interrupted_run(tmp_path: Path, moment: str) -> None:
    """130 is 128 + SIGINT (2), as shells have it; the folder is as empty as before."""
    told = run(MOMENTS[moment], tmp_path)
    assert told.returncode == 130, told.stderr
    assert told.stderr.splitlines()[-1] == "softid: interrupted."
    assert "Traceback" not in told.stderr
    assert told.stdout == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="Ctrl-C is no signal here")
def test_too_late_to_interrupt(tmp_path: Path) -> None:
    """All is written and printed: the run has succeeded, and says nothing of the signal.

    Progress is not shown, for how much of it there is depends on how busy the machine is.
    """
    told = run(ONCE_DONE, tmp_path)
    assert (told.returncode, told.stderr) == (0, "")
    assert (tmp_path / "softid-out" / "demo_step" / "params.json").exists()
    assert "params.json" in told.stdout
