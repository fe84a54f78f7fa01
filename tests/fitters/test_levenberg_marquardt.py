"""The bounded Levenberg–Marquardt against problems whose minimum is known in closed form."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

from softid.fitters.levenberg_marquardt import (
    Minimum,
    NormalEquations,
    attainable_offset,
    minimise,
    movable,
)

Array = npt.NDArray[np.float64]
FAR = np.inf


def normal(z: Array, residual: Array, jacobian: Array) -> NormalEquations:
    """r = measured − simulated, J = ∂simulated/∂z."""
    return NormalEquations(
        z,
        0.5 * float(residual @ residual),
        jacobian.T @ residual,
        jacobian.T @ jacobian,
        residual.size,
    )


def linear(matrix: Array, target: Array) -> Callable[[Array], NormalEquations]:
    return lambda z: normal(z, target - matrix @ z, matrix)


def solved(
    evaluate: Callable[[Array], NormalEquations],
    start: Array,
    *,
    lower: Array | float = -FAR,
    upper: Array | float = FAR,
    evaluations: int = 200,
    tolerance: float = 1e-8,
) -> Minimum:
    n = start.size
    return minimise(
        evaluate,
        start,
        np.broadcast_to(np.asarray(lower, float), n).copy(),
        np.broadcast_to(np.asarray(upper, float), n).copy(),
        np.full(n, 3.0),
        evaluations=evaluations,
        tolerance=tolerance,
    )


def line(rng_seed: int = 0) -> tuple[Array, Array]:
    rng = np.random.default_rng(rng_seed)
    matrix = np.column_stack([np.ones(40), np.linspace(-1, 1, 40), np.linspace(-1, 1, 40) ** 2])
    return matrix, matrix @ np.array([1.0, -2.0, 0.5]) + 0.1 * rng.standard_normal(40)


def rosenbrock(z: Array) -> NormalEquations:
    """½[(1 − x)² + 100 (y − x²)²], minimum 0 at (1, 1)."""
    x, y = z
    return normal(z, np.array([1 - x, -10 * (y - x**2)]), np.array([[1.0, 0.0], [-20 * x, 10.0]]))


def test_a_linear_problem_takes_a_few_evaluations() -> None:
    """Least squares in closed form; the initial damping costs a few extra steps."""
    matrix, target = line()
    found = solved(linear(matrix, target), np.array([0.0, 0.0, 0.0]))
    expected = np.linalg.lstsq(matrix, target, rcond=None)[0]
    np.testing.assert_allclose(found.point, expected, atol=1e-7)
    assert found.evaluations <= 5
    assert found.offset <= 1e-8


def test_rosenbrock() -> None:
    """Minimum (1, 1) from the classical start; a method that only descends needs thousands."""
    found = solved(rosenbrock, np.array([-1.2, 1.0]))
    np.testing.assert_allclose(found.point, [1.0, 1.0], atol=1e-6)
    assert found.evaluations < 100


@pytest.mark.parametrize("start", [[-1.2, 1.0], [0.5, 2.0], [-2.0, -1.0]])
def test_optimum_on_a_bound(start: list[float]) -> None:
    """x ≤ 0.5 moves Rosenbrock's minimum to (0.5, 0.25), where its gradient points outward."""
    found = solved(
        rosenbrock, np.array(start), lower=np.array([-2.0, -2.0]), upper=np.array([0.5, 2.0])
    )
    np.testing.assert_allclose(found.point, [0.5, 0.25], atol=1e-6)
    assert found.offset <= 1e-8


def test_a_start_on_the_wrong_bound_leaves_it() -> None:
    """All coordinates start on a bound; the gradient points inward and the optimum is inside."""
    matrix, target = line()
    expected = np.linalg.lstsq(matrix, target, rcond=None)[0]
    for corner in (expected - 2.0, expected + 3.0):
        found = solved(linear(matrix, target), corner, lower=expected - 2.0, upper=expected + 3.0)
        np.testing.assert_allclose(found.point, expected, atol=1e-7)


def test_a_start_outside_is_clipped() -> None:
    """The first evaluation is already inside."""
    seen = []

    def watched(z: Array) -> NormalEquations:
        seen.append(z.copy())
        return rosenbrock(z)

    solved(watched, np.array([9.0, -9.0]), lower=-2.0, upper=2.0)
    assert np.all(np.abs(seen) <= 2.0)


def test_bounds_without_width_hold_the_value() -> None:
    """z₁ is held at −1: the others reach the least-squares solution given that."""
    matrix, target = line()
    lower, upper = np.array([-FAR, -1.0, -FAR]), np.array([FAR, -1.0, FAR])
    found = solved(linear(matrix, target), np.zeros(3), lower=lower, upper=upper)
    rest = np.linalg.lstsq(matrix[:, [0, 2]], target + matrix[:, 1], rcond=None)[0]
    np.testing.assert_allclose(found.point, [rest[0], -1.0, rest[1]], atol=1e-7)
    everything = solved(linear(matrix, target), np.zeros(3), lower=0.0, upper=0.0)
    assert everything.point.tolist() == [0.0, 0.0, 0.0]
    assert everything.offset == 0.0


