"""The linearised estimate against direct least squares."""

from __future__ import annotations

import numpy as np
import pytest

from softid.errors import InputError
from softid.uncertainty.linearisation import (
    ResidualBlock,
    Stretches,
    is_clear,
    linearise,
    reachable,
    stretch_sums,
)

RNG = np.random.default_rng(1)
DESIGN = RNG.normal(size=(40, 3))


def test_the_inverse_solves_weighted_least_squares() -> None:
    """H⁻¹ Σ w² Jᵀ r = argmin Σ (w r)² over two channels with weights 1 and 3, by numpy's lstsq."""
    y = RNG.normal(size=40)
    blocks = [
        ResidualBlock("a", (DESIGN[:15], DESIGN[15:25]), (y[:15], y[15:25])),
        ResidualBlock("b", (DESIGN[25:],), (y[25:],), 3.0),
    ]
    found = linearise(blocks).inverse @ sum(
        b.weight**2 * j.T @ r for b in blocks for j, r in zip(b.rows, b.residuals, strict=True)
    )
    weight = np.where(np.arange(40) < 25, 1.0, 3.0)
    expected = np.linalg.lstsq(DESIGN * weight[:, None], y * weight, rcond=None)[0]
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_unused_samples_count_for_nothing() -> None:
    """A masked sample's row may hold anything; the estimate is that of the others."""
    y = RNG.normal(size=40)
    design = DESIGN.copy()
    y[7], design[7] = np.nan, np.inf
    block = ResidualBlock("a", (design,), (y,))
    found = linearise([block]).inverse @ (block.rows[0].T @ np.nan_to_num(y))
    expected = np.linalg.lstsq(np.delete(DESIGN, 7, 0), np.delete(y, 7), rcond=None)[0]
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_dependent_and_silent_parameters_are_reported() -> None:
    """Column 1 = −2 × column 0, column 3 zero: two undetermined directions, column 2 in none."""
    x = RNG.normal(size=40)
    design = np.column_stack((x, -2.0 * x, DESIGN[:, 0], np.zeros(40)))
    line = linearise([ResidualBlock("a", (design,), (x,))])
    assert sorted(line.undetermined) == [(0, 1), (3,)]
    np.testing.assert_array_equal(line.determined, [False, False, True, False])
    assert line.condition_number == np.inf


def test_condition_number_does_not_depend_on_units() -> None:
    """Columns scaled by 1e8: the same condition number as numpy's of the normalised Jacobian."""
    expected = np.linalg.cond(DESIGN / np.linalg.norm(DESIGN, axis=0))
    scaled = ResidualBlock("a", (DESIGN * [1.0, 1e8, 1e-8],), (np.ones(40),))
    assert linearise([scaled]).condition_number == pytest.approx(expected)


def test_reachable_basis_is_orthonormal_and_spans_the_jacobian() -> None:
    """QᵀQ = 1 and QQᵀJ = J; the dependent column adds no direction."""
    design = np.column_stack((DESIGN, DESIGN[:, 0] + DESIGN[:, 1]))
    basis = np.concatenate(
        reachable(ResidualBlock("a", (design[:9], design[9:]), (np.ones(9), np.ones(31))))
    )
    assert basis.shape == (40, 3)
    np.testing.assert_allclose(basis.T @ basis, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(basis @ (basis.T @ design), design, atol=1e-12)


def test_averages_over_stretches() -> None:
    """Stretches of 3 in 8 samples: the last holds two; one with a single used sample is dropped."""
    y = np.array([1.0, 2.0, 3.0, np.nan, np.nan, 9.0, 4.0, 6.0])
    block = ResidualBlock("a", (np.arange(8.0)[:, None],), (y,)).averaged(3)
    np.testing.assert_allclose(block.residuals[0], [2.0, np.nan, 5.0])
    np.testing.assert_allclose(block.jacobians[0][[0, 2], 0], [1.0, 6.5])
    np.testing.assert_allclose(stretch_sums(np.arange(8.0), 3), [3.0, 12.0, 13.0])


def test_a_channel_slower_than_the_log_is_averaged_too() -> None:
    """Every fourth sample is there: a stretch of 4 or 8 holds one or two, and none is dropped."""
    y = np.full(40, np.nan)
    y[::4] = np.arange(10.0)
    block = ResidualBlock("a", (np.ones((40, 1)),), (y,))
    np.testing.assert_allclose(block.averaged(4).residuals[0], np.arange(10.0))
    np.testing.assert_allclose(block.averaged(8).residuals[0], 2.0 * np.arange(5.0) + 0.5)


def test_mistakes_are_named() -> None:
    """Shapes, empty blocks and derivatives that are not finite."""
    with pytest.raises(InputError, match="do not match"):
        ResidualBlock("a", (DESIGN,), (np.ones(39),))
    with pytest.raises(InputError, match="no residual"):
        ResidualBlock("a", (DESIGN,), (np.full(40, np.nan),))
    with pytest.raises(InputError, match="not finite"):
        ResidualBlock("a", (np.full((4, 1), np.nan),), (np.ones(4),))


@pytest.mark.parametrize("smallest", [1.0, 2e-3, 1e-5])
def test_products_and_decomposition_tell_the_same(smallest: float) -> None:
    """Singular values against numpy's of the scaled Jacobian. The products of J round to 1e-16 of
    the largest square, 4e-11 of the square of 2e-3; below 1e-3 J itself is decomposed."""
    left, _ = np.linalg.qr(RNG.normal(size=(60, 3)))
    right, _ = np.linalg.qr(RNG.normal(size=(3, 3)))
    design = left @ np.diag([1.0, 0.5, smallest]) @ right
    block = ResidualBlock("a", (design[:25], design[25:]), (np.ones(25), np.ones(35)))
    norm, singular, vectors = block.decomposed
    expected = np.linalg.svd(design / norm, compute_uv=False)
    np.testing.assert_allclose(singular, expected, rtol=1e-9)
    assert is_clear(block) == (expected[-1] > 1e-3 * expected[0])
    np.testing.assert_allclose(
        linearise([block]).inverse, np.linalg.inv(design.T @ design), rtol=1e-5
    )
    np.testing.assert_allclose(vectors @ vectors.T, np.eye(3), atol=1e-12)


def test_stretches_of_stretches_are_longer_stretches() -> None:
    """Four by four is sixteen, with samples missing and a short last stretch; to rounding."""
    y, design = RNG.normal(size=75), RNG.normal(size=(75, 2))
    y[[3, 20, 21, 22, 74]] = np.nan
    fine = Stretches.of(ResidualBlock("a", (design,), (y,)))
    twice, once = fine.coarser(4).coarser(4), fine.coarser(16)
    for name in ("rows", "residuals", "counts"):
        np.testing.assert_allclose(getattr(twice, name)[0], getattr(once, name)[0], rtol=1e-12)


def test_a_column_of_zeros_asks_for_no_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    """The zero of another log: singular values are numpy's, from the products alone."""
    design = np.column_stack((DESIGN[:, 0], np.zeros(40), DESIGN[:, 1:]))
    block = ResidualBlock("a", (design,), (np.ones(40),))
    monkeypatch.setattr(ResidualBlock, "stacked", property(lambda self: pytest.fail("asked for")))
    norm, singular, vectors = block.decomposed
    assert norm[1] == 1.0
    np.testing.assert_allclose(singular, np.linalg.svd(design / norm, compute_uv=False), atol=1e-12)
    np.testing.assert_allclose(np.abs(vectors[-1]), [0.0, 1.0, 0.0, 0.0], atol=1e-12)
    assert is_clear(block)
    assert linearise([block]).undetermined == ((1,),)
