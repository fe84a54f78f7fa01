"""Print how often the stated intervals of the bundled muscle pair's recipe hold the truth.

Run from the root of the project::

    python tests/benchmarks/coverage_of_bundled_pair.py --draws 400
    python tests/benchmarks/coverage_of_bundled_pair.py --draws 400 --both

Every draw makes the steps and the 0.5 Hz sine anew, with other noise of the pressure and of the
recorded motion, rounded as in the files, and fits them from their data alone. ``--both`` fits the
distance beside the contraction. Columns:

coverage
    Per cent of draws whose 95 % interval holds the truth.
bias, spread
    Mean and standard deviation of (estimate − truth)/standard error, on the scale of the interval.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
from collections.abc import Mapping

import numpy as np

from softid.chi_square import chi_square_tail
from softid.identification import fit
from softid.models import Muscle
from softid.results import FitResult, ParameterEstimate
from softid.synthesis import bundled_datasets, load_recipe, synthesize

NAMES = ("muscle_steps", "muscle_sine_050")
FIXED_LENGTH_MM, DIAMETER_MM = 150.0, 20.0


def drawn_fit(first_seed: int, *, both: bool) -> tuple[FitResult, Mapping[str, float]]:
    """A fit of one fresh pair, and the truth."""
    folder = bundled_datasets() / "recipes"
    logs = [
        synthesize(load_recipe(folder / f"{name}.toml"), seed=first_seed + k)
        for k, name in enumerate(NAMES)
    ]
    outputs = ("contraction", "distance") if both else ("contraction",)
    shape = {"fixed_length_mm": FIXED_LENGTH_MM, "diameter_mm": DIAMETER_MM} if both else {}
    return fit([log.to_log(outputs=outputs) for log in logs], model=Muscle(**shape)), logs[0].truth


def holds(p: ParameterEstimate, truth: float) -> bool:
    """Whether the 95 % interval of a parameter holds its truth."""
    return p.ci95 is not None and p.ci95[0] <= truth <= p.ci95[1]


def offsets(result: FitResult, truth: Mapping[str, float]) -> np.ndarray:
    """Distance of every estimate from its truth in standard errors, shape (7,)."""
    found = []
    for p in result.parameters:
        assert p.stderr is not None
        off = p.value - truth[p.name]
        if p.scale == "log":
            off = p.value * float(np.log(p.value / truth[p.name]))
        found.append(off / p.stderr)
    return np.array(found)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=40)
    parser.add_argument("--seed", type=int, default=900_000)
    parser.add_argument("--both", action="store_true")
    options = parser.parse_args()
    rows, inside, distances = [], [], []
    for k in range(options.draws):
        result, truth = drawn_fit(options.seed + 2 * k, both=options.both)
        z = offsets(result, truth)
        assert result.correlation is not None
        rows.append(z)
        distances.append(float(z @ np.linalg.solve(result.correlation, z)))
        inside.append([holds(p, truth[p.name]) for p in result.parameters])
    print(
        f"{options.draws} draws; a coverage is uncertain by {sampling_error(options.draws):.1f} %"
    )
    print(f"{'':4}{'coverage %':>12}{'bias':>8}{'spread':>8}")
    for at, p in enumerate(result.parameters):
        z = np.array(rows)[:, at]
        share = 100.0 * float(np.mean(np.array(inside)[:, at]))
        print(f"{p.name:4}{share:12.1f}{z.mean():8.2f}{z.std():8.2f}")
    count = len(result.parameters)
    beyond = 100.0 * float(np.mean([chi_square_tail(d, count) < 0.05 for d in distances]))
    print(
        f"mean χ² {np.mean(distances):.2f} for {count} parameters; {beyond:.1f} % beyond its 95 %"
    )


def sampling_error(draws: int) -> float:
    """Standard deviation of a coverage of 95 %, in per cent."""
    return 100.0 * float(np.sqrt(0.95 * 0.05 / draws))


if __name__ == "__main__":
    main()