def test_a_trial_that_is_not_finite_is_rejected() -> None:
    """ln z with target ln 0.1 from z = 3: the full step leaves the domain; the end is 0.1."""

    def log_fit(z: Array) -> NormalEquations:
        if z[0] <= 0.0:
            return NormalEquations(z, np.inf, np.zeros(1), np.eye(1), 1)
        return normal(z, np.array([np.log(0.1) - np.log(z[0])]), np.array([[1 / z[0]]]))

    found = solved(log_fit, np.array([3.0]))
    assert found.point[0] == pytest.approx(0.1, rel=1e-6)


def test_nowhere_finite() -> None:
    """A start that is not finite ends at once, and says that it did not arrive."""
    found = solved(lambda z: NormalEquations(z, np.inf, np.zeros(2), np.eye(2), 5), np.zeros(2))
    assert found.evaluations == 1
    assert found.offset == np.inf


def test_a_singular_jacobian() -> None:
    """Two equal columns and one of zeros: their sum is found, the unseen one stays put."""
    matrix, target = line()
    singular = np.column_stack([matrix[:, 0], matrix[:, 0], matrix[:, 1], np.zeros(40)])
    found = solved(linear(singular, target), np.array([0.0, 0.0, 0.0, 0.7]))
    expected = np.linalg.lstsq(matrix[:, :2], target, rcond=None)[0]
    assert found.point[0] + found.point[1] == pytest.approx(expected[0], abs=1e-6)
    assert found.point[2] == pytest.approx(expected[1], abs=1e-6)
    assert found.point[3] == 0.7
    assert found.offset <= 1e-8


def test_the_limit_of_evaluations_is_kept_and_told() -> None:
    """Stopped early the offset stays large: nobody may take that for success."""
    for limit in (1, 2, 5):
        found = solved(rosenbrock, np.array([-1.2, 1.0]), evaluations=limit)
        assert found.evaluations <= limit
        assert found.offset > 1e-2


def test_offset_is_that_of_bates_and_watts() -> None:
    """Linear problem at z: √((z − ẑ)ᵀJᵀJ(z − ẑ)/P)/s, s² from the residual there (closed form)."""
    matrix, target = line()
    best = np.linalg.lstsq(matrix, target, rcond=None)[0]
    for move in (np.zeros(3), np.array([0.01, 0.0, -0.02]), np.array([1.0, 2.0, 3.0])):
        z = best + move
        r = target - matrix @ z
        s = np.sqrt(r @ r / (40 - 3))
        expected = np.linalg.norm(matrix @ move) / np.sqrt(3) / s
        at = normal(z, r, matrix)
        found = attainable_offset(at, np.ones(3, bool), np.full(3, 1e9))
        assert found == pytest.approx(expected, rel=1e-7, abs=1e-10)


def test_an_unseen_direction_is_not_far_from_its_optimum() -> None:
    """A column of 1e-9: its distance of 1e6 reaches cannot be seen, so it does not count."""
    matrix, target = line()
    weak = matrix.copy()
    weak[:, 2] *= 1e-9
    best = np.linalg.lstsq(matrix[:, :2], target, rcond=None)[0]
    z = np.array([best[0], best[1], 0.0])
    at = normal(z, target - weak @ z, weak)
    assert attainable_offset(at, np.ones(3, bool), np.full(3, 3.0)) < 1e-6
    assert attainable_offset(at, np.ones(3, bool), np.full(3, 1e12)) > 1.0
    assert attainable_offset(at, np.zeros(3, bool), np.full(3, 3.0)) == 0.0


def test_movable() -> None:
    """The gradient is the direction of descent: outward on a bound holds, inward does not."""
    lower, upper = np.zeros(5), np.array([1.0, 1.0, 1.0, 1.0, 0.0])
    z = np.array([0.0, 0.0, 1.0, 1.0, 0.0])
    gradient = np.array([-1.0, 1.0, -1.0, 1.0, 1.0])
    assert movable(z, gradient, lower, upper).tolist() == [False, True, True, False, False]


@pytest.mark.filterwarnings("error")
def test_a_correction_beyond_all_numbers_is_left_out() -> None:
    """Its square is no number; nobody is warned of that, and the linear minimum is found."""
    matrix = np.array([[1.0, 0.2], [0.0, 2.0], [0.5, 1.0]])
    target = matrix @ np.array([4.0, -3.0])
    evaluate = linear(matrix, target)
    found = minimise(
        evaluate,
        np.zeros(2),
        np.full(2, -FAR),
        np.full(2, FAR),
        np.full(2, 3.0),
        evaluations=200,
        tolerance=1e-8,
        second_derivative=lambda z, step, now: np.full(2, 1e200) if np.abs(z).max() < 1.0 else None,
    )
    assert found.point == pytest.approx([4.0, -3.0], rel=1e-6)


def test_an_unknown_that_may_move_far_damps_no_other() -> None:
    """A zero whose reach is 67 m of a motion of 67 mm, beside parameters, one seen a hundredth."""
    jacobian = np.array([[30.0, 3.0, 1.0], [30.0, -3.0, 1.0], [10.0, 0.1, 1.0], [5.0, -0.2, 1.0]])
    jacobian[:, 1] /= 10.0
    truth = np.array([0.5, -1.0, 2.0])
    evaluate = linear(jacobian, jacobian @ truth)
    far = np.full(3, FAR)
    reach = np.array([2.0, 2.0, 67e3])
    found = minimise(evaluate, np.zeros(3), -far, far, reach, evaluations=2, tolerance=1e-12)
    assert found.point == pytest.approx(truth, rel=0.05)
