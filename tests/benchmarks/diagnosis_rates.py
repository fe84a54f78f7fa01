"""How often a diagnosis names the hidden cause: confusion matrix, and rates by size of the misfit.

    python tests/benchmarks/diagnosis_rates.py --kinds clean,single --draws 2

Results go to a file line by line, so that an interrupted run goes on where it stopped.
"""
# ruff: noqa: E402, T201 (a script that prints its result, and keeps other threads from its own)

from __future__ import annotations

import argparse
import json
import os
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np
from diagnosis_cases import RIGS, Case, Score, cases, run

from softid.errors import InputError

KINDS = (
    "clean",
    "single",
    "form",
    "wide",
    "other_form",
    "outside",
    "pair",
    "any_pair",
    "background",
    "faint",
    "tie",
)
BINS = ((0.0, 0.3), (0.3, 0.5), (0.5, 1.0), (1.0, 3.0), (3.0, np.inf))
SEED = 52_000
"""Far from the seeds of the tests."""


def main() -> None:
    """Run what is missing and print the tables."""
    asked = _arguments()
    wanted = [
        case
        for kind in asked.kinds.split(",")
        for case in cases(
            kind,
            asked.draws,
            asked.seed,
            size=asked.size,
            rig=asked.rig,
            model=asked.model,
            in_blocks=asked.blocks,
            chosen=asked.choose,
            protocol=asked.protocol,
        )
        if not asked.only or set(case.names) & set(asked.only.split(","))
    ]
    done = _read(asked.out)
    missing = [case for case in wanted if case.key not in done]
    print(f"{len(wanted)} diagnoses, {len(missing)} to run; results in {asked.out}")
    asked.out.parent.mkdir(parents=True, exist_ok=True)
    with asked.out.open("a") as out:
        for score in _scores(missing, asked.workers):
            if isinstance(score, str):
                print(f"--  {score}", flush=True)
                continue
            out.write(json.dumps(asdict(score)) + "\n")
            out.flush()
            done[score.key] = score
            _tell(score)
    print_tables([done[case.key] for case in wanted if case.key in done])


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kinds", default="clean,single,outside,pair")
    parser.add_argument("--only", default="", help="effects, separated by commas")
    parser.add_argument("--draws", type=int, default=1)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--size", type=float, default=1.0)
    parser.add_argument("--model", default="muscle", help="base, also of the hidden truth")
    parser.add_argument("--rig", choices=tuple(RIGS), default="usual")
    parser.add_argument("--protocol", help="in place of the usual one of a kind")
    parser.add_argument("--blocks", action="store_true", help="hold out blocks, not another log")
    parser.add_argument("--choose", action="store_true", help="let the base be chosen")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("build/diagnosis_rates.jsonl"))
    return parser.parse_args()


def _read(path: Path) -> dict[str, Score]:
    if not path.exists():
        return {}
    found = {}
    for line in path.read_text().splitlines():
        row = json.loads(line)
        for name in ("names", "causes", "described", "tied", "told"):
            row[name] = tuple(row.get(name, ()))
        found[row["key"]] = Score(**row)
    return found


def _scores(missing: Sequence[Case], workers: int) -> Iterator[Score | str]:
    """Scores as they come, and why a case has none."""
    if workers == 1:
        yield from map(_score, missing)
        return
    with ProcessPoolExecutor(workers, initializer=_alone) as pool:
        for future in as_completed([pool.submit(_score, case) for case in missing]):
            yield future.result()


def _score(case: Case) -> Score | str:
    """Some draws make an actuator run away, of which there is no log."""
    try:
        return run(case)
    except InputError as error:
        return f"{case.key}: {error}"


def _alone() -> None:
    """One core for each process, so that its threads do not get in the others' way."""
    if hasattr(os, "sched_setaffinity"):
        cores = sorted(os.sched_getaffinity(0))
        os.sched_setaffinity(0, {cores[os.getpid() % len(cores)]})


