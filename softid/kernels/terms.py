"""Terms of an equation of motion as compiled functions that are called by address.

A term is a small function with one fixed signature, so that adding one compiles that function and
nothing else: the integrator sees addresses. Terms act on

    (m a + i) (1 + Δm) + d(v) (1 + Δd) + q(x − s) (1 + Δq) + f = g

where m, i, d, q and g are the inertia, the inertial force without acceleration, the damping force,
the elastic force and the drive of the model.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

Array = npt.NDArray[np.float64]

FORCE, RATE, INERTIA, DAMPING, STIFFNESS, SHIFT = range(6)
"""Places in a term's result: resisting force f, rate of its own state, relative changes Δm, Δd and
Δq, and shift s of the position at which the spring is at ease."""

TERM_SIZE = 6
LAW_INERTIA, LAW_DAMPING, LAW_ELASTIC, LAW_DRIVE, LAW_INERTIAL = range(5)
"""Places in a law's result: m, d, q, g and i."""

FACTOR_INERTIA, FACTOR_INERTIAL, FACTOR_DAMPING, FACTOR_ELASTIC, N_FACTORS = range(5)
"""Places in the result of a law's slopes, which come filled: what m, i, d and q count by in the
unbalanced force. Behind them it adds the derivatives of that force by θ."""

_POINTER: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
SIGNATURE = types.void(*(types.float64,) * 5, _POINTER, _POINTER)
"""(position, velocity, own state, input, time, parameters, result) of a term or a law."""


def _call_term(
    context: Any,
    address: Any,
    x: Any,
    v: Any,
    z: Any,
    u: Any,
    t: Any,
    parameters: Any,
    result: Any,
) -> Any:
    """Call the term at an address; the last two arguments are addresses of float arrays."""
    del context, address, x, v, z, u, t, parameters, result
    signature = types.void(types.int64, *(types.float64,) * 5, types.int64, types.int64)

    def emit(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        del signature
        double = ir.DoubleType()
        pointer = double.as_pointer()
        function = ir.FunctionType(ir.VoidType(), [double] * 5 + [pointer] * 2)
        target = builder.inttoptr(values[0], function.as_pointer())
        arrays = [builder.inttoptr(value, pointer) for value in values[6:]]
        builder.call(target, [*values[1:6], *arrays])
        return context.get_dummy_value()

    return signature, emit


call_term: Any = intrinsic(_call_term)
"""Call the term at an address: (address, x, v, z, u, t, address of η, address of the result)."""


def compile_term(function: Callable[..., None]) -> Any:
    """Compile a term or a law; the result has its ``address``.

    Parameters
    ----------
    function
        ``function(x, v, z, u, t, parameters, result)`` that adds to entries of ``result``, which
        comes as zeros. It may use numbers, `math` and compiled functions, and
        makes no arrays.
    """
    try:
        return numba.cfunc(
            SIGNATURE,
            cache=True,
        )(function)
    except RuntimeError:  # typed at a prompt: there is no file beside which to cache
        return numba.cfunc(
            SIGNATURE,
        )(function)
