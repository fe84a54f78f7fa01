"""Print what a whole fit takes of the processor and of memory as the log gets longer.

    python tests/benchmarks/cost_of_length.py --samples 100000 1000000 10000000

The work is that of `speed_of_fits.py`, `softid.fit` with the model named. Memory is the most that
was allocated at one time beside the log, as `tracemalloc` counts it in a second run of the fit. The
log is its times, pressures and contractions, of eight bytes each.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
import time
import tracemalloc
from dataclasses import replace

from work import log_of

import softid
from softid.log import Log


def seconds_of(log: Log) -> float:
    """Processor time of a fit; the copy has cut no segments yet."""
    fresh = replace(log)
    began = time.process_time()
    softid.fit(fresh, model="muscle")
    return time.process_time() - began


def peak_of(log: Log) -> int:
    """Bytes beside the log."""
    fresh = replace(log)
    tracemalloc.start()
    softid.fit(fresh, model="muscle")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, nargs="+", default=[10_000, 100_000, 1_000_000])
    seconds_of(log_of(1000, exact=False))  # nothing is compiled within what counts
    print("| samples | processor time | of a sample | memory beside the log | times the log |")
    print("|---|---|---|---|---|")
    for n in parser.parse_args().samples:
        log = log_of(n, exact=False)
        own = sum(
            values.nbytes for values in (log.time_s, *(c.values for c in log.channels.values()))
        )
        seconds, peak = seconds_of(log), peak_of(log)
        print(
            f"| {n} | {seconds:.3g} s | {1e9 * seconds / n:.0f} ns | {peak / 1e6:.3g} MB "
            f"| {peak / own:.2g} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
