"""Sampling intervals divided into steps, and the rule that takes them.

Between samples the input is taken as straight. A sampling interval is divided where the input
changes so much that the coefficients bend within it, or where the motion is fast for the interval.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from softid.kernels.radau import STAGES
from softid.kernels.step_counts import count_steps
from softid.parallel import on_two_threads

if TYPE_CHECKING:
    from softid.models.second_order import Law
    from softid.segment import Segment

Array = npt.NDArray[np.float64]

Rule = Literal["rk4", "radau"]

RADAU_COST = 1.35
"""Cost of a Radau step in Runge–Kutta steps, with seven sensitivities and the normal matrix."""

NODES_PER_STEP = 16
"""Nodes within a step at which effects on the input act, which may put a corner into it."""

SMOOTH_NODES = 4
"""Nodes within a step at which effects on the input act where what arrives has no corner within a
step, and hardly bends."""

SMOOTH_STEPS = 2.0
"""Steps in the shortest time in which what arrives bends from which on it hardly does within one:
four nodes of a step then show the same as sixteen to 1e-4 of a jump of the input."""

DIVIDED_FURTHER = 1.25
"""Times as many steps in which a log may be taken so that all of them are short enough for few
nodes: a clock that jitters leaves few intervals so long, and a step costs more than a node."""

ROUNDING = 1e-6
"""Steps that are longer by so small a share are so by the rounding of their times."""

LONG = 50_000
"""Intervals from which on another thread divides half of them, which takes 0.1 ms."""

_CHUNK = 1 << 13
"""Intervals whose coefficients are kept at a time: those of a whole log would take as much memory
as the log again."""


@dataclass(frozen=True, eq=False)
class Division:
    """Sampling intervals divided into steps.

    Attributes
    ----------
    time_s, u
        Sample times and input, each of shape (n,).
    counts
        Steps per sampling interval, shape (n − 1,).
    rule
        ``"rk4"``, the explicit classical Runge–Kutta rule, or ``"radau"``, the implicit three-stage
        Radau IIA rule, which is stable for any stiffness.
    bends_in_s
        Shortest time in which the input that arrives bends between samples; 0 where it may have
        corners there.
    """

    time_s: Array
    u: Array
    counts: npt.NDArray[np.int16]
    rule: Rule
    bends_in_s: float = 0.0

    def same_as(self, other: Division) -> bool:
        """Whether both divide every interval alike and step by the same rule."""
        if self.rule != other.rule or not np.array_equal(self.counts, other.counts):
            return False
        bends_alike = self.bends_in_s == other.bends_in_s
        return bends_alike or self.nodes_per_step == other.nodes_per_step

    @cached_property
    def steps(self) -> int:
        """Number of steps L."""
        return int(self.counts.sum())

    @cached_property
    def nodes_per_step(self) -> int:
        """Nodes within a step at which effects on the input act."""
        longest = float(self.step_s.max(initial=0.0))
        is_smooth = SMOOTH_STEPS * longest <= self.bends_in_s * (1.0 + ROUNDING)
        return SMOOTH_NODES if is_smooth else NODES_PER_STEP

    @cached_property
    def nodes(self) -> tuple[Array, Array]:
        """Times and input at the first sample and at equidistant nodes of every step.

        Each of shape (1 + m L,) with m of them per step; kept, since an optimiser asks for them at
        every evaluation.
        """
        from softid.kernels.stage_projection import spread

        size = 1 + self.steps * self.nodes_per_step
        node_s, node_u = np.empty(size), np.empty(size)
        spread(self.time_s, self.u, self.counts, self.nodes_per_step, node_s, node_u)
        return held(node_s), held(node_u)

    @cached_property
    def step_s(self) -> Array:
        """Length of every step, shape (L,)."""
        lengths: Array = np.repeat(np.diff(self.time_s) / self.counts, self.counts)
        return lengths

    @cached_property
    def ends(self) -> npt.NDArray[np.bool_]:
        """Which steps end on a sample, shape (L,)."""
        ends = np.zeros(self.steps, bool)
        ends[np.cumsum(self.counts) - 1] = True
        return ends

    @cached_property
    def stage_s(self) -> Array:
        """Times at the stages of every Radau step, shape (L, 3)."""
        last = np.cumsum(self.counts) - 1
        within = np.arange(self.step_s.size) - np.repeat(last - self.counts + 1, self.counts)
        begins = np.repeat(self.time_s[:-1], self.counts) + within * self.step_s
        found: Array = begins[:, None] + self.step_s[:, None] * STAGES[None, :]
        return found

    @cached_property
    def stage_input(self) -> Array:
        """Input at the stages of every Radau step, shape (L, 3)."""
        return self.input_at(STAGES)

    def input_at(self, places: Array) -> Array:
        """Input at places within every step, shape (L, m).

        Parameters
        ----------
        places
            From 0 at the begin of a step to 1 at its end, shape (m,).
        """
        counts = self.counts
        last = np.cumsum(counts) - 1
        within = np.arange(last[-1] + 1 if last.size else 0) - np.repeat(last - counts + 1, counts)
        share = (within[:, None] + places) / np.repeat(counts, counts)[:, None]
        start, rise = np.repeat(self.u[:-1], counts), np.repeat(np.diff(self.u), counts)
        found: Array = start[:, None] + rise[:, None] * share
        return found


def held(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """A read-only contiguous view, which is one type for the compiler whatever came in."""
    view = np.ascontiguousarray(values).view()
    view.flags.writeable = False
    return view


def divide(law: Law, time_s: Array, u: Array, *, implicit_only: bool = False) -> Division:
    """Divide the sampling intervals so that the error stays below 1e-4 of the motion.

    The explicit rule is taken where it is cheaper, which is never the case for a stiff law, nor for
    one without inertia.

    Parameters
    ----------
    law
        The coefficients, whose rates decide.
    time_s, u
        Sample times and input, each of shape (n,).
    implicit_only
        Whether to take the implicit rule in any case.
    """
    time_s, u = held(time_s), held(u)
    radau, rk4 = np.empty(time_s.size - 1, np.int16), np.empty(time_s.size - 1, np.int16)
    bend = law.exponent_rate()

    def counted(begin: int, end: int) -> Array:
        """Steps between two intervals, by the implicit and the explicit rule, shape (2,)."""
        total = np.zeros(2)
        for first in range(begin, end, _CHUNK):
            chunk = slice(first, min(first + _CHUNK, end))
            points = slice(first, chunk.stop + 1)
            damping, stiffness, _ = law.coefficients(u[points])
            at = time_s[points], u[points]
            total += count_steps(law.mass, damping, stiffness, *at, bend, radau[chunk], rk4[chunk])
        return total

    if radau.size < LONG:
        implicit, explicit = counted(0, radau.size).tolist()
    else:
        half = radau.size // 2
        parts = on_two_threads(lambda: counted(0, half), lambda: counted(half, radau.size))
        implicit, explicit = np.add(*parts).tolist()
    if not implicit_only and law.affine() is not None and explicit <= RADAU_COST * implicit:
        return Division(time_s, u, rk4, "rk4")
    return Division(time_s, u, radau, "radau")


def divide_segment(law: Law, theta: Array, segment: Segment) -> Division:
    """`divide` for a segment, with which the last division is kept.

    Where a fit ends, its residual, errors and simulation ask for the same one in turn.

    Parameters
    ----------
    law, theta
        The coefficients, and the parameters that they are made of, shape (K,).
    segment
        Times and input.
    """
    key = type(law), theta.tobytes()
    known = segment.kept.get("division")
    if known is not None and known[0] == key:
        found: Division = known[1]
        return found
    found = divide(law, segment.time_s, segment.input)
    segment.kept["division"] = key, found
    return found


def divided(
    time_s: Array, u: Array, counts: npt.NDArray[np.intp], *, bends_in_s: float = 0.0
) -> Division:
    """Divide each sampling interval into a given number of equal steps.

    Long intervals are divided further where that lets few nodes a step do, throughout the log.

    Parameters
    ----------
    time_s, u
        Sample times and input, each of shape (n,).
    counts
        Steps per interval, shape (n − 1,).
    bends_in_s
        As in `Division`.
    """
    if 0.0 < bends_in_s < np.inf:
        wanted = np.ceil(np.diff(time_s) * (SMOOTH_STEPS / bends_in_s) - ROUNDING)
        short = np.maximum(counts, np.minimum(wanted, np.iinfo(np.int16).max))
        if short.sum() <= DIVIDED_FURTHER * counts.sum():
            counts = short
    return Division(held(time_s), held(u), counts.astype(np.int16), "radau", bends_in_s)
