"""Parameters that are tied to others by an expression."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock

import numpy as np
import numpy.typing as npt

from softid.parameters import ParameterSet

Array = npt.NDArray[np.float64]


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
        may call it at once.
    """
    if all(p.tie is None for p in parameters.values()):
        return None
    table = parameters.to_lmfit()
    names = parameters.names
    for name in parameters.free:  # lmfit would clip one side of a difference at a bound
        table[name].set(min=-np.inf, max=np.inf)
    alone = Lock()  # the table is shared by threads that try several starts

    def tied(theta: Array) -> Array:
        with alone:
            for name, value in zip(names, theta, strict=True):
                if table[name].expr is None:
                    table[name].value = value
            table.update_constraints()
            return np.array([table[name].value for name in names])

    return tied
