"""Where everything stands in the arrays that a compiled fit of an affine law works on.

A piece is one measured output over one segment. Segments follow each other in one array each of
times, input and counts; measured outputs follow each other channel by channel, each as long as the
times. What an iteration needs stands in few arrays of many rows: the compiler spends most of its
time on passing arrays. Names are of numpy's type since it would compile a function once more for
every plain integer that it is given.
"""

from __future__ import annotations

import numpy as np

from softid.kernels.lanes import N_COLUMNS, N_PADDED

LAW, RULE, BEGIN, END, OUTPUT, CHANNEL, ANCHORED, STATE_AT, STATES, ZERO_AT = (
    np.int64(k) for k in range(10)
)
"""Columns of ``pieces``: kind of the law; RK4 or RADAU; first sample and the one behind the last;
what leads from a sample to its measurement; channel; whether the piece starts from the equilibrium
of its first input, or so far from it; the unknown that its initial state begins at, −1 at rest, and
how many there are; the unknown that is its zero, −1 for none."""

PIECE_COLUMNS = 10

GAIN, LEVEL, WEIGHT = (np.int64(k) for k in range(3))
"""Columns of ``lines``: the output of a piece is gain·x + level and its zero, with weight 1/σ²."""

PARAMETER, LOGARITHMIC = np.int64(0), np.int64(1)
"""Rows of ``free``: which of the kernels' parameters a free one is, times a factor that is a row of
the vectors, and whether the unknown is its logarithm."""

(
    FACTOR, LOWER, UPPER, REACH, CENTRE, PRIOR, HELD, MOVING,
    TAKEN, SHARE, MADE, PULLED, TOTAL, SCALE, CUT,
    THERE, PULL, CORRECTION, STEP, NOW,
) = (np.int64(k) for k in range(20))  # fmt: skip
"""Rows of ``vectors``. By unknown: factors of the free parameters, bounds, plausible moves, centre
and weight of a prior, scales that hold the damping, and whether it moves. By column: which unknown
it belongs to, −1 for none, how much of it, a straight line, and what that leaves. Then sums over
the zeros, scales and a step within the bounds; a point to bend at, its pull, a correction and a
step; and numbers of the iteration."""

POINT, SHIFT, GRADIENT = (np.int64(20 + 2 * k) for k in range(3))
"""Rows of which there are two, one for the place where the fit stands and one for what it tries:
unknowns, by how much zeros were moved there, and Jᵀr."""

N_VECTORS = 26

COST, DAMPING, GROWTH, USED, NEXT_LOOK, SEEN, PREDICTED = range(7)
"""Columns of the row `NOW`."""

CHUNK = 512
"""Samples between two looks at the same columns, so that they are still near."""


def width(size: int) -> int:
    """Columns of ``vectors`` for so many unknowns."""
    return max(size, N_COLUMNS)


def gram_rows(pieces: int) -> int:
    """Rows of ``grams``: products of the columns of every piece, at either place."""
    return 2 * pieces * N_PADDED
