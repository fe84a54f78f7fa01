"""Print what a whole fit takes of the processor and of memory as the log gets longer.

    python tests/benchmarks/cost_of_length.py --samples 100000 1000000 10000000
    python tests/benchmarks/cost_of_length.py --samples 10000 100000 --logs 4

The work is that of `speed_of_fits.py`, `softid.fit` with the model named; with ``--logs`` of so
many logs at once, each of that length with steps and noise of its own. Memory is the most that was
allocated at one time beside the logs, as `tracemalloc` counts it in a second run of the fit. A log
is its times, pressures and contractions, of eight bytes each.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
import time
import tracemalloc
from collections.abc import Sequence
from dataclasses import replace

from work import log_of

import softid
from softid.log import Log


def seconds_of(logs: Sequence[Log]) -> float:
    """Processor time of a fit; the copies have cut no segments yet."""
    fresh = [replace(log) for log in logs]
    began = time.process_time()
    softid.fit(fresh, model="muscle")
    return time.process_time() - began


def peak_of(logs: Sequence[Log]) -> int:
    """Bytes beside the logs."""
    fresh = [replace(log) for log in logs]
    tracemalloc.start()
    softid.fit(fresh, model="muscle")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, nargs="+", default=[10_000, 100_000, 1_000_000])
    parser.add_argument("--logs", type=int, default=1)
    asked = parser.parse_args()
    seconds_of([log_of(1000, exact=False)])  # nothing is compiled within what counts
    print("| samples | processor time | of a sample | memory beside the log | times the log |")
    print("|---|---|---|---|---|")
    for n in asked.samples:
        logs = [log_of(n, exact=False, seed=1 + k) for k in range(asked.logs)]
        own = sum(
            values.nbytes
            for log in logs
            for values in (log.time_s, *(c.values for c in log.channels.values()))
        )
        seconds, peak = seconds_of(logs), peak_of(logs)
        length = f"{asked.logs} × {n}" if asked.logs > 1 else f"{n}"
        print(
            f"| {length} | {seconds:.3g} s | {1e9 * seconds / (n * asked.logs):.0f} ns "
            f"| {peak / 1e6:.3g} MB | {peak / own:.2g} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
