"""The bundled muscle pair is one draw of many: what the intervals of its recipe hold on average."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from softid.fitters.problem import Problem
from softid.identification import fit
from softid.models import Muscle
from softid.synthesis import SyntheticLog, bundled_datasets, load_recipe, synthesize
from softid.uncertainty import ResidualBlock, sandwich_covariance

NAMES = ("muscle_steps", "muscle_sine_050")
PRESSURE_NOISE_KPA = 0.2
NOISE_MM = 0.3


def drawn(seeds: tuple[int | None, int | None] = (None, None)) -> list[SyntheticLog]:
    folder = bundled_datasets() / "recipes"
    recipes = [load_recipe(folder / f"{name}.toml") for name in NAMES]
    return [synthesize(recipe, seed=seed) for recipe, seed in zip(recipes, seeds, strict=True)]


def with_other_noise(log: SyntheticLog, rng: Generator) -> SyntheticLog:
    true = log.truth_columns
    columns = dict(log.columns)
    for name, sd in (("pressure_kpa", PRESSURE_NOISE_KPA), ("contraction_mm", NOISE_MM)):
        columns[name] = np.round(true[name] + sd * rng.standard_normal(true[name].size), 2)
    return replace(log, columns=columns)


def test_stated_errors_are_the_true_spread() -> None:
    """300 draws of noise in both channels, linearised at the truth: each stated standard error
    within 15 % of the spread of the estimates, whose own uncertainty is 1/√600 = 4 %.

    The noise of the pressure enters through the model and is larger where the curve is steep, which
    the stated errors do not know.
    """
    logs, rng = drawn(), default_rng(5)
    model = Muscle().adapted({"input": "kPa", "contraction": "mm"})
    names = model.parameters().names
    jacobians: list[np.ndarray] = []
    estimates, stated = [], []
    for k in range(300):
        noisy = [with_other_noise(log, rng).to_log(outputs=("contraction",)) for log in logs]
        problem = Problem(model, model.parameters(), noisy)
        at_truth = problem.unknowns({name: logs[0].truth[name] for name in names})
        blocks = list(problem.blocks(at_truth, derivatives=not jacobians))
        jacobians = jacobians or [b.jacobian for b in blocks if b.jacobian is not None]
        residual = np.concatenate([block.residual for block in blocks])
        step = np.linalg.lstsq(np.vstack(jacobians), residual, rcond=None)[0]
        estimates.append(step)
        if k % 20 == 0:
            left = tuple(b.residual - j @ step for b, j in zip(blocks, jacobians, strict=True))
            block = ResidualBlock("contraction", tuple(jacobians), left)
            unknowns = [str(at) for at in range(step.size)]
            stated.append(sandwich_covariance([block], unknowns).sd)
    count = len(names)
    ratio = np.mean(np.array(stated, float), axis=0)[:count] / np.std(estimates, axis=0)[:count]
    assert np.all((ratio > 0.85) & (ratio < 1.15)), ratio


@pytest.mark.slow
def test_intervals_of_fresh_draws_cover_the_truth() -> None:
    """60 fresh pairs of the same muscle: 52 of 60 is four standard deviations below 95 %, and the
    mean distance of seven parameters is 7 ± 1.9, four standard deviations of χ².
    """
    inside: dict[str, int] = {}
    distances = []
    for k in range(60):
        logs = drawn((40_000 + 2 * k, 40_001 + 2 * k))
        truth = logs[0].truth
        result = fit([log.to_log(outputs=("contraction",)) for log in logs], model="muscle")
        z = []
        for p in result.parameters:
            assert p.ci95 is not None
            assert p.stderr is not None
            inside[p.name] = inside.get(p.name, 0) + (p.ci95[0] <= truth[p.name] <= p.ci95[1])
            off = truth[p.name] - p.value
            if p.scale == "log":
                off = float(np.log(truth[p.name] / p.value)) * p.value
            z.append(off / p.stderr)
        assert result.correlation is not None
        distances.append(float(np.array(z) @ np.linalg.solve(result.correlation, z)))
    assert min(inside.values()) >= 52, inside
    assert 5.1 <= np.mean(distances) <= 8.9
