"""Jumps of the input that fall between two samples: nobody knows when exactly.

Between two samples, or two readings of a slower gauge, the input is drawn straight, as if a jump
took the whole interval from one to the next. A valve switches at once, somewhere within it. What
the actuator does until it has settled is then off by up to its speed times half an interval, after
every such jump by another amount: for a slow converter and a quick actuator many times the noise,
and nothing that a law explains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.linalg import block_diag

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.motion import mean_square, simulated
from softid.diagnosis.residual.projection import basis_of
from softid.diagnosis.residual.structure import ResidualContext
from softid.intersample import is_abrupt
from softid.parallel import in_parallel
from softid.segment import Segment, with_added

Array = npt.NDArray[np.float64]
Jumps = npt.NDArray[np.intp]
Part = tuple[int, int, slice, Array]
"""Kind of pulse, jump, the samples that see it, and what it changes there."""

MOST_JUMPS = 200
"""A segment with more is one whose input is noise, or a train of pulses: they are left as drawn."""

MOST_SPENT = 0.5
"""Share of the samples that the moments use up at most in what scales the rest."""

TRIAL_SHARE = 0.25
"""Share of a jump by which the input is moved within its interval to see what its moment does."""

PULSE_KNOTS = np.array([0.0, 0.25, 0.75, 1.0])
"""Places within the interval of a jump between which its pulse goes straight; the input is moved at
the inner two."""

MOST_TO_ONE_SIDE = 3.0
"""Standard deviations that the mean of the moments is off the middles at most by chance."""

FURTHEST = 3.0**0.5
"""Either end of an interval is so many standard deviations off its middle."""

BEYOND = 0.25
"""Share of half an interval by which noise takes moments beyond the end where all of them are."""


class Pulse(NamedTuple):
    """Moves of the input at the inner two knots of an interval, per unit.

    ``moment`` is the integral or the first moment of such a pulse, ``deviation`` the standard
    deviation of that of a jump's.
    """

    first: float
    second: float
    moment: float
    deviation: float


PULSES = (Pulse(1.0, 1.0, 0.75, 12.0**-0.5), Pulse(-1.0, 1.0, 0.125, 720.0**-0.5))
"""The even and the odd pulse by which the input is moved within the interval of a jump."""

TOGETHER = 4
"""Jumps are shared out among so many simulations, neighbours to different ones."""

TIMING_ROUNDS = 4
"""Rounds in which moments beside a misfit are estimated anew."""

FADED = 0.1
"""Share of its largest that a response has at most when the next begins in the same simulation, and
is taken for a part of the next: a tenth of what noise hides all but."""

UNSEEN = 0.2
"""Share of the noise up to which responses need not be told apart."""


@dataclass(frozen=True, eq=False)
class OpenJumps:
    """A residual from which the moments of jumps were taken out.

    Attributes
    ----------
    parts
        Every segment, with what is left of its residual.
    moments
        How much earlier than the middle of its interval each jump of every segment comes, in
        standard deviations of a moment that may be anywhere, 1/√12 of the interval.
    """

    parts: tuple[ResidualContext, ...]
    moments: tuple[Array, ...]

    @property
    def count(self) -> int:
        """Number of jumps."""
        return sum(own.size for own in self.moments)

    @property
    def shares(self) -> tuple[Array, ...]:
        """Where within its interval each jump of every segment comes, from 0 to 1."""
        return tuple(np.clip(0.5 - own / 12.0**0.5, 0.0, 1.0) for own in self.moments)

    @property
    def scatter(self) -> bool:
        """Whether the moments lie on either side, and no further away than the ends.

        A cause that makes the motion late asks for moments that are all late; and one of another
        kind for such as are in no interval.
        """
        mean = float(np.mean(np.concatenate(self.moments)))
        return abs(mean) * self.count**0.5 < MOST_TO_ONE_SIDE and self._size < FURTHEST

    @property
    def lie_inside(self) -> bool:
        """Whether the moments may all lie in their intervals, be it at one end of each.

        A recorder that runs in step with the controller sees every jump as it happens, another one
        up to an interval later.
        """
        return self._size < (1.0 + BEYOND) * FURTHEST

    @property
    def _size(self) -> float:
        return float(np.sqrt(np.mean(np.concatenate(self.moments) ** 2)))


def untimed_jumps(segment: Segment) -> Array:
    """Intervals in which the input jumps.

    Parameters
    ----------
    segment
        A segment; where its input has a knot between two samples, no moment is open.

    Returns
    -------
    array
        When each interval begins and ends, shape (J, 2).
    """
    rows = segment.samples_of(np.arange(segment.input.size))
    if rows.size < 4:
        return np.empty((0, 2))
    read_s, read = segment.readings
    jumps = is_abrupt(read)
    if segment.input_read_s is None:
        jumps &= np.diff(rows) == 1
    before = np.flatnonzero(jumps)
    found = read_s[np.column_stack((before, before + 1))]
    return found if len(found) <= MOST_JUMPS else found[:0]


@dataclass(frozen=True, eq=False)
class JumpResponses:
    """What the moments of all jumps do to what a model leaves.

    A jump of height Δu at a share f of an interval T, equally likely anywhere in it, changes the
    integral of the input over it by Δu T (½ − f), with a standard deviation of Δu T/√12, and the
    first moment of the input about its middle by Δu T² (f(1 − f)/2 − 1/12), with one of
    Δu T²/√720.

    Attributes
    ----------
    parts
        What the model leaves.
    columns
        Change of the output at the used samples of all parts with the integral and the first moment
        of each jump, per standard deviation, shape (m, 2 J).
    basis
        Orthonormal columns that span what the unknowns of the model do there, shape (m, K).
    counts
        Jumps of each part.
    """

    parts: tuple[ResidualContext, ...]
    columns: Array
    basis: Array
    counts: tuple[int, ...]

    @classmethod
    def of(
        cls,
        model: Candidate,
        parts: Sequence[ResidualContext],
        variance: float,
        slopes: Sequence[Array],
    ) -> JumpResponses | None:
        """Responses of a model, at its present parameters, to all jumps.

        None where none jumps, and where the model runs away when one is moved.

        Parameters
        ----------
        model, parts, variance, slopes
            As in `with_open_jumps`.
        """
        each = [part_of_jumps(model, k, noise=variance**0.5) for k in range(len(parts))]
        if not any(whole.shape[1] for whole in each) or not all(
            np.isfinite(whole).all() for whole in each
        ):
            return None
        used = [whole[np.isfinite(p.residual)] for whole, p in zip(each, parts, strict=True)]
        counts = tuple(whole.shape[1] // len(PULSES) for whole in each)
        return cls(tuple(parts), block_diag(*used), basis_of(np.vstack(slopes)), counts)

    @property
    def by_part(self) -> list[Array]:
        """The columns of the jumps of each part at its used samples, each of shape (m, 2 J)."""
        used = [int(np.isfinite(part.residual).sum()) for part in self.parts]
        rows = np.split(self.columns, np.cumsum(used)[:-1])
        ends = np.cumsum([0, *(len(PULSES) * count for count in self.counts)]).tolist()
        return [own[:, a:b] for own, (a, b) in zip(rows, pairwise(ends), strict=True)]

    def opened(self, variance: float) -> OpenJumps:
        """The likeliest moments, and what is left behind them.

        The parameters, which were fitted with the wrong moments, move along. With G the responses
        to both moments and J the derivatives by the unknowns, the likeliest a and δ minimise
        |r − G a − J δ|²/σ² + |a|². What is left is divided by √(1 − ν/n), for so many of the n
        samples, ν = tr W (WᵀW + P)⁻¹ Wᵀ with W = (G, J)/σ and P = diag(I, 0), were used up.

        Parameters
        ----------
        variance
            Variance σ² of the noise, positive.
        """
        noise, moments = variance**0.5, self.columns.shape[1]
        both = np.hstack((self.columns / noise, self.basis))
        seen = [np.isfinite(part.residual) for part in self.parts]
        residual = [part.residual[used] for part, used in zip(self.parts, seen, strict=True)]
        scaled = np.concatenate(residual) / noise
        gram = both.T @ both
        expected = np.diag(np.arange(gram.shape[0]) < moments).astype(float)
        inverse = np.linalg.inv(gram + expected)
        spent = min(float(np.trace(inverse @ gram)) / scaled.size, MOST_SPENT)
        likeliest = inverse @ (both.T @ scaled)
        rest = noise * (scaled - both @ likeliest) / np.sqrt(1.0 - spent)
        left = []
        of_each = np.split(rest, np.cumsum([used.sum() for used in seen])[:-1])
        for part, used, own in zip(self.parts, seen, of_each, strict=True):
            values = np.full(part.residual.size, np.nan)
            values[used] = own
            left.append(replace(part, residual=values))
        each = np.split(likeliest[:moments], len(PULSES) * np.cumsum(self.counts)[:-1])
        integrals = tuple(own[:count] for own, count in zip(each, self.counts, strict=True))
        return OpenJumps(tuple(left), integrals)

    def with_misfit(self) -> OpenJumps:
        """As `opened`, with the variance of what is left beside the moments, found by iteration.

        A misfit hides the moments, as noise of its size would.
        """
        least = float(np.finfo(float).tiny)
        found = self.opened(max(mean_square(self.parts), least))
        for _ in range(TIMING_ROUNDS):
            found = self.opened(max(mean_square(found.parts), least))
        return found


def with_open_jumps(
    model: Candidate,
    parts: Sequence[ResidualContext],
    variance: float,
    slopes: Sequence[Array],
) -> OpenJumps | None:
    """Estimate the moments of all jumps from what a model leaves, and take out what they do.

    Parameters
    ----------
    model
        The model where it stands.
    parts
        What it leaves.
    variance
        Variance of the noise, positive.
    slopes
        Derivatives of the first output by the unknowns at the used samples of each segment.

    Returns
    -------
    OpenJumps or None
        None where no input jumps.
    """
    responses = JumpResponses.of(model, parts, variance, slopes)
    return None if responses is None else responses.opened(variance)


def part_of_jumps(model: Candidate, k: int, *, noise: float) -> Array:
    """What the moments of the jumps of one segment do to the first output.

    Jumps share a simulation with others so far away that what one does has faded when the next
    begins; where it has not and can be seen, those are shared out again.

    Parameters
    ----------
    model
        The model where it stands.
    k
        Index of the segment.
    noise
        Standard deviation of what hides responses, in the output's unit.

    Returns
    -------
    array
        Change of the output at every sample with the integral and the first moment of each, per
        standard deviation, shape (n, 2 J).
    """
    segment = model.problem.segments[k]
    spans_s = untimed_jumps(segment)
    sampled_s = segment.samples_of(segment.time_s)
    after = np.searchsorted(sampled_s, spans_s[:, 0], side="right")

    def told_apart(kind: int, group: Jumps) -> list[Part]:
        apart = _response(model, k, spans_s[group], PULSES[kind])
        windows = [slice(*w) for w in pairwise((*after[group].tolist(), sampled_s.size))]
        hidden = float(np.abs(apart).max()) <= UNSEEN * noise
        if hidden or all(_has_faded(apart[window]) for window in windows[:-1]):
            parts = zip(group.tolist(), windows, strict=True)
            return [(kind, jump, window, apart[window]) for jump, window in parts]
        return [part for fewer in _shared_out(group) for part in told_apart(kind, fewer)]

    columns = np.zeros((sampled_s.size, len(PULSES), len(spans_s)))
    tasks = product(range(len(PULSES)), _shared_out(np.arange(len(spans_s))))
    for parts in in_parallel(lambda task: told_apart(*task), tasks):
        for kind, jump, window, apart in parts:
            columns[window, kind, jump] = apart
    found: Array = columns.reshape(sampled_s.size, -1)
    return found


def _shared_out(jumps: Jumps) -> list[Jumps]:
    """Every so many of them together, without empty groups."""
    return [jumps[first::TOGETHER] for first in range(min(TOGETHER, jumps.size))]


def _has_faded(response: Array) -> bool:
    """Whether a response is nearly nothing over the last quarter of what is seen of it."""
    late = np.abs(response[-(-response.size // 4) :])
    return float(late.max()) <= FADED * float(np.abs(response).max())


def _response(model: Candidate, k: int, spans_s: Array, pulse: Pulse) -> Array:
    """Change of the first output with a pulse in every interval, per standard deviation."""
    segment = model.problem.segments[k]
    heights = TRIAL_SHARE * np.diff(np.interp(spans_s, segment.time_s, segment.input)).ravel()
    there, back = (
        simulated(model, k, _with_pulses(segment, spans_s, side * heights, pulse))
        for side in (1.0, -1.0)
    )
    apart: Array = (there - back) / (2.0 * TRIAL_SHARE * pulse.moment) * pulse.deviation
    return apart


def _with_pulses(segment: Segment, spans_s: Array, heights: Array, pulse: Pulse) -> Segment:
    """A segment with an input that is moved at the inner knots of every interval."""
    knot_s = spans_s[:, :1] + np.diff(spans_s) * PULSE_KNOTS
    return with_added(
        segment, knot_s, heights[:, np.newaxis] * (0.0, pulse.first, pulse.second, 0.0)
    )
