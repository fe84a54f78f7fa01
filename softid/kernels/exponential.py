"""exp in plain arithmetic, so that loops over it become vector instructions, and tanh by exp."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit, types
from numba.extending import intrinsic

_LOG2_E = 1.4426950408889634
_LN2_HIGH = 6.93147180369123816490e-01
_LN2_LOW = 1.90821492927058770002e-10
_LARGEST = 708.0
_C2, _C3, _C4, _C5, _C6, _C7, _C8, _C9, _C10, _C11, _C12, _C13 = (
    1.0 / math.factorial(k) for k in range(2, 14)
)
"""1/ln 2; ln 2 in two parts, of which the first ends in zeros, so that a whole number times it is
exact; the largest argument, short of 709.8, where e^x overflows; and the Taylor coefficients."""

NO_REORDERING = {"contract", "arcp", "nsz"}
"""Freedoms that let a multiply and an add become one instruction, and nothing that reorders."""


@intrinsic
def _float_of_bits(typing_context: Any, bits: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], context.get_value_type(types.float64))

    return types.float64(types.int64), generate


_FLOAT_OF_BITS: Any = _float_of_bits


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING, inline="always")
def exponential(x: float) -> float:
    """exp(x) within two units of the last place; infinite above 708 and for NaN, e⁻⁷⁰⁸ below −708.

    x = k·ln 2 + r with |r| ≤ ½ ln 2, the Taylor polynomial of degree 13 in r (its remainder is
    4e-18), and 2ᵏ written into the exponent's bits. A call of the system's exp would break up the
    vector loops around it.
    """
    held = min(max(x, -_LARGEST), _LARGEST)
    k = np.floor(held * _LOG2_E + 0.5)
    r = held - k * _LN2_HIGH
    r = r - k * _LN2_LOW
    p = _C13 * r + _C12
    p = p * r + _C11
    p = p * r + _C10
    p = p * r + _C9
    p = p * r + _C8
    p = p * r + _C7
    p = p * r + _C6
    p = p * r + _C5
    p = p * r + _C4
    p = p * r + _C3
    p = p * r + _C2
    p = p * r * r + r + 1.0
    bits = (np.int64(k) + 1023) << 52
    found = p * _FLOAT_OF_BITS(bits)
    return float(found if x <= _LARGEST else np.inf)


@njit(nogil=True, error_model="numpy", inline="always")
def hyperbolic_tangent(x: float) -> float:
    """tanh(x) = 1 − 2/(1 + e²ˣ), within four roundings of 1, three times as fast as libm's."""
    return 1.0 - 2.0 / (1.0 + math.exp(2.0 * x))
