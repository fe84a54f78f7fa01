"""Products and inverses of matrices too small for a library call to pay.

Columns are padded with zeros to whole vectors of `LANES` numbers, for which processors have
instructions.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from softid.kernels.decorators import inlined

Array = npt.NDArray[np.float64]

LANES = 8
"""Doubles in the widest vector registers, of 512 bits."""


def groups(count: int) -> int:
    """How many groups of `LANES` hold so many numbers."""
    return -(-count // LANES)


@inlined
def invert_block(matrices: Array, i: int, found: Array) -> None:
    """Inverse of matrix ``i`` of 3 rows and columns by its cofactors, not finite if singular.

    Parameters
    ----------
    matrices
        Matrices, shape (n, 3, 3).
    i
        Which of them.
    found
        Receives the inverse at the same place, shape (n, 3, 3).
    """
    a, b, c = matrices[i, 0, 0], matrices[i, 0, 1], matrices[i, 0, 2]
    d, e, f = matrices[i, 1, 0], matrices[i, 1, 1], matrices[i, 1, 2]
    g, h, j = matrices[i, 2, 0], matrices[i, 2, 1], matrices[i, 2, 2]
    first, second, third = e * j - f * h, f * g - d * j, d * h - e * g
    scale = 1.0 / (a * first + b * second + c * third)
    found[i, 0, 0], found[i, 1, 0], found[i, 2, 0] = first * scale, second * scale, third * scale
    found[i, 0, 1], found[i, 0, 2] = (c * h - b * j) * scale, (b * f - c * e) * scale
    found[i, 1, 1], found[i, 1, 2] = (a * j - c * g) * scale, (c * d - a * f) * scale
    found[i, 2, 1], found[i, 2, 2] = (b * g - a * h) * scale, (a * e - b * d) * scale


def _weighted_sum(
    context: Any, found: Any, weights: Any, rows: Any, count: Any, stride: Any
) -> Any:
    """Sum of rows of `LANES` numbers; arrays are given by their addresses."""
    del context, found, weights, rows, count, stride
    signature = types.void(*(types.int64,) * 5)

    def emit(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        del signature
        double, lanes = ir.DoubleType(), ir.VectorType(ir.DoubleType(), LANES)
        found, weights, rows, count, stride = values
        weights = builder.inttoptr(weights, double.as_pointer())
        rows = builder.inttoptr(rows, double.as_pointer())
        nothing = ir.Constant(lanes, [0.0] * LANES)
        total = cgutils.alloca_once_value(builder, nothing)  # type: ignore[no-untyped-call]
        with cgutils.for_range(builder, count) as loop:
            weight = builder.load(builder.gep(weights, [loop.index]))
            place = builder.gep(rows, [builder.mul(loop.index, stride)])
            row = builder.load(builder.bitcast(place, lanes.as_pointer()), align=8)
            spread = builder.insert_element(ir.Constant(lanes, ir.Undefined), weight, _FIRST)
            spread = builder.shuffle_vector(spread, spread, _ALL_FIRST)
            added = builder.fmul(spread, row, flags=["contract"])
            builder.store(builder.fadd(builder.load(total), added, flags=["contract"]), total)
        target = builder.inttoptr(found, lanes.as_pointer())
        builder.store(builder.load(total), target, align=8)
        return context.get_dummy_value()

    return signature, emit


_FIRST = ir.Constant(ir.IntType(32), 0)
_ALL_FIRST = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
"""Where a number is put into a vector, and which lane all lanes then take."""

weighted_sum: Any = intrinsic(_weighted_sum)
"""Write Σ wᵢ · rowᵢ, with rows of `LANES` numbers: (address of the result, address of w, address of
the first row, count, numbers from one row to the next). Written as one instruction for all lanes,
which the compiler does not find by itself where arrays might overlap."""


@inlined
def multiply_columns(matrix: Array, b: Array, found: Array) -> None:
    """Product of a matrix and many columns.

    Parameters
    ----------
    matrix
        The matrix, shape (m, n).
    b
        Columns in groups of `LANES`, shape (n, groups, LANES).
    found
        Receives the products as columns, shape (m, groups, LANES).
    """
    n, stride = b.shape[0], b.shape[1] * LANES
    to, by, rows = found.ctypes.data, matrix.ctypes.data, b.ctypes.data
    for i in range(found.shape[0]):
        for f in range(b.shape[1]):
            here = 8 * (i * stride + f * LANES)
            weighted_sum(to + here, by + 8 * i * n, rows + 8 * f * LANES, n, stride)
