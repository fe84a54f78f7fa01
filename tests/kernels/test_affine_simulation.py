"""The block kernels against plain step-by-step forms of the same rules."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from softid.kernels.affine_blocks import MUSCLE, OSCILLATOR, RADAU, RK4, STEPS
from softid.kernels.affine_simulation import move, move_with_derivatives
from softid.kernels.affine_sums import sum_products
from softid.kernels.radau import STAGES, propagate_with_sensitivities

Array = npt.NDArray[np.float64]
THETA = np.array([3e-3, 0.0143, 3.0, 0.95, 1.5e-3, 2.0, 0.28, 1.0])
DRIVE = np.array([0.3, 0.0, 0.4, 20.0, 0.0, 0.0, 1.1, -1.5])
START = np.array([3.0, -20.0])
SIZES = (2, 3, STEPS, STEPS + 1, STEPS + 2, 700)


def given(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Not writable, as the arrays of a segment: for others the kernels are compiled once more."""
    values.setflags(write=False)
    return values


def log(n: int) -> tuple[Array, Array, npt.NDArray[np.int16]]:
    """Irregular times, a rough input in bar, and one to three steps per interval."""
    rng = np.random.default_rng(n)
    time_s = np.cumsum(rng.uniform(0.002, 0.006, n))
    u = 1.0 + np.cumsum(rng.normal(0.0, 0.05, n)) + np.where(time_s > 0.5, 0.8, 0.0)
    return given(time_s), given(u), rng.integers(1, 4, n - 1).astype(np.int16)


def parts(law: int, theta: Array, u: Array) -> tuple[Array, ...]:
    """N, Q, F and their derivatives by the kernel's seven parameters, written as the law is."""
    _, a1, b1, c1, a2, b2, c2, gain = theta
    by = np.zeros((3, *u.shape, 7))
    if law == MUSCLE:
        force, second = np.exp(b1 * u), np.exp(b2 * u)
        by[2, ..., 2] = u * force
        by[1, ..., 2] = a1 * u * force
        by[1, ..., 1] = force
        by[0, ..., 4], by[0, ..., 5] = second, a2 * u * second
    else:
        force, second = gain * (u - b1), np.zeros_like(u)
        by[2, ..., 2] = -gain
    by[1, ..., 3] = by[0, ..., 6] = 1.0
    stiffness = a1 * force + c1
    return a2 * second + c2, stiffness, force, *by


def stepped(
    law: int, theta: Array, time_s: Array, u: Array, counts: npt.NDArray[np.int16]
) -> tuple[Array, Array, Array]:
    """Lengths of all steps, inputs at their starts and ends."""
    lengths = np.repeat(np.diff(time_s) / counts, counts)
    starts, ends = [], []
    for k, count in enumerate(counts):
        at = u[k] + (u[k + 1] - u[k]) * np.arange(count + 1) / count
        starts.extend(at[:-1])
        ends.extend(at[1:])
    return lengths, np.array(starts), np.array(ends)


def radau_by_steps(law: int, theta: Array, time_s: Array, u: Array, counts, tangent: Array):
    """x and ∂x at the samples by the three-stage kernel that takes one step at a time."""
    h, start, end = stepped(law, theta, time_s, u, counts)
    n, q, f, n_by, q_by, f_by = parts(law, theta, start[:, None] + (end - start)[:, None] * STAGES)
    states, tangents = np.empty((h.size, 2)), np.empty((h.size, 9))
    propagate_with_sensitivities(
        h,
        theta[0],
        n,
        q,
        f,
        np.eye(7)[0],
        n_by,
        q_by,
        f_by,
        START.copy(),
        tangent,
        states,
        tangents,
    )
    last = np.cumsum(counts) - 1
    return states[last, 0], tangents[last]


