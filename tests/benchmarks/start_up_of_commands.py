"""Print what the program takes as a whole process, beside importing numba alone.

Run from the root of the project::

    python tests/benchmarks/start_up_of_commands.py --warmup

The log has 1,000 samples. Every command runs several times and the least processor time counts,
with kernels and bytecode already on disk, in a folder of its own. ``--warmup`` first compiles all
kernels into an empty folder, by the clock as well, since it uses two processes.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from work import log_of

SAMPLES = 1000
SOFTID = (sys.executable, "-m", "softid_cli.main")


def cost(command: tuple[str, ...], environment: Mapping[str, str]) -> tuple[float, float]:
    """Processor time of a process and its children, and time by the clock, in seconds."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, env=environment, check=True, capture_output=True)
    seconds, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    worked = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return worked, seconds


def commands(folder: Path) -> dict[str, tuple[str, ...]]:
    log = log_of(SAMPLES, exact=False)
    table = folder / "log.csv"
    columns = [log.time_s, log.channels["pressure"].values, log.channels["contraction"].values]
    head = "time (s),pressure (kPa),contraction (mm)"
    np.savetxt(table, np.column_stack(columns), "%.5f", ",", header=head, comments="")
    fit = (*SOFTID, "fit", str(table), "--out", str(folder / "out"), "--force")
    return {
        "import numba": (sys.executable, "-c", "import numba"),
        "softid --help": (*SOFTID, "--help"),
        "softid fit LOG --model muscle --no-plots": (*fit, "--model", "muscle", "--no-plots"),
        "softid fit LOG --no-plots": (*fit, "--no-plots"),
        "softid fit LOG": fit,
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--warmup", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        known = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
        own = {"PYTHONPYCACHEPREFIX": str(folder / "bytecode"), "OPENBLAS_NUM_THREADS": "1"}
        environment = known | own
        if options.warmup:
            cached = environment | {"NUMBA_CACHE_DIR": str(folder / "kernels")}
            worked, seconds = cost((*SOFTID, "warmup"), cached)
            print(f"softid warmup, nothing compiled: {worked:.1f} s, {seconds:.1f} s by the clock")
            worked, seconds = cost((*SOFTID, "warmup"), cached)
            print(f"softid warmup, all compiled: {worked:.1f} s, {seconds:.1f} s by the clock")
        for what, command in commands(folder).items():
            least = min(cost(command, environment)[0] for _ in range(options.rounds + 1))
            print(f"{what}: {least:.2f} s of processor time", flush=True)


if __name__ == "__main__":
    main()
