"""A noise model by which residuals of all candidates are made white alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import TRUTH, linear_log, linear_problem

from softid.diagnosis.refit.whitening import SIGMA_FLOOR, Place, Unknown, Whitener, whitener_of
from softid.fitters.problem import Problem

Array = npt.NDArray[np.float64]

PHI = 0.8
KEY = (0, "angle")
ONE = Whitener({KEY: np.array([PHI])}, {KEY: 0.01})


def place(used: npt.NDArray[np.bool_]) -> Place:
    return Place(0, *KEY, used)


def coloured(samples: int, seed: int = 0) -> tuple[Array, Array]:
    """e_t = 0.8 e_{t−1} + w_t with w of 0.01, and w."""
    innovations = 0.01 * np.random.default_rng(seed).standard_normal(samples)
    values = innovations.copy()
    for k in range(1, samples):
        values[k] += PHI * values[k - 1]
    return values, innovations


def coloured_problem(samples: int = 4000, seed: int = 0) -> Problem:
    return linear_problem([linear_log(samples=samples, added=coloured(samples, seed)[0])])


def test_rows_become_the_innovations() -> None:
    """Closed form: e_t − φ e_{t−1} = w_t exactly, in units of its deviation; the first is lost."""
    values, innovations = coloured(300)
    white = ONE.innovations(values[:, None], place(np.ones(300, bool)))
    assert white.shape == (299, 1)
    assert white[:, 0] == pytest.approx(innovations[1:] / 0.01, abs=1e-9)


def test_residual_and_jacobian_are_treated_alike() -> None:
    """Invariant: the filter is linear, so it passes sums of columns on."""
    rng = np.random.default_rng(1)
    rows = rng.standard_normal((200, 3))
    used = rng.random(200) > 0.1
    whole = ONE.innovations(rows[used], place(used))
    weights = np.array([1.0, -2.0, 0.5])
    summed = ONE.innovations((rows[used] @ weights)[:, None], place(used))
    assert summed[:, 0] == pytest.approx(whole @ weights)


def test_gaps_do_not_leak() -> None:
    """What stands before a gap does not reach what follows, and each run loses its first sample."""
    values, innovations = coloured(300)
    used = np.ones(300, bool)
    used[100:105] = False
    used[200] = False
    white = ONE.innovations(values[used][:, None], place(used))
    wanted = np.concatenate([innovations[1:100], innovations[106:200], innovations[202:]]) / 0.01
    assert white[:, 0] == pytest.approx(wanted, abs=1e-9)
    shouted = values.copy()
    shouted[:100] *= 1e3
    other = ONE.innovations(shouted[used][:, None], place(used))
    assert np.array_equal(other[99:], white[99:])


def test_runs_that_are_too_short_are_left_out() -> None:
    """A run of no more samples than coefficients has no innovation."""
    three = Whitener({KEY: np.array([0.1, 0.1, 0.1])}, {KEY: 1.0})
    used = np.array([True] * 3 + [False] + [True] * 4 + [False])
    rows = np.ones((7, 2))
    rows[:3] = 99.0
    white = three.innovations(rows, place(used))
    assert white == pytest.approx(np.full((1, 2), 0.7))
    nothing = three.innovations(np.ones((3, 2)), place(used[:4]))
    assert nothing.shape == (0, 2)


def test_the_noise_of_a_fit_is_found() -> None:
    """Known truth φ = 0.8, w = 0.01: made white, to unit variance and no memory.

    4000 samples: φ to ±0.0095, the variance to ±2.2 %, a correlation to ±0.016; four times each.
    """
    problem = coloured_problem()
    z = problem.unknowns(TRUTH)
    found = whitener_of(problem, z, {"angle": 1.0})
    assert found.phi[KEY][0] == pytest.approx(PHI, abs=0.07)
    assert found.sigma[KEY] == pytest.approx(0.01, rel=0.045)
    (block,) = problem.blocks(z, derivatives=False)
    used = problem.segments[0].used["angle"]
    white = found.innovations(block.residual[:, None], place(used))[:, 0]
    assert float(np.mean(white**2)) == pytest.approx(1.0, rel=0.09)
    for lag in (1, 2, 5):
        assert abs(float(np.corrcoef(white[lag:], white[:-lag])[0, 1])) < 0.065


def test_a_log_has_its_own_noise() -> None:
    """A quiet log beside a loud one: each is measured by its own standard deviation."""
    quiet, loud = linear_log(noise=0.001, seed=1), linear_log(noise=0.1, seed=2)
    problem = linear_problem([quiet, loud])
    found = whitener_of(problem, problem.unknowns(TRUTH), {"angle": 1.0})
    assert found.sigma[0, "angle"] == pytest.approx(0.001, rel=0.1)
    assert found.sigma[1, "angle"] == pytest.approx(0.1, rel=0.1)


def test_masked_samples_tell_nothing_about_the_noise() -> None:
    """A fault that is masked changes neither the memory nor the size."""
    log = linear_log(samples=4000, added=coloured(4000)[0])
    angle = np.array(log.channels["angle"].values)
    angle[2000:2010] += 50.0
    channel = replace(log.channels["angle"], values=angle)
    masked = np.zeros(4000, bool)
    masked[2000:2010] = True
    faulty = replace(log, channels=dict(log.channels) | {"angle": channel})
    problem = linear_problem([faulty.with_masked(masked)])
    found = whitener_of(problem, problem.unknowns(TRUTH), {"angle": 1.0})
    assert found.sigma[KEY] == pytest.approx(0.01, rel=0.045)


def test_without_noise_the_floor_holds() -> None:
    """A billionth of the span that is passed, so that nothing is divided by zero."""
    problem = linear_problem([linear_log()])
    z = problem.unknowns(TRUTH)
    simulated = (
        problem.segments[0].outputs["angle"] - next(problem.blocks(z, derivatives=False)).residual
    )
    channels = dict(problem.logs[0].channels)
    channels["angle"] = replace(channels["angle"], values=simulated)
    exact = linear_problem([replace(problem.logs[0], channels=channels)])
    found = whitener_of(exact, z, {"angle": 1e6})
    assert found.sigma[KEY] == pytest.approx(SIGMA_FLOOR * 1e6)


def test_what_unknown_numbers_move_becomes_white_with_the_noise() -> None:
    """Closed form: W (I + G Gᵀ) Wᵀ = I; where none is, only the noise is made white."""
    columns = np.random.default_rng(1).standard_normal((40, 3)) * (0.1, 1.0, 30.0)
    whole = np.eye(40) + columns @ columns.T
    noise = replace(ONE, phi={KEY: np.empty(0)}, unknown={KEY: Unknown.of(columns)})
    moved = noise.shrunk(np.eye(40), place(np.ones(40, bool)))
    assert moved @ whole @ moved.T == pytest.approx(np.eye(40), abs=1e-8)
    white = noise.whiten(np.eye(40), place(np.ones(40, bool)))
    assert white == pytest.approx(moved / 0.01)
    elsewhere = Place(1, *KEY, np.ones(40, bool))
    assert noise.whiten(np.eye(40), elsewhere) == pytest.approx(np.eye(40) / 0.01)
