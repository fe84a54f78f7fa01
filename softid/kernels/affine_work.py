"""What a compiled fit of an affine law works on.

Segments follow each other in one array each of times, input and counts; measured outputs follow
each other channel by channel, each as long as the times.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]

CHUNK = 512
"""Samples between two looks at the same columns, so that they are still near."""


class Drive(NamedTuple):
    """What is simulated.

    Attributes
    ----------
    law
        MUSCLE or OSCILLATOR.
    theta
        The kernels' parameters and gain, where the free ones are overwritten, shape (8,).
    time_s, u
        Sample times and input of all segments, each of shape (N,).
    counts
        Steps per sampling interval, shape (N,); the last one of every segment means nothing.
    edges
        Where each segment begins, and N, shape (S + 1,).
    rules
        RK4 or RADAU for every segment, shape (S,).
    anchored
        Whether a segment starts from the equilibrium of its first input, or so far from it.
    """

    law: int
    theta: Array
    time_s: Array
    u: Array
    counts: npt.NDArray[np.int16]
    edges: Index
    rules: Index
    anchored: BoolArray


class Measured(NamedTuple):
    """What it is compared with.

    Attributes
    ----------
    y, used
        Measured outputs and which samples count, each of shape (C·N,).
    gain, level
        Every output is gain·x + level and its sensor zero, each of shape (C,).
    weight
        1/σ² of every output, shape (C,).
    """

    y: Array
    used: BoolArray
    gain: Array
    level: Array
    weight: Array


class Unknowns(NamedTuple):
    """What is sought: U unknowns, F of them parameters.

    Attributes
    ----------
    inner, factor, logarithmic
        Which of the kernels' parameters a free one is, times what, and whether the unknown is its
        logarithm, each of shape (F,).
    zero_at
        Which unknown is the zero of a segment and channel, −1 for none, shape (S, C).
    state_at
        From where the initial state of a segment stands, −1 at rest, shape (S,).
    states
        How many initial states there are, up to two.
    lower, upper, reach
        As `minimise` takes them, each of shape (U,).
    centre, prior
        Centre and weight of a prior, each of shape (U,); zeros for none.
    """

    inner: Index
    factor: Array
    logarithmic: BoolArray
    zero_at: Index
    state_at: Index
    states: int
    lower: Array
    upper: Array
    reach: Array
    centre: Array
    prior: Array


class Room(NamedTuple):
    """Two places to evaluate at, the one where the fit stands and the one that it tries.

    Attributes
    ----------
    point, shift, gradient
        Unknowns, by how much zeros were moved there, and Jᵀr, each of shape (2, U).
    matrix
        JᵀJ, shape (2, U, U).
    gram
        Products of the columns of every segment and channel, shape (2, S, C, 12, 12).
    first, second
        The columns at every sample at either place, each of shape (C·11, N); of shape (C·11, 0)
        when none are kept.
    x
        Positions along a trial, shape (N,), or (0,) without columns.
    work, ends
        A block of steps and the samples that its steps end on.
    solve
        For linear systems, shape (U + 1, U).
    state, tangent, at, away
        A state, its derivatives, a place in a log and some residuals, of shapes (2,), (2, 9), (2,)
        and (`CHUNK`,).
    small
        Vectors that come and go, shape (5, max(U, 11)).
    """

    point: Array
    shift: Array
    gradient: Array
    matrix: Array
    gram: Array
    first: Array
    second: Array
    x: Array
    work: Array
    ends: Index
    solve: Array
    state: Array
    tangent: Array
    at: Index
    away: Array
    small: Array


class Rules(NamedTuple):
    """Constants of the iteration, as `softid.fitters.levenberg_marquardt` explains them.

    Attributes
    ----------
    bends
        Whether to stop before a long step where no columns are kept to tell how it bends.
    """

    bends: bool
    tolerance: float
    bend_step: float
    short_step: float
    most_bend: float
    less_bend: float
    most_shortened: float
    initial_damping: float
    largest_decrease: float
    most_damping: float
    largest_step: float
    smallest_step: float
    stall_evaluations: int
    stall_gain: float
    stall_offset: float
    doublings: int
    scale_floor: float
