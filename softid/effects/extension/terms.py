"""State effects as the kernel wants them: addresses, parameters and own states in arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from softid.effects.base import StateEffect
from softid.effects.scale import Scale
from softid.models.base import MotionTerm

if TYPE_CHECKING:
    from softid.kernels.equation import Equation

Array = npt.NDArray[np.float64]

DIFFERENCE = 1e-7
"""Relative step by which parameters and states are moved to differentiate the terms within a step:
their values are exact to rounding, so a smaller one does than for whole responses."""


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms of an equation of motion.

    Attributes
    ----------
    addresses
        Of the compiled steps, shape (E,).
    eta
        Parameters and constants of all effects one after the other, shape (H,).
    eta_from
        Where those of each effect begin, shape (E + 1,).
    own
        Which of the own states belongs to each effect, -1 for none, shape (E,).
    follows
        Which own states rest at the position.
    scale
        Ranges of x, v and the own states.
    moves
        By how much each entry of ``eta`` is moved to differentiate; 0 for a constant.
    columns
        Which entries of ``eta`` are parameters, not constants.
    """

    addresses: npt.NDArray[np.int64]
    eta: Array
    eta_from: npt.NDArray[np.int64]
    own: npt.NDArray[np.int64]
    follows: tuple[bool, ...]
    scale: Array
    moves: Array
    columns: npt.NDArray[np.int64]

    @property
    def n_own(self) -> int:
        """Number of own states."""
        return len(self.follows)

    @property
    def followers(self) -> npt.NDArray[np.intp]:
        """Which of the own states rest at the position."""
        return np.flatnonzero(self.follows)

    def equation(self, theta: Array, term: MotionTerm | None) -> Equation:
        """What the kernel integrates; it moves and restores the arrays, so they are its own."""
        from softid.kernels.equation import Equation

        law, slopes = (0, 0) if term is None else (term.address, term.slopes_address)
        own = theta.copy() if term is None else term.parameters.copy()[: theta.size]
        eta = self.eta.copy()
        return Equation(law, slopes, own, self.addresses, eta, self.eta_from, self.own)


def terms_of(effects: tuple[StateEffect, ...], scale: Scale, eta: Array) -> Terms:
    """The terms at some parameters.

    Parameters
    ----------
    effects
        The effects.
    scale
        Sizes that their constants go by.
    eta
        Their parameters one after the other, shape (H,).
    """
    declared = _declared(effects, scale)
    values = declared.eta.copy()
    values[declared.columns] = eta
    return replace(declared, eta=values)


@lru_cache(maxsize=512)
def _declared(effects: tuple[StateEffect, ...], scale: Scale) -> Terms:
    """The terms with the values that are declared: the rest of them does not change in a fit."""
    values: list[float] = []
    begins, own = [0], []
    columns: list[int] = []
    follows: list[bool] = []
    sizes: list[float] = []
    for effect in effects:
        declared = effect.parameters(scale)
        columns.extend(range(len(values), len(values) + len(declared)))
        constants = effect.constants(scale)
        values.extend((*declared.values_vector().tolist(), *constants))
        sizes.extend(parameter.usual_size for parameter in declared.values())
        sizes.extend(0.0 for _ in constants)  # nobody asks how the motion goes with them
        begins.append(len(values))
        own.append(len(follows) if effect.has_state else -1)
        if effect.has_state:
            follows.append(effect.follows_position)
    ranges = [scale.x_span, scale.v_max, *(scale.x_span if does else 1.0 for does in follows)]
    return Terms(
        np.array([effect.address() for effect in effects], np.int64),
        np.array(values, np.float64),
        np.array(begins, np.int64),
        np.array(own, np.int64),
        tuple(follows),
        np.array(ranges, np.float64),
        DIFFERENCE * np.array(sizes),
        np.array(columns, np.int64),
    )


def moved_at(values: Array, k: int, step: float) -> Array:
    """Values of which the k-th is moved by a step, to differentiate by it.

    Parameters
    ----------
    values
        All of them, shape (n,); they stay.
    k
        Which one.
    step
        By how much.
    """
    moved = values.copy()
    moved[k] += step
    return moved
