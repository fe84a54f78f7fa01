"""Jumps of the input that fall between two samples: nobody knows when exactly.

Between two samples the input is drawn straight, as if a jump took the whole interval from one to
the next. A valve switches at once, somewhere within it. What the actuator does until it has settled
is then off by up to its speed times half an interval, after every such jump by another amount: for
a slow converter and a quick actuator many times the noise, and nothing that a law explains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.structure import ResidualContext
from softid.segment import Segment

Array = npt.NDArray[np.float64]
Places = npt.NDArray[np.intp]

LEAST_JUMP = 0.05
"""Share of the input's span that a jump has at least."""

WITHIN = 0.6
"""Share of the change over three intervals that is in the middle one: a change that takes several
samples is drawn as it was."""

MOST_JUMPS = 200
"""A segment with more is one whose input is noise, or a train of pulses: they are left as drawn."""

MOST_SPENT = 0.5
"""Share of the samples that the moments use up at most in what scales the rest."""

TRIED = 0.25
"""Share of a jump by which the input is moved within its interval to see what its moment does."""

KNOTS = np.array([0.25, 0.75])
"""Places within the interval at which it is moved, and goes straight between."""

PULSES = ((1.0, 1.0, 0.75, 12.0**-0.5), (-1.0, 1.0, 0.125, 720.0**-0.5))
"""Moves at the two places, the integral or first moment of such a pulse, and the standard deviation
of that of a jump's: an even pulse, and an odd one."""


@dataclass(frozen=True, eq=False)
class OpenJumps:
    """A residual from which the moments of jumps were taken out.

    Attributes
    ----------
    parts
        Every segment, with what is left of its residual.
    count
        Number of jumps.
    """

    parts: tuple[ResidualContext, ...]
    count: int


def untimed_jumps(segment: Segment) -> Places:
    """Last samples before intervals in which the input jumps.

    `softid.intersample.jumps` asks for an input that is flat before and after, as a held one is;
    here the rest of a jump may be seen in the samples beside it.

    Parameters
    ----------
    segment
        A segment whose input is straight between the samples; of another one no moment is open.
    """
    nowhere: Places = np.zeros(0, np.intp)
    if segment.is_sample is not None or segment.input.size < 4:
        return nowhere
    change = np.abs(np.diff(segment.input))
    beside = np.convolve(change, np.ones(3), "same")
    found: Places = np.flatnonzero(
        (change > LEAST_JUMP * np.ptp(segment.input)) & (change > WITHIN * beside)
    )
    return found if found.size <= MOST_JUMPS else nowhere


def with_open_jumps(
    model: Candidate, parts: Sequence[ResidualContext], variance: float
) -> OpenJumps | None:
    """Estimate the moments of all jumps from what a model leaves, and take out what they do.

    A jump of height Δu at a share f of an interval T, equally likely anywhere in it, changes the
    integral of the input over it by Δu T (½ − f), with a standard deviation of Δu T/√12, and the
    first moment of the input about its middle by Δu T² (f(1 − f)/2 − 1/12), with one of
    Δu T²/√720. With G the responses to both, per standard deviation, the likeliest a minimise
    |r − G a|²/σ² + |a|². What is left is divided by √(1 − ν/n), for so many of the n samples,
    ν = tr G (GᵀG + σ²)⁻¹ Gᵀ, were used up.

    Parameters
    ----------
    model
        The model where it stands.
    parts
        What it leaves.
    variance
        Variance σ² of the noise, positive.

    Returns
    -------
    OpenJumps or None
        None where no input jumps.
    """
    left, count = [], 0
    for k, part in enumerate(parts):
        seen, whole = np.isfinite(part.residual), part_of_jumps(model, k)
        if whole.shape[1] == 0 or not seen.any():
            left.append(part)
            continue
        count += whole.shape[1] // len(PULSES)
        used = whole[seen]
        gram = used.T @ used / variance
        inverse = np.linalg.inv(gram + np.eye(whole.shape[1]))
        residual = part.residual - whole @ (inverse @ (used.T @ part.residual[seen]) / variance)
        spent = min(float(np.trace(inverse @ gram)) / used.shape[0], MOST_SPENT)
        left.append(replace(part, residual=residual / np.sqrt(1.0 - spent)))
    return OpenJumps(tuple(left), count) if count else None


def part_of_jumps(model: Candidate, k: int) -> Array:
    """What the moments of the jumps of one segment do to the first output.

    Parameters
    ----------
    model
        The model where it stands.
    k
        Index of the segment.

    Returns
    -------
    array
        Change of the output at every sample with the integral and the first moment of each, per
        standard deviation, shape (n, 2 J).
    """
    problem, z = model.problem, model.minimum.point
    segment, first = problem.segments[k], problem.outputs[0]
    places = untimed_jumps(segment)
    columns = np.zeros((segment.time_s.size, 2, places.size))
    for number, place in enumerate(places.tolist()):
        for kind, (first_knot, second_knot, moment, deviation) in enumerate(PULSES):
            height = TRIED * (segment.input[place + 1] - segment.input[place])
            there, back = (
                problem.model.response(
                    problem.theta(z),
                    _with_pulse(segment, place, side * first_knot, side * second_knot),
                    problem.outputs,
                    start=problem.start(z, k),
                    derivatives=False,
                    relative=problem.has_equilibrium,
                ).outputs[first]
                for side in (height, -height)
            )
            apart = np.delete(there - back, (place + 1, place + 2))
            columns[:, kind, number] = apart / (2.0 * TRIED * moment) * deviation
    found: Array = columns.reshape(segment.time_s.size, -1)
    return found


def _with_pulse(segment: Segment, place: int, first: float, second: float) -> Segment:
    """A segment with an input that is so much higher at two knots within one interval."""
    at = (place + 1, place + 1)
    begin, end = slice(place, place + 1), slice(place + 1, place + 2)

    def between(values: Array) -> Array:
        return (1.0 - KNOTS) * values[begin] + KNOTS * values[end]

    return replace(
        segment,
        time_s=np.insert(segment.time_s, at, between(segment.time_s)),
        input=np.insert(segment.input, at, between(segment.input) + np.array((first, second))),
        outputs={name: np.insert(y, at, np.nan) for name, y in segment.outputs.items()},
        used={name: np.insert(used, at, False) for name, used in segment.used.items()},
        is_sample=np.insert(np.ones(segment.time_s.size, np.bool_), at, False),
    )
