"""Summed normal equations against those of the Jacobian, sample by sample."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from softid.fitters.normal_equations import _at_best_zeros, linearise, second_derivative
from softid.fitters.problem import Problem
from softid.log import Log
from softid.models.muscle import Muscle
from softid.models.oscillator import Oscillator
from softid.models.products import ALL_COLUMNS, NO_COLUMNS, Keep
from softid.simulation import simulate

Array = npt.NDArray[np.float64]
TRUTH = {"M": 2e-3, "a1": 1 / 70, "b1": 2.8, "c1": 1.0, "a2": 0.02, "b2": 1.6, "c2": 0.25}
DRIVE = {"M": 0.3, "N": 1.1, "Q": 20.0, "G": 1.0, "offset": 0.0}


def problem(outputs: tuple[str, ...], *, zeros: bool, linear: bool = False) -> Problem:
    """Two noisy logs, one moving at its start and with a stall, with samples left out."""
    model = (
        Oscillator() if linear else Muscle(fixed_length_mm=150.0, diameter_mm=20.0, inverted=True)
    )
    rng = np.random.default_rng(3)
    logs = []
    for moving in (False, True):
        time_s = np.cumsum(rng.uniform(0.008, 0.012, 300))
        u = 100.0 + (80.0 * np.sin(9 * time_s) if moving else np.where(time_s < 0.6, 0, 90.0))
        if moving:
            time_s = np.where(time_s > 1.6, time_s + 3.0, time_s)
        blank = Log.from_arrays(
            time_s, {"pressure": u, **dict.fromkeys(outputs, time_s)}, outputs=outputs
        )
        found = simulate(model, DRIVE if linear else TRUTH, blank).outputs
        noisy = {k: y + 0.3 + rng.normal(0.0, 0.01 * np.ptp(y), y.size) for k, y in found.items()}
        name = "moving" if moving else "still"
        log = Log.from_arrays(time_s, {"pressure": u, **noisy}, outputs=outputs, name=name)
        out = rng.random(300) < 0.1
        out[:60] = False
        logs.append(log.with_masked(out))
    return Problem(model, model.parameters(), logs, zeros=zeros)


def by_samples(p: Problem, z: Array, sigma: dict[str, float]) -> tuple[Array, ...]:
    """Moved z, cost, gradient, matrix, r and J from residual and Jacobian at every sample."""
    plans = p.plans(z)
    found = list(p.blocks(z, derivatives=True, plans=plans))
    moved, found = p.with_best_zeros(z, found)
    r = np.concatenate([b.residual / sigma[b.channel] for b in found])
    j = np.concatenate([b.jacobian / sigma[b.channel] for b in found if b.jacobian is not None])
    return moved, 0.5 * r @ r, j.T @ r, j.T @ j, r, j


def case(name: str) -> tuple[Problem, Array]:
    outputs = {
        "x": ("contraction",),
        "scaled": ("angle", "length"),
        "geometry": ("distance", "angle"),
        "drive": ("position",),
        "no zeros": ("angle",),
    }[name]
    p = problem(outputs, zeros=name != "no zeros", linear=name == "drive")
    z = p.unknowns(DRIVE if name == "drive" else TRUTH)
    return p, z + 0.03 * np.random.default_rng(8).normal(size=z.size)


@pytest.mark.parametrize("name", ["x", "scaled", "geometry", "drive", "no zeros"])
@pytest.mark.parametrize("keep", [NO_COLUMNS, ALL_COLUMNS])
def test_sums_equal_the_jacobian(name: str, keep: Keep) -> None:
    """Cost, Jᵀr, JᵀJ, n and moved zeros, from sums and from samples: to rounding, 1e-11."""
    p, z = case(name)
    sigma = {channel: 0.5 + k for k, channel in enumerate(p.outputs)}
    found = linearise(p, z, sigma, plans=p.plans(z), keep=keep)
    moved, cost, gradient, matrix, r, _ = by_samples(p, z, sigma)
    np.testing.assert_allclose(found.point, moved, rtol=1e-11)
    assert found.cost == pytest.approx(cost, rel=1e-11)
    assert found.n == r.size == p.n_samples
    scale = np.sqrt(np.diag(matrix))
    assert np.all(np.abs(found.matrix - matrix) <= 1e-11 * np.outer(scale, scale))
    assert np.all(np.abs(found.gradient - gradient) <= 1e-11 * scale * np.linalg.norm(r))


@pytest.mark.parametrize("name", ["x", "geometry", "drive", "no zeros"])
def test_kept_columns_make_up_residuals_and_jacobians(name: str) -> None:
    """What `Problem.blocks` simulates anew at the same unknowns, to rounding."""
    p, z = case(name)
    plans = p.plans(z)
    found = linearise(p, z, dict.fromkeys(p.outputs, 1.0), plans=plans, keep=ALL_COLUMNS)
    wanted = list(p.blocks(found.point, derivatives=True, plans=plans))
    for block, anew in zip(found.blocks(derivatives=True), wanted, strict=True):
        assert (block.channel, block.segment) == (anew.channel, anew.segment)
        np.testing.assert_allclose(block.residual, anew.residual, atol=1e-10)
        assert block.jacobian is not None
        np.testing.assert_allclose(block.jacobian, anew.jacobian, rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("name", ["x", "geometry", "no zeros"])
def test_residuals_are_kept_without_the_other_columns(name: str) -> None:
    """The same as with all of them; only a law whose products no kernel sums has those anyway."""
    p, z = case(name)
    sigma = dict.fromkeys(p.outputs, 1.0)
    whole = linearise(p, z, sigma, plans=p.plans(z), keep=ALL_COLUMNS)
    found = linearise(p, z, sigma, plans=p.plans(z), keep=Keep(3, residual=True))
    assert found.has_residuals
    assert found.kept == (name == "geometry")
    rows = zip(found.blocks(derivatives=False), whole.blocks(derivatives=False), strict=True)
    for block, expected in rows:
        np.testing.assert_array_equal(block.residual, expected.residual)


@pytest.mark.parametrize("name", ["x", "geometry", "no zeros"])
def test_the_same_pieces_under_other_zeros_and_weights(name: str) -> None:
    """As `Problem.blocks` and `linearise` have it with σ = 2 and zeros 0.1 higher, to rounding.

    Nothing is simulated for it; a log without zeros has none to move.
    """
    p, z = case(name)
    plans = p.plans(z)
    found = linearise(p, z, dict.fromkeys(p.outputs, 1.0), plans=plans, keep=ALL_COLUMNS)
    elsewhere = found.point.copy()
    if p.zeros:
        elsewhere[[p.zero_position(k, c) for k in (0, 1) for c in p.outputs]] += 0.1
    wanted = list(p.blocks(elsewhere, derivatives=False, plans=plans))
    shifted = found.with_zeros_of(elsewhere)
    for block, anew in zip(shifted.blocks(derivatives=False), wanted, strict=True):
        np.testing.assert_allclose(block.residual, anew.residual, atol=1e-10)
    doubled = shifted.weighted(dict.fromkeys(p.outputs, 2.0))
    np.testing.assert_allclose(doubled.point, found.point, atol=1e-10)
    assert 4.0 * doubled.cost == pytest.approx(found.cost, rel=1e-10)


def test_pieces_stay_as_they_were_summed() -> None:
    """What moves zeros to their optimum takes pieces that nobody may write into."""
    p, z = case("x")
    sigma = dict.fromkeys(p.outputs, 1.0)
    found = linearise(p, z, sigma, plans=p.plans(z), keep=ALL_COLUMNS)
    for piece in found.pieces:
        piece.residual.setflags(write=False)
    elsewhere = found.point.copy()
    elsewhere[p.zero_position(0, "contraction")] += 0.1
    away = found.with_zeros_of(elsewhere)
    before = [piece.residual.copy() for piece in away.pieces]
    np.testing.assert_allclose(away.weighted(sigma).cost, found.cost, rtol=1e-10)
    for piece, kept in zip(away.pieces, before, strict=True):
        np.testing.assert_array_equal(piece.residual, kept)
    _, there = _at_best_zeros(p, found.point, found.pieces)
    assert all(new is not old for new, old in zip(there, found.pieces, strict=True))


@pytest.mark.parametrize("name", ["x", "geometry", "drive"])
def test_bend_is_the_second_derivative_seen_from_the_parameters(name: str) -> None:
    """Jᵀ·2(ŷ(z + hv) − ŷ(z) − hJv)/h² from samples, to 1e-6: rounding over h² with h = 0.1.

    Where columns were only summed, the kernel sums those with the difference, too.
    """
    p, z = case(name)
    sigma = dict.fromkeys(p.outputs, 0.7)
    plans = p.plans(z)
    at = linearise(p, z, sigma, plans=plans, keep=ALL_COLUMNS)
    step = 0.02 * np.random.default_rng(2).normal(size=z.size)
    moved, _, _, _, r, j = by_samples(p, z, sigma)
    there = p.blocks(moved + 0.1 * step, derivatives=False, plans=plans)
    residual = np.concatenate([b.residual / sigma[b.channel] for b in there])
    expected = j.T @ (2.0 / 0.01 * (r - residual - 0.1 * j @ step))
    found = second_derivative(p, at, at.point, step, sigma, plans=plans, fraction=0.1)
    assert found is not None
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())
    summed = linearise(p, z, sigma, plans=plans, keep=NO_COLUMNS)
    assert summed.kept == (name == "geometry")  # a distance, nonlinear in x, is never only summed
    again = second_derivative(p, summed, summed.point, step, sigma, plans=plans, fraction=0.1)
    assert again is not None
    np.testing.assert_allclose(again, expected, atol=1e-6 * np.abs(expected).max())


def test_a_point_without_a_finite_response_costs_infinitely() -> None:
    """b1 = e⁵⁰ per bar overflows: an infinite cost and a regular matrix, not an error."""
    p, z = case("x")
    z[p.free.index("b1")] = 50.0
    found = linearise(p, z, {"contraction": 1.0}, plans=None, keep=ALL_COLUMNS)
    assert found.cost == np.inf
    assert np.isfinite(found.matrix).all()
    assert replace(found, cost=1.0).pieces == found.pieces