def rk4_by_steps(law: int, theta: Array, time_s: Array, u: Array, counts, tangent: Array):
    """x and ∂x at the samples by the textbook rule on state and sensitivities together."""
    h, start, end = stepped(law, theta, time_s, u, counts)

    def rates(z: Array, p: float) -> Array:
        n, q, f, n_by, q_by, f_by = (a[0] for a in parts(law, theta, np.array([p])))
        x, v = z[:, 0]
        acceleration = (f - n * v - q * x) / theta[0]
        push = np.zeros(9)
        push[:7] = f_by - n_by * v - q_by * x - np.eye(7)[0] * acceleration
        by = (push - n * z[1, 1:] - q * z[0, 1:]) / theta[0]
        return np.array([[v, *z[1, 1:]], [acceleration, *by]])

    z = np.column_stack([START, tangent])
    rows = []
    for step, p0, p1 in zip(h, start, end, strict=True):
        k1 = rates(z, p0)
        k2 = rates(z + step / 2 * k1, (p0 + p1) / 2)
        k3 = rates(z + step / 2 * k2, (p0 + p1) / 2)
        k4 = rates(z + step * k3, p1)
        z = z + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        rows.append(z[0].copy())
    found = np.array(rows)[np.cumsum(counts) - 1]
    return found[:, 0], found[:, 1:]


def tangent_of_start() -> Array:
    """Any tangent: nine columns that differ."""
    return np.random.default_rng(5).normal(size=(2, 9))


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize(("law", "theta"), [(MUSCLE, THETA), (OSCILLATOR, DRIVE)])
@pytest.mark.parametrize(("rule", "plain"), [(RADAU, radau_by_steps), (RK4, rk4_by_steps)])
def test_blocks_do_what_single_steps_do(law: int, theta: Array, rule: int, plain, n: int) -> None:
    """Stretches run from zero and joined equal the chain of steps: to rounding, 1e-11."""
    time_s, u, counts = log(n)
    x, v, by = np.empty(n), np.empty(n), np.empty((9, n))
    move_with_derivatives(law, rule, theta, time_s, u, counts, START, tangent_of_start(), x, v, by)
    expected, expected_by = plain(law, theta, time_s, u, counts, tangent_of_start())
    np.testing.assert_allclose(x[1:], expected, rtol=1e-11, atol=1e-11 * np.abs(x).max())
    for p in range(9):
        if law == OSCILLATOR and p in (1, 4, 5):
            continue  # it has no such parameter
        scale = np.abs(expected_by[:, p]).max()
        np.testing.assert_allclose(by[p, 1:], expected_by[:, p], atol=1e-11 * scale)
    alone, speed = np.empty(n), np.empty(n)
    move(law, rule, theta, time_s, u, counts, START, alone, speed)
    np.testing.assert_array_equal(alone, x)
    np.testing.assert_array_equal(speed, v)
    assert (x[0], v[0], *by[:, 0]) == (*START, *tangent_of_start()[0])


@pytest.mark.parametrize("rule", [RADAU, RK4])
@pytest.mark.parametrize("n", SIZES)
def test_products_are_those_of_the_columns(rule: int, n: int) -> None:
    """Σ cᵢcⱼ over the used samples, against the kept and the separately computed columns: 1e-12."""
    time_s, u, counts = log(n)
    rng = np.random.default_rng(1)
    y, used = given(rng.normal(size=n)), given(rng.random(n) < 0.7)
    x, v, by = np.empty(n), np.empty(n), np.empty((9, n))
    how = (MUSCLE, rule, THETA, time_s, u, counts)
    move_with_derivatives(*how, START, tangent_of_start(), x, v, by)
    columns = np.vstack([by, np.ones(n), y - (-0.05 * x + 0.3)]) * used
    run = (*how, y, used, -0.05, 0.3)
    kept, gram = summed(run, 1)
    np.testing.assert_allclose(kept, columns, rtol=1e-13, atol=1e-13)
    expected = columns @ columns.T
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert np.all(np.abs(gram[:11, :11] - expected) <= 1e-12 * scale)
    _, again = summed(run, 0)
    np.testing.assert_array_equal(gram, again)
    left = np.zeros(n)
    means, again = summed(run, 7, left)
    np.testing.assert_array_equal(left, kept[-1])
    np.testing.assert_array_equal(gram, again)
    whole = np.add.reduceat(kept, np.arange(0, n, 7), axis=1) / 7.0
    np.testing.assert_allclose(means, whole, rtol=1e-12, atol=1e-12)


