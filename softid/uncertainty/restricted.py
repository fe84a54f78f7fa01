"""Autoregression of the noise itself, seen through residuals from which a fit took its share.

A fit absorbs whatever part of a slow noise its regressors can follow, so that the residual looks
less persistent than the noise was, and intervals made from it are too short. The restricted
likelihood works on what no parameter can reach and is free of that loss.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError
from softid.kernels.restricted_likelihood import reduce_forms, weigh_products
from softid.uncertainty.autoregression import AutoRegression, to_phi, to_reflection
from softid.uncertainty.moments import Moments

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]

REFLECTION_STEP = 1e-3
"""Step of the central differences in artanh k; second differences are then good to 1e-3."""

Differences = tuple[Array, Array, tuple[float, float]]

SIGNS = np.array([[1.0], [-1.0]])
CORNERS = np.array([1.0, -1.0, -1.0, 1.0])
"""Both ways of a step: a mixed difference takes all four corners, with these signs."""

MAX_ITERATIONS = 30
"""Newton steps; five are usual."""

DAMPINGS = np.concatenate(([0.0], np.geomspace(1e-2, 1e3, 7)))
"""Dampings tried in each step, in units of the largest curvature: none, and from a step that is
hardly shortened to one along the gradient, seven times as much each."""

MIN_CURVATURE = 1e-3
"""A direction of the noise model flatter than this is given a spread of 45 in artanh k."""


@dataclass(frozen=True, eq=False)
class Objective:
    """−2 log restricted likelihood, the innovation variance profiled out, at B candidates.

    Attributes
    ----------
    value
        The objective up to a constant, shape (B,); infinite where it cannot be computed.
    innovation_variance
        Its estimate at each candidate, shape (B,).
    """

    value: Array
    innovation_variance: Array


def evaluate(moments: Moments, reflection: Array) -> Objective:
    """Restricted likelihood of several autoregressions at once.

    −2ℓ = (n − m) log σ² + log|V| + log|QᵀV⁻¹Q| with σ² = rᵀP r/(n − m), V the covariance for unit
    innovations, Q the reachable basis and P = V⁻¹ − V⁻¹Q(QᵀV⁻¹Q)⁻¹QᵀV⁻¹.

    Parameters
    ----------
    moments
        From `gather_moments`.
    reflection
        Reflection coefficients, shape (B, q) with q at most the order of the moments.

    Notes
    -----
    H. D. Patterson and R. Thompson, Biometrika 58 (1971) 545; the prediction-error form of log|V|
    and V⁻¹ is Levinson's.
    """
    count, packed = len(reflection), moments.packed
    weights, ratios = np.empty((count, len(packed))), np.empty((count, moments.counts.size))
    weigh_products(reflection, *moments.terms, weights, ratios)
    determinant, left = np.empty(count), np.empty(count)
    reduce_forms(packed.T @ weights.T, ratios, moments.counts, determinant, left)
    good = left > 0.0
    freedom = moments.n - moments.reachable
    variance = np.where(good, left, 1.0) / freedom
    value = freedom * np.log(variance) + determinant
    return Objective(np.where(good, value, np.inf), variance)


@dataclass(frozen=True, eq=False)
class RestrictedFit:
    """An autoregression by restricted likelihood and how well it is known.

    Attributes
    ----------
    ar
        The model of the noise.
    position
        Optimum in artanh k, shape (q,).
    spread
        Covariance of the position, shape (q, q).
    freedom
        Samples less reachable directions.
    """

    ar: AutoRegression
    position: Array
    spread: Array
    freedom: int


def restricted_ar(moments: Moments, start: AutoRegression) -> RestrictedFit:
    """Refine an autoregression by restricted maximum likelihood at its own order.

    Newton's method in artanh of the reflection coefficients, so every trial is stable, with the
    damping chosen among a ladder of trials in each step. Reflection coefficients are kept below
    exp(−1/n) of the longest stretch, and roots too, see `draw_in`. The noise is never taken for
    smaller than the residuals themselves.

    Parameters
    ----------
    moments
        Lagged products of residuals and Jacobian basis.
    start
        Model from `fit_ar`; its order is kept.

    Returns
    -------
    RestrictedFit

    Raises
    ------
    IdentificationError
        The parameters can follow every sample, so that nothing tells about the noise.
    """
    if moments.n <= moments.reachable:
        raise IdentificationError(
            f"{moments.reachable} parameters can follow all of {moments.n} residuals",
            remedy="use a longer log, or fix some parameters",
        )
    limit = np.arctanh(np.exp(-1.0 / max(moments.longest, 2)))
    x = np.clip(np.arctanh(to_reflection(np.asarray(start.phi))), -limit, limit)
    if not x.size:
        return _finish(moments, start, x, None)
    known, stencil = None, Stencil.of(x.size)
    for _ in range(MAX_ITERATIONS):
        known = differences(moments, x, stencil)
        gradient, curvature, (value, _) = known
        trial = np.clip(x + damped_steps(gradient, curvature), -limit, limit)
        found = evaluate(moments, np.tanh(trial)).value
        best = int(np.argmin(found))
        if not found[best] < value - 1e-7:
            break
        x, known = trial[best], None
    if known is None:
        known = differences(moments, x, stencil)
    return _finish(moments, start, x, known)


def _finish(
    moments: Moments, start: AutoRegression, x: Array, known: Differences | None
) -> RestrictedFit:
    phi, capped = draw_in(to_phi(np.tanh(x)), moments.longest)
    reflection = to_reflection(phi)
    left = float(np.prod(1.0 - reflection**2))
    variance = 0.0 if known is None else known[2][1]
    if known is None or capped:
        variance = float(evaluate(moments, reflection[None]).innovation_variance[0])
    variance = max(variance, start.sigma**2 * left)
    ar = AutoRegression(
        phi=tuple(phi.tolist()),
        sigma_innovation=float(np.sqrt(variance)),
        sigma=float(np.sqrt(variance / left)),
        n=start.n,
        aicc=start.aicc,
        bic=start.bic,
    )
    if known is None:
        return RestrictedFit(ar, x, np.zeros((0, 0)), moments.n - moments.reachable)
    values, vectors = np.linalg.eigh(known[1])
    spread = (vectors / np.maximum(values, MIN_CURVATURE)) @ vectors.T * 2.0
    return RestrictedFit(ar, np.arctanh(reflection), spread, moments.n - moments.reachable)


def draw_in(phi: Array, longest: int) -> tuple[Array, bool]:
    """Shrink the roots of φ to a radius of at most exp(−1/longest), φ_j ← φ_j cʲ.

    A root beyond means a memory longer than any stretch shows; without a limit the variance that
    the restricted likelihood implies has none either.

    Returns
    -------
    phi, capped
        The coefficients, and whether they were changed.
    """
    limit = float(np.exp(-1.0 / longest))
    powers = limit ** np.arange(1.0, phi.size + 1.0)
    if float(np.sum(np.abs(phi) / powers)) <= 1.0:
        return phi, False  # beyond the limit zᵖ outweighs all other terms, as most often
    trimmed = np.trim_zeros(phi, "b")
    radius = float(np.max(np.abs(np.roots(np.concatenate(([1.0], -trimmed))))))
    if radius <= limit:
        return phi, False
    return phi * (limit / radius) ** np.arange(1, phi.size + 1), True


@dataclass(frozen=True, eq=False)
class Stencil:
    """Where the objective is asked for its differences.

    Attributes
    ----------
    first, second
        The coordinates of every pair, each of shape (P,).
    moves
        From the centre: none, up and down each coordinate, and to the four corners of each pair,
        shape (1 + 2q + 4P, q).
    """

    first: Index
    second: Index
    moves: Array

    @classmethod
    def of(cls, q: int) -> Stencil:
        """In so many coordinates."""
        first, second = np.triu_indices(q, 1)
        eye = REFLECTION_STEP * np.eye(q)
        pairs = eye[first][:, None, None] * SIGNS[:, None] + eye[second][:, None, None] * SIGNS
        moves = np.concatenate([np.zeros((1, q)), eye, -eye, pairs.reshape(4 * first.size, q)])
        return cls(first, second, moves)


def differences(moments: Moments, x: Array, stencil: Stencil) -> Differences:
    """Gradient and Hessian of the objective in artanh k, its value and the innovation variance."""
    q = x.size
    found = evaluate(moments, np.tanh(x + stencil.moves))
    value = found.value
    centre, plus, minus = value[0], value[1 : q + 1], value[q + 1 : 2 * q + 1]
    gradient = (plus - minus) / (2.0 * REFLECTION_STEP)
    curvature = np.diag((plus - 2.0 * centre + minus) / REFLECTION_STEP**2)
    mixed = value[2 * q + 1 :].reshape(-1, 4) @ CORNERS / (4.0 * REFLECTION_STEP**2)
    curvature[stencil.first, stencil.second] = curvature[stencil.second, stencil.first] = mixed
    return gradient, curvature, (float(centre), float(found.innovation_variance[0]))


def damped_steps(gradient: Array, curvature: Array) -> Array:
    """Newton steps at damping from none to strong, shape (8, q); downhill for any curvature."""
    values, vectors = np.linalg.eigh(curvature)
    size = np.maximum(np.abs(values), 1e-6)
    along = vectors.T @ gradient
    ladder = DAMPINGS * size.max()
    steps: Array = -(along / (size + ladder[:, None])) @ vectors.T
    return steps
