"""A block of steps laid out for vector instructions, and the law that it follows.

A block holds LANES stretches of ROWS steps that follow each other in time; row j holds step j of
every stretch, so that one vector instruction advances all stretches by a step. Every stretch first
runs from zero along with its propagator; its true start then follows from the end of the one
before it, since the law is affine in its state. All arrays of a block lie in one flat workspace at
constant places: the compiler then sees that they do not overlap.

The law is m·ẍ + (a2·E₂ + c2)·ẋ + (a1·E₁ + c1)·x = E₁, where E₁ and E₂ depend on the input alone:
for the muscle they are exp(b1·p) and exp(b2·p); the oscillator has E₁ = G·(u − offset) and a1 = a2
= 0. Parameters are m, a1, b1, c1, a2, b2, c2, b1 standing for whatever E₁ depends on.

What runs over a block has a file for each of its passes: `affine_coefficients` for E₁ and E₂,
`affine_motion` for the states, `affine_derivatives` for the sensitivities, and `affine_products`
for the normal equations. `affine_simulation` takes a log through them, block by block.
"""

from __future__ import annotations

LANES = 8
"""Stretches side by side: as many doubles as the widest vector registers hold, of 512 bits."""

ROWS = 16
"""Steps of a stretch, so few that the workspace, of 43 kB, stays in the fastest cache."""

STEPS = ROWS * LANES
POINTS = STEPS + LANES
"""Starts of all steps and, in the last row, the ends of the stretches."""

MUSCLE, OSCILLATOR = 0, 1
RK4, RADAU = 0, 1
N_PARAMETERS = 7
N_STATES = 2
"""The laws and rules that a block can follow, and the numbers of parameters and initial states that
it takes derivatives by."""

INPUT, STEP = 0 * POINTS, 1 * POINTS
START, INNER, OUTER = 2 * POINTS, 6 * POINTS, 10 * POINTS
E1, D1, E2, D2 = 0 * POINTS, 1 * POINTS, 2 * POINTS, 3 * POINTS
"""E₁, ∂E₁/∂b1, E₂ and ∂E₂/∂b2 at starts and at the one or two inner places of every step."""

XX, XV, VX, VV = 14 * POINTS, 15 * POINTS, 16 * POINTS, 17 * POINTS
PXX, PXV, PVX, PVV = 18 * POINTS, 19 * POINTS, 20 * POINTS, 21 * POINTS
"""Φ of every step, and the propagator from the start of its stretch."""

X, V = 22 * POINTS, 23 * POINTS
BY = 24 * POINTS
"""∂x by the parameters and the initial state at the ends of the steps."""

ONE = BY + (N_PARAMETERS + N_STATES) * POINTS
RESIDUAL = ONE + POINTS
"""Share of every step's end in the cost, 0 or 1, and y and then the residual there; after `BY`."""

_ZERO = RESIDUAL + POINTS
BY_V = _ZERO + POINTS
STARTS_X = BY_V + N_PARAMETERS * LANES
STARTS_V = STARTS_X + (N_PARAMETERS + N_STATES) * LANES
"""Derivatives by the parameters at the running row, and what every stretch starts from."""

ROW_X = STARTS_V + (N_PARAMETERS + N_STATES) * LANES
ROW_V = ROW_X + POINTS
SIZE = ROW_V + POINTS
N_COLUMNS = N_PARAMETERS + N_STATES + 2
N_PADDED = N_COLUMNS + 1
"""Columns from `BY` on that are summed, and with a last one of zeros that makes them even."""

GIVEN = (INNER + D1, OUTER + D1, START + D1 + LANES)
"""Where `fill_from_stages` expects the input at the three stages of every step."""
