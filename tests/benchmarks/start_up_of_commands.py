"""Print what the program takes as a whole process, beside importing numba alone.

Run from the root of the project::

    python tests/benchmarks/start_up_of_commands.py --warmup

The log has 1,000 samples. Every command runs several times and the least time counts, of the
processor and by the clock, since some work in two processes. Kernels and bytecode are on disk, in a
folder of its own. ``--warmup`` first compiles what a fit needs into an empty folder, then all
kernels into another one.
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


def tell(what: str, worked: float, seconds: float) -> None:
    print(f"{what}: {worked:.2f} s of processor time, {seconds:.2f} s by the clock", flush=True)


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
        known_commands = commands(folder)
        if options.warmup:
            without_plots = "softid fit LOG --no-plots"
            for what, command in (
                (without_plots, known_commands[without_plots]),
                ("softid warmup", (*SOFTID, "warmup")),
            ):
                cached = environment | {"NUMBA_CACHE_DIR": str(folder / what.replace(" ", "-"))}
                tell(f"{what}, nothing compiled", *cost(command, cached))
                tell(f"{what}, all compiled", *cost(command, cached))
        for what, command in known_commands.items():
            rounds = [cost(command, environment) for _ in range(options.rounds + 1)]
            worked, seconds = (min(column) for column in zip(*rounds, strict=True))
            tell(what, worked, seconds)


if __name__ == "__main__":
    main()
