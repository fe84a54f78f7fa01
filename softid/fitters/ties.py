"""Parameters that are tied to others by an expression."""

from __future__ import annotations

from collections.abc import Sequence
from threading import Lock

import numpy as np
import numpy.typing as npt

from softid.parameters import ParameterSet

Array = npt.NDArray[np.float64]

STEP = 1e-6
"""Share of a parameter's size by which it is moved to see what its ties do: the error of a central
difference, of its square, is then as small as the rounding of what is divided by it."""

ROUNDING = 1e-9
"""Share of a bound by which a tie may pass it: the logarithm and back, over which a parameter is
searched, moves it by less."""

NOT_COMPUTABLE = (ArithmeticError, RuntimeError, TypeError, ValueError)
"""What arithmetic of numbers can raise: too large, by zero, a power that is refused, the order or
the real part of a complex number."""


class Ties:
    """The tied entries of all parameter values, computed from the others.

    Several threads may call one at once, and another process may be sent it.

    Parameters
    ----------
    parameters
        Bounds, scales, fixed values and ties.
    """

    def __init__(self, parameters: ParameterSet) -> None:
        self._parameters = parameters
        self._table = parameters.to_lmfit()
        for name in self._table:  # lmfit would clip what is computed, and one side of a difference
            self._table[name].set(min=-np.inf, max=np.inf)
        rows = list(parameters.values())
        self._places = [k for k, p in enumerate(rows) if p.tie is not None]
        self._lower = np.array([rows[k].lower for k in self._places])
        self._upper = np.array([rows[k].upper for k in self._places])
        self._alone = Lock()  # the table is shared by threads that try several starts

    def __reduce__(self) -> tuple[type[Ties], tuple[ParameterSet]]:
        return Ties, (self._parameters,)

    def __call__(self, theta: Array) -> Array:
        """The parameter values with every tie followed, shape (K,).

        A tied one that is outside its bounds is NaN, so that an optimiser steps elsewhere.

        Parameters
        ----------
        theta
            Parameter values, shape (K,); the tied ones do not matter.
        """
        values = self.computed(theta)
        tied = values[self._places]
        inside = np.clip(tied, self._lower, self._upper)
        with np.errstate(invalid="ignore"):
            is_kept = np.abs(tied - inside) <= ROUNDING * np.abs(inside)
        values[self._places] = np.where(is_kept, inside, np.nan)
        return values

    def nearest(self, theta: Array) -> Array:
        """The same with the nearest bound in place of what is outside, and finite everywhere."""
        values = self.computed(theta)
        tied = values[self._places]
        known = np.where(np.isfinite(tied), tied, theta[self._places])
        values[self._places] = np.clip(known, self._lower, self._upper)
        return values

    def computed(self, theta: Array) -> Array:
        """The same without regard to bounds; NaN where an expression is no finite number."""
        names, table = self._parameters.names, self._table
        values = theta.copy()
        with self._alone, np.errstate(all="ignore"):
            for name, value in zip(names, theta, strict=True):
                if table[name].expr is None:
                    table[name].value = value
            try:
                table.update_constraints()
            except NOT_COMPUTABLE:
                values[self._places] = [self._alone_computed(names[k]) for k in self._places]
            else:
                values[self._places] = [float(table[names[k]].value) for k in self._places]
        values[~np.isfinite(values)] = np.nan
        return values

    def _alone_computed(self, name: str) -> float:
        try:
            return float(self._table[name].value)
        except NOT_COMPUTABLE:
            return float("nan")


def ties_of(parameters: ParameterSet) -> Ties | None:
    """What computes the tied entries of all parameter values; None without ties.

    Parameters
    ----------
    parameters
        Bounds, scales, fixed values and ties.
    """
    return None if all(p.tie is None for p in parameters.values()) else Ties(parameters)


def tied_slopes(ties: Ties, theta: Array, places: Sequence[int], sizes: Array) -> Array:
    """Central differences of all parameter values by some of them, shape (K, F).

    Parameters
    ----------
    ties
        From `ties_of`.
    theta
        Parameter values, shape (K,).
    places, sizes
        Where those are that move, and a size of each, shape (F,).
    """
    found = np.zeros((theta.size, len(places)))
    for k, (index, h) in enumerate(zip(places, STEP * sizes, strict=True)):
        up, down = theta.copy(), theta.copy()
        up[index] += h
        down[index] -= h
        found[:, k] = (ties.computed(up) - ties.computed(down)) / (2.0 * h)
    return found
