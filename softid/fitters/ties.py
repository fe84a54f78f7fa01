"""Parameters that are tied to others by an expression."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from threading import Lock

import numpy as np
import numpy.typing as npt

from softid.parameters import ParameterSet

Array = npt.NDArray[np.float64]

STEP = 1e-6
"""Share of a parameter's size by which it is moved to see what its ties do: the error of a central
difference, of its square, is then as small as the rounding of what is divided by it."""


def tie_function(parameters: ParameterSet) -> Callable[[Array], Array] | None:
    """Function that recomputes the tied entries of all parameter values; None without ties.

    Parameters
    ----------
    parameters
        Bounds, scales, fixed values and ties.

    Returns
    -------
    callable or None
        Parameter values, shape (K,) → the same with every tie followed, shape (K,); several threads
        may call it at once, and another process may be sent it.
    """
    return None if all(p.tie is None for p in parameters.values()) else _Ties(parameters)


def tied_slopes(
    tied: Callable[[Array], Array], theta: Array, places: Sequence[int], sizes: Array
) -> Array:
    """Central differences of all parameter values by some of them, shape (K, F).

    Parameters
    ----------
    tied
        From `tie_function`.
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
        found[:, k] = (tied(up) - tied(down)) / (2.0 * h)
    return found


class _Ties:
    def __init__(self, parameters: ParameterSet) -> None:
        self._parameters = parameters
        self._table = parameters.to_lmfit()
        for name in parameters.free:  # lmfit would clip one side of a difference at a bound
            self._table[name].set(min=-np.inf, max=np.inf)
        self._alone = Lock()  # the table is shared by threads that try several starts

    def __reduce__(self) -> tuple[type[_Ties], tuple[ParameterSet]]:
        return _Ties, (self._parameters,)

    def __call__(self, theta: Array) -> Array:
        names, table = self._parameters.names, self._table
        with self._alone:
            for name, value in zip(names, theta, strict=True):
                if table[name].expr is None:
                    table[name].value = value
            table.update_constraints()
            return np.array([table[name].value for name in names])
