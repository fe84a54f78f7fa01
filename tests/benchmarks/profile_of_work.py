"""Print where the time of a fit and of a diagnosis goes.

Run from the root of the project::

    python tests/benchmarks/profile_of_work.py

The fit is `softid.fit` of the shared log with the model named; its stages are timed from outside,
the least of several runs, so that they do not quite make up that of the whole. The diagnosis looks
for a hidden creep in two minutes at 20 Hz; its time is that of the profiler, which makes small
Python functions look dearer than they are, by the part of softid that a function belongs to.
Everything runs on one processor, so that nothing hides in a thread.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
import cProfile
import os
import pstats
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import ModuleType
from unittest.mock import patch

import numpy as np
from work import NAMES, TRUTH, log_of

import softid
from softid.effects import EFFECTS, ExtendedModel, Scale
from softid.fitters import scouting
from softid.identification import assembly, workflow
from softid.log import Log
from softid.models.muscle import Muscle

STAGES: tuple[tuple[str, ModuleType | type, tuple[str, ...]], ...] = (
    (
        "drop-outs, faults, repeats",
        workflow,
        ("without_dropouts", "with_faults_told", "_at_readings"),
    ),
    (
        "checks, direction of the motion",
        workflow,
        (
            "require_outputs",
            "require_excitation",
            "require_same_units",
            "require_channels",
            "_require_new",
            "named_model",
            "adapted_model",
            "falls_with_input",
        ),
    ),
    ("start values", Muscle, ("guess",)),
    ("problem", workflow, ("Problem", "fitted_range")),
    ("simpler model", Muscle, ("limit",)),
    ("search, optimiser", workflow, ("output_error",)),
    ("of which pieces of the log", scouting, ("rough_problem", "warm_starts")),
    ("of which runs over all of it", scouting, ("scouts",)),
    ("of which whether noise is left", scouting, ("at_noise_level",)),
    (
        "input between its samples",
        workflow,
        ("as_smooth", "held_choices", "as_held", "explains_better"),
    ),
    ("errors", assembly, ("errors_of",)),
    ("simulation, scores, verdicts", workflow, ("assemble", "opposed", "require_explained")),
)
"""Label, where functions are looked up, and their names; the errors are a part of the last stage,
and what is a part of the stage above says so."""

PART, REST = "of which", "what is between them"
"""How a stage begins that is a part of another one, and the name of what no stage holds."""

PARTS = ("kernels", "effects", "models", "fitters", "uncertainty", "diagnosis", "identification")


@contextmanager
def stopwatch(spent: Counter[str]) -> Iterator[None]:
    """Add the processor time within every stage to ``spent``."""

    def timed(label: str, function: Callable[..., object]) -> Callable[..., object]:
        def run(*arguments: object, **options: object) -> object:
            began = time.process_time()
            try:
                return function(*arguments, **options)
            finally:
                spent[label] += time.process_time() - began

        return run

    with ExitStack() as patches:
        for label, place, names in STAGES:
            for name in names:
                run = timed(label, getattr(place, name))
                patches.enter_context(patch.object(place, name, run))
        yield


def stages_of_a_fit(samples: int, rounds: int) -> None:
    log = log_of(samples, exact=False)
    softid.fit(log, model="muscle")
    least: dict[str, float] = {}
    for _ in range(rounds):
        spent: Counter[str] = Counter()
        with stopwatch(spent):
            began = time.process_time()
            softid.fit(log, model="muscle")
            spent["whole"] = time.process_time() - began
        spent["simulation, scores, verdicts"] -= spent["errors"]
        listed = sum(s for label, s in spent.items() if label != "whole" and PART not in label)
        spent[REST] = spent["whole"] - listed
        for label, seconds in spent.items():
            least[label] = min(least.get(label, np.inf), seconds)
    print(f"| stage of a fit of {samples} samples | ms |\n|---|---|")
    for label in (*(label for label, _, _ in STAGES), REST, "whole"):
        print(f"| {label} | {1e3 * least.get(label, 0.0):.3g} |")


def creeping() -> Log:
    """The muscle with creep, simulated, with 0.5 % of noise."""
    long = log_of(24_000, exact=False)
    time_s, pressure = long.time_s[::10], long.channels["pressure"].values[::10]
    scale = Scale(0, 240, 0, 70, 300, 8, 0, 70, 0.05, float(time_s[-1]), 0.2, 800)
    model = ExtendedModel(Muscle(), (EFFECTS["creep"](),), scale)
    theta = model.parameters().values_vector()
    theta[: len(NAMES)] = TRUTH
    plain = Log.from_arrays(time_s, {"pressure": pressure, "contraction": pressure})
    (segment,) = plain.segments()
    x = model.response(theta, segment, ("contraction",), start=None, derivatives=False)
    y = x.outputs["contraction"]
    noise = 0.005 * np.ptp(y) * np.random.default_rng(3).standard_normal(y.size)
    return Log.from_arrays(time_s, {"pressure": pressure, "contraction": y + noise})


def parts_of_a_diagnosis() -> None:
    log = creeping()
    effects = ("creep", "hysteresis", "delay", "sensor_warmup")
    softid.diagnose(log, model="muscle", effects=effects)
    profile = cProfile.Profile()
    began = time.process_time()
    found = profile.runcall(softid.diagnose, log, model="muscle", effects=effects)
    seconds = time.process_time() - began
    spent: Counter[str] = Counter()
    for (file, _, name), (_, _, own, _, _) in pstats.Stats(profile).stats.items():
        spent[part_of(file, name)] += own
    named = ", ".join(cause.effect for cause in found.causes) or "none"
    print(f"\ndiagnosis of {len(log)} samples, {len(effects)} effects: {found.verdict}, {named}")
    print(f"\n| part of a diagnosis of {seconds:.1f} s | share |\n|---|---|")
    total = sum(spent.values())
    for part, own in spent.most_common():
        if own > 0.01 * total:
            print(f"| {part} | {100.0 * own / total:.0f} % |")


def part_of(file: str, name: str) -> str:
    """What a function of the profile is counted as."""
    folders = Path(file).parts
    if "softid" in folders:
        place = folders[len(folders) - 1 - folders[::-1].index("softid") + 1]
        return f"softid/{place}" if place in PARTS else "softid, other"
    return "numpy" if "numpy" in folders or "numpy" in name else "Python, other"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--rounds", type=int, default=9)
    options = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    stages_of_a_fit(options.samples, options.rounds)
    parts_of_a_diagnosis()


if __name__ == "__main__":
    main()