def _tell(score: Score) -> None:
    answer = "+".join(score.causes) or "-"
    described = f" described {'+'.join(score.described)}" if score.described else ""
    tied = f" tied {','.join(score.tied)}" if score.tied else ""
    beside = "" if score.beside_snr is None else f" beside {score.beside_snr:.2f}"
    excess = "" if score.excess is None else f" excess {score.excess:.2f}"
    print(
        f"{'ok ' if is_right(score) else 'BAD'} {score.key}: {score.verdict} {answer}{described}"
        f"{tied} snr {score.snr:.2f}{beside} gain {score.gain:.3f}/{score.oracle_gain:.3f}"
        f" recovered {score.recovered} explained {score.explained:.2f} structure"
        f" {score.structure:.2f}/{score.structure_limit:.2f}{excess} {score.seconds:.1f} s"
        f" ({score.cpu_seconds:.1f} s CPU)",
        flush=True,
    )
    for message in score.told:
        print(f"    told: {message}", flush=True)


def is_right(score: Score) -> bool:
    """Whether the answer is the one that an expert who knows the truth would accept."""
    told, true = set(score.causes), set(score.hidden)
    if score.kind == "clean":
        return score.verdict == "adequate"
    if score.kind == "outside":
        return score.verdict in ("unknown", "partial", "adequate") and not told - true
    if score.kind == "tie":
        return true <= told | set(score.tied)
    if score.kind in ("background", "faint"):
        return bool(score.causes) and score.causes[0] == score.hidden[0]
    if score.kind == "other_form":
        return score.verdict != "adequate"
    return told == true


def is_misnamed(score: Score) -> bool:
    """Whether one cause was named alone and is not there."""
    return score.verdict in ("named", "partial") and bool(set(score.causes) - set(score.hidden))


def print_tables(scores: Sequence[Score]) -> None:
    """Print rates by kind and by size of the misfit, the confusion matrix, and times."""
    for kind in KINDS:
        mine = [s for s in scores if s.kind == kind]
        if mine:
            _print_kind(kind, mine)
    singles = [s for s in scores if s.kind == "single"]
    if singles:
        _print_confusion(singles)


def _print_kind(kind: str, scores: Sequence[Score]) -> None:
    print(f"\n{kind}: {len(scores)} diagnoses")
    print("  SNR          n   right  in the answer  misnamed  recovered  gain ≥ .98 of oracle")
    for low, high in BINS if kind != "clean" else ((0.0, np.inf),):
        mine = [s for s in scores if low <= s.snr < high]
        if mine:
            _print_bin(f"{low:.1f} to {high:.1f}", mine)
    strong = [s for s in scores if s.snr >= 0.5]
    if strong and kind != "clean":
        _print_bin("0.5 and up", strong)
    besides = [s for s in scores if s.beside_snr is not None and s.beside_snr >= 0.5]
    if besides:
        print("  of these where either effect leaves 0.5 or more if only the other is considered:")
        _print_bin("0.5 and up", besides)
    seconds = np.array([s.seconds for s in scores])
    cpu = np.array([s.cpu_seconds for s in scores])
    print(f"  time: median {np.median(seconds):.1f} s, longest {seconds.max():.1f} s;", end=" ")
    print(f"of the processor: median {np.median(cpu):.1f} s, longest {cpu.max():.1f} s")


def _print_bin(label: str, scores: Sequence[Score]) -> None:
    n = len(scores)
    right = sum(is_right(s) for s in scores)
    present = sum(set(s.hidden) <= set(s.causes) | set(s.tied) for s in scores)
    wrong = sum(is_misnamed(s) for s in scores)
    judged = [s.recovered for s in scores if s.recovered is not None]
    named = [s for s in scores if s.oracle_gain > 0.02]
    near = sum(s.gain >= 0.98 * s.oracle_gain for s in named)
    print(
        f"  {label:<11} {n:3d}  {_share(right, n)}    {_share(present, n)}        "
        f"{_share(wrong, n)}    {_share(sum(judged), len(judged))}     {_share(near, len(named))}"
    )


def _share(count: int, n: int) -> str:
    return f"{100.0 * count / n:5.1f} %" if n else "    -  "


def _print_confusion(scores: Sequence[Score]) -> None:
    print("\nhidden → answered (verdict and causes), how often")
    for name in sorted({s.names[0] for s in scores}):
        rows = Counter(
            f"{s.verdict} {'+'.join(s.causes) or '-'}" for s in scores if s.names[0] == name
        )
        print(f"  {name:<20} " + "; ".join(f"{n} {what}" for what, n in rows.most_common()))


if __name__ == "__main__":
    sys.exit(main())
