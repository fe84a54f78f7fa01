"""Constants of the Levenberg–Marquardt iteration, for its compiled and its Python form."""

from __future__ import annotations

BEND_STEP = 0.1
"""Fraction of a step at which the second derivative along it is measured."""

SHORT_STEP = 0.1
"""Steps shorter than this share of what is plausible hardly bend: the correction would be a tenth
of the step or less, which the next one makes good, and to measure it takes a simulation."""

MOST_BEND = 0.75
"""A step whose acceleration is larger than this share of its velocity is too long to trust."""

LESS_BEND = 0.9
"""A step that bent too much is shortened to this share of what `MOST_BEND` allows: the share grows
with the length of the step, but turns with its direction too."""

MOST_SHORTENED = 0.1
"""Share of a step that is left at least: what bends without end may be one place only."""

INITIAL_DAMPING = 1e-9
LARGEST_DECREASE = 0.1
MOST_DAMPING = 1e30
LARGEST_STEP = 3.0
SMALLEST_STEP = 1e-11
STALL_EVALUATIONS = 30
STALL_GAIN = 1e-3
STALL_OFFSET = 5e-2
"""Within a twentieth of a standard error of the optimum the iteration also stops when thirty
evaluations have lowered the cost by less than a thousandth of the residual variance: along a valley
in which the parameters make up for each other it would creep on without end."""

DOUBLINGS = 40
SCALE_FLOOR = 1e-12
