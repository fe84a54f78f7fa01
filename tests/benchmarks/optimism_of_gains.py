"""Print what a correction gains on a log that took no part, beside the gain that is told.

Run from the root of the project::

    python tests/benchmarks/optimism_of_gains.py --draws 1

What is held out decides which causes are added, so the gain on it may be too good. The same
actuator with the same hidden effects is recorded once more, and `softid.validate` scores the base
and the extended model on that log.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable

import numpy as np
from diagnosis_cases import Case, cases

import softid
from softid.diagnosis_results import Diagnosis
from softid.log import Log
from softid.synthesis import hidden_pair

ANOTHER = 10**6
"""Added to the seed of a case, for the log that takes no part."""


def main() -> None:
    """Diagnose the cases and print one line for each, and what they have in common."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kinds", default="single,pair")
    parser.add_argument("--draws", type=int, default=1)
    parser.add_argument("--seed", type=int, default=77_000)
    asked = parser.parse_args()
    rows = []
    for kind in asked.kinds.split(","):
        for case in cases(kind, asked.draws, asked.seed):
            row = gains_of(case)
            if row is not None:
                told, apart, interval = row
                print(
                    f"{'+'.join(case.names):45s} told {told:6.3f} "
                    f"[{interval[0]:.3f}, {interval[1]:.3f}], on another log {apart:6.3f}",
                    flush=True,
                )
                rows.append((apart - told, interval[0] <= apart <= interval[1]))
    falls, within = zip(*rows, strict=True)
    print(
        f"{len(rows)} diagnoses: another log minus told {np.median(falls):+.3f} in the median, "
        f"mean {np.mean(falls):+.3f} ± {np.std(falls) / math.sqrt(len(falls)):.3f}, "
        f"{np.min(falls):+.3f} at worst; within the interval {np.mean(within):.0%}"
    )


def gains_of(case: Case) -> tuple[float, float, tuple[float, float]] | None:
    """The gain that is told, that on another log, and the interval; None without causes."""
    pair = case.pair()
    fitted, judge = pair.logs
    found = softid.diagnose(fitted, hold_out=judge, model=case.model)
    if found.extended is None or found.gain_ci95 is None:
        return None
    again = hidden_pair(
        case.names,
        seed=case.seed + ANOTHER,
        protocol=case.protocol,
        actuator=pair.actuator,
        values=pair.hidden,
    )
    return _told(found), _gain_on(found, again.hold_out.to_log()), found.gain_ci95


def _told(found: Diagnosis) -> float:
    held_out = [gain for gain in found.gains if gain.held_out]
    return _gain((g.rmse_before for g in held_out), (g.rmse_after for g in held_out))


def _gain_on(found: Diagnosis, log: Log) -> float:
    assert found.extended is not None
    before, after = (
        [s.rmse for s in softid.validate(fitted, log).statistics]
        for fitted in (found.base, found.extended)
    )
    return _gain(before, after)


def _gain(before: Iterable[float], after: Iterable[float]) -> float:
    """Relative fall of the root mean square error of one channel."""
    return 1.0 - math.hypot(*after) / math.hypot(*before)


if __name__ == "__main__":
    main()
