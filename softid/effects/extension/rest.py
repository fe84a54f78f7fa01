"""Rest of a motion with state effects: where its forces balance."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from softid.effects.base import StateEffect
from softid.effects.extension.terms import DIFFERENCE, Terms, moved_at, terms_of
from softid.effects.scale import Scale
from softid.models.base import Model
from softid.models.second_order import Law

if TYPE_CHECKING:
    from softid.kernels.equation import Equation

Array = npt.NDArray[np.float64]

ITERATIONS = 50
"""Newton's steps to a rest at most."""

TOLERANCE = 1e-12
"""The rest is found when a step is so small, in the scale of the states."""

AT_REST = slice(2, 4)
"""Those of the coefficients m, n, q and f that count at rest."""


def rest(
    model: Model,
    effects: Sequence[StateEffect],
    scale: Scale,
    theta: Array,
    eta: Array,
    u: float,
) -> float:
    """Position at rest under a constant input; NaN when there is none.

    Parameters
    ----------
    model, effects, scale, theta, eta
        As in `softid.effects.extension.motion.simulate_motion`.
    u
        The input.
    """
    terms = terms_of(tuple(effects), scale, eta)
    return rest_position(model, terms, theta, u, 0.0)


def rest_position(model: Model, terms: Terms, theta: Array, u: float, t: float) -> float:
    """Position at which nothing moves, by Newton's method from the model's own; NaN if none.

    Parameters
    ----------
    model
        The model without effects, with a law of motion.
    terms
        The effects.
    theta
        Parameters of the model, shape (K,).
    u, t
        Input, and time since the start of the log.
    """
    still = model.motion_law(theta) or model.motion_term(theta)
    assert still is not None
    x = still.equilibrium(u)
    if not terms.addresses.size:
        return x
    h = DIFFERENCE * terms.scale[0]
    balance = _unbalanced(model, terms, theta, u, t)
    for _ in range(ITERATIONS):
        left = balance(x)
        slope = (balance(x + h) - left) / h
        move = left / slope if slope != 0.0 else np.nan
        x -= float(np.clip(move, -terms.scale[0], terms.scale[0]))
        if not np.isfinite(x) or abs(move) < TOLERANCE * terms.scale[0]:
            return x
    return x


def rest_by(model: Model, terms: Terms, theta: Array, x: float, u: float, t: float) -> Array:
    """Derivatives of the position at rest by the parameters, from the balance of forces.

    Parameters
    ----------
    model, terms, theta, u, t
        As in `rest_position`.
    x
        The position at rest.

    Returns
    -------
    Array
        By θ and then by all that the terms hold, with zeros for constants, shape (K + H,).
    """
    law = model.motion_law(theta)
    by = np.zeros(theta.size + terms.eta.size)
    if law is not None and not terms.addresses.size:
        by[: theta.size] = law.equilibrium_by(u)
        return by
    balance = _unbalanced(model, terms, theta, u, t)
    left = balance(x)
    h = DIFFERENCE * terms.scale[0]
    slope = (balance(x + h) - left) / h
    if law is None:
        by[: theta.size] = _by_theta(model, terms, theta, x, u, t, left)
    else:
        by[: theta.size] = _by_law(law, terms, theta, x, u, t, left)
    for k in np.flatnonzero(terms.moves).tolist():
        step = terms.moves[k]
        elsewhere = replace(terms, eta=moved_at(terms.eta, k, step))
        there = _unbalanced(model, elsewhere, theta, u, t)(x)
        by[theta.size + k] = (there - left) / step
    np.divide(by, -slope, out=by)
    return by


def _by_law(
    law: Law, terms: Terms, theta: Array, x: float, u: float, t: float, left: float
) -> Array:
    """Derivatives of the force ``left`` at rest by θ, shape (K,).

    The force is affine in the stiffness and the drive.
    """
    packed, packed_by = law.packed(np.full((1, 3), u), derivatives=True)
    coefficients, by = packed[0, 0], packed_by[0, 0].reshape(4, -1)[AT_REST, : theta.size]
    equation = terms.equation(theta, None)
    sizes = np.where(coefficients == 0.0, 1.0, np.abs(coefficients))
    moved = coefficients + np.diag(sizes)[AT_REST]
    there = np.array([_left(equation, c, terms, u, t)(x) for c in moved])
    slopes = (there - left) / sizes[AT_REST]
    found: Array = slopes @ by
    return found


def _by_theta(
    model: Model, terms: Terms, theta: Array, x: float, u: float, t: float, left: float
) -> Array:
    """The same of a law that is not affine in its state, by differences."""
    by = np.zeros(theta.size)
    steps = DIFFERENCE * np.maximum(np.abs(theta), 1.0)  # it is affine in θ, some of which is zero
    for k, step in enumerate(steps):
        by[k] = (_unbalanced(model, terms, moved_at(theta, k, step), u, t)(x) - left) / step
    return by


def _unbalanced(
    model: Model, terms: Terms, theta: Array, u: float, t: float
) -> Callable[[float], float]:
    """Position → force that is left at rest there."""
    law, term = model.motion_law(theta), model.motion_term(theta)
    coefficients = np.zeros(4)
    if law is not None:  # else the kernel calls the law itself
        coefficients = law.packed(np.full((1, 3), u), derivatives=False)[0][0, 0]
    return _left(terms.equation(theta, term), coefficients, terms, u, t)


def _left(
    equation: Equation, coefficients: Array, terms: Terms, u: float, t: float
) -> Callable[[float], float]:
    from softid.kernels.term_integrator import unbalanced_at_rest

    return unbalanced_at_rest(equation, coefficients, terms.follows, u, t)