def summed(run: tuple[Any, ...], stretch: int, left: Array | None = None) -> tuple[Array, Array]:
    """Kept columns and products of a whole log."""
    n = run[3].size
    kept = np.zeros((11, -(-n // stretch) if stretch else 0))
    gram = np.empty((12, 12))
    place = (np.zeros(2, np.int64), n, START.copy(), tangent_of_start())
    residual = np.empty(0) if left is None else left
    sum_products(*run, *place, stretch, kept, -1, residual, gram)
    return kept, gram


@pytest.mark.parametrize("rule", [RADAU, RK4])
def test_a_run_goes_on_where_it_ended(rule: int) -> None:
    """Two parts of a log, which share a stretch, sum up to the whole to rounding."""
    n = SIZES[-1]
    time_s, u, counts = log(n)
    y, used = given(np.random.default_rng(1).normal(size=n)), given(np.ones(n, bool))
    run = (MUSCLE, rule, THETA, time_s, u, counts, y, used, -0.05, 0.3)
    kept, gram = summed(run, 7)
    parts, total = np.zeros((11, kept.shape[1] + 1)), np.zeros((12, 12))
    at, state, tangent, apart = np.zeros(2, np.int64), START.copy(), tangent_of_start(), -1
    for blocks in (1, n):
        one = np.empty((12, 12))
        sum_products(*run, at, blocks, state, tangent, 7, parts, apart, np.empty(0), one)
        total += one
        if blocks == 1:
            reached, apart = at.copy(), (int(at[0]) + 1) // 7
    parts[:, apart] += parts[:, -1]
    np.testing.assert_allclose(parts[:, :-1], kept, rtol=1e-12, atol=1e-12)
    scale = np.sqrt(np.diag(gram))
    assert np.all(np.abs(total - gram) <= 1e-12 * np.outer(scale, scale))
    at[:] = 0, STEPS  # the same step, counted from the beginning of the log
    sum_products(*run, at, 0, state, tangent, 0, np.empty((11, 0)), -1, np.empty(0), one)
    np.testing.assert_array_equal(at, reached)


@pytest.mark.parametrize(("mass", "damping"), [(0.0, 0.28), (0.0, 0.0), (1e-12, 0.28)])
def test_limits_without_inertia_and_damping(mass: float, damping: float) -> None:
    """m = 0 and m = n = 0 are regular: as the single steps to rounding, and finite derivatives."""
    theta = THETA.copy()
    theta[[0, 6]] = mass, damping
    theta[4] = 0.0
    time_s, u, counts = log(300)
    x, v, by = np.empty(300), np.empty(300), np.empty((9, 300))
    tangent = np.zeros((2, 9))
    move_with_derivatives(MUSCLE, RADAU, theta, time_s, u, counts, START, tangent, x, v, by)
    expected, expected_by = radau_by_steps(MUSCLE, theta, time_s, u, counts, np.zeros((2, 9)))
    np.testing.assert_allclose(x[1:], expected, rtol=1e-10)
    for p in range(7):
        scale = np.abs(expected_by[:, p]).max()
        assert np.abs(by[p, 1:] - expected_by[:, p]).max() <= 1e-9 * scale


def test_what_overflows_is_not_finite_and_does_not_hang() -> None:
    """Absurd exponents and an unstable explicit step end in inf or NaN, which a fit rejects."""
    time_s, u, counts = log(400)
    for change in ({2: 900.0}, {0: 1e-9}, {0: 0.0}):
        theta = THETA.copy()
        for at, value in change.items():
            theta[at] = value
        gram = np.empty((12, 12))
        sum_products(
            MUSCLE, RK4, theta, time_s, u, counts, u, given(np.ones(400, bool)), 1.0, 0.0,
            np.zeros(2, np.int64), 400, START.copy(), np.zeros((2, 9)),
            0, np.empty((11, 0)), -1, np.empty(0), gram,
        )  # fmt: skip
        assert not np.isfinite(gram).all() or np.abs(gram).max() > 1e60
