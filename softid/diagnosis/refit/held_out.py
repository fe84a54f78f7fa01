"""What is held out: other logs, or blocks of the fitted ones; and the error on it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.fitters.output_error import refit_nuisance
from softid.fitters.problem import Problem
from softid.identification.gauge_errors import GaugeErrors
from softid.log import Log, LogSet
from softid.models.base import Response
from softid.segment import Segment

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

HELD_OUT_BLOCKS = 5
"""Blocks of a log that are held out when no other log is."""

BLOCK_SHARE = 0.04
"""Length of a block: five of 4 % are a fifth of the log, and four fifths identify nearly as
well."""

FEWEST_SAMPLES = 2 * HELD_OUT_BLOCKS
"""Nothing is held out of a log with fewer: blocks of one sample would be more than half of it."""

FIRST_SHARE = 0.1
"""Nothing is held out of the first tenth, from which initial states are found."""

GOLDEN_FRACTION = 0.618
"""Each fifth of the log has its block elsewhere, so that the blocks do not fall on the same part of
every cycle."""

NO_WORSE = 1.02
"""A held-out error counts as no worse than another up to a fiftieth above it."""

BETTER = 0.998
"""A held-out error counts as better than another from two thousandths below it."""


class HeldOutErrors(NamedTuple):
    """What a model leaves of one output channel of one log or segment.

    Attributes
    ----------
    log, channel
        Where.
    measured, residual
        Measured values and residual at the held-out samples, each of shape (m,).
    """

    log: str
    channel: str
    measured: Array
    residual: Array


class HeldOut(ABC):
    """The samples that judge and are not fitted.

    Attributes
    ----------
    gauges
        Log → errors of the input that was recorded; nothing where parts of the fitted logs are held
        out.
    """

    gauges: Mapping[str, GaugeErrors] = MappingProxyType({})

    @abstractmethod
    def errors(self, candidate: Candidate) -> list[HeldOutErrors]:
        """Measured values and residual at all held-out samples.

        Parameters
        ----------
        candidate
            A fit to the rest.
        """

    def judging(self, candidate: Candidate) -> list[HeldOutErrors]:
        """Measured values and residual at the held-out samples that count; by default all do.

        Parameters
        ----------
        candidate
            A fit to the rest.
        """
        return self.errors(candidate)

    def first_errors(self, candidate: Candidate) -> Array:
        """Residuals of the first output at all held-out samples, shape (m,)."""
        return _joined(self.errors(candidate), candidate)

    def rms(self, candidate: Candidate) -> float:
        """Root mean square of the first output's residual over the held-out samples that count.

        NaN where none does; infinite where the candidate runs away there.
        """
        return float(np.sqrt(mean_power([_joined(self.judging(candidate), candidate)])))

    def runs(self, candidate: Candidate) -> list[Array]:
        """Residuals of the first output at the samples that count, by log and segment."""
        first = candidate.problem.outputs[0]
        return [row.residual for row in self.judging(candidate) if row.channel == first]

    @abstractmethod
    def standing(self, candidate: Candidate) -> Candidate | None:
        """The candidate over what is held out, with zeros and initial states of its own.

        None where that is a part of the fitted logs.

        Parameters
        ----------
        candidate
            A fit to the rest.
        """

    @abstractmethod
    def slopes(self, candidate: Candidate) -> Array:
        """Derivatives of the samples that count by the free parameters, shape (m, F).

        Of the first output, F in the order and on the scales of ``problem.free``, as
        far as sensor zeros and initial states of what is held out do not make up for them.

        Parameters
        ----------
        candidate
            A fit to the rest.
        """


@dataclass(frozen=True, eq=False)
class HeldOutLogs(HeldOut):
    """Other logs than the fitted ones; each has a sensor zero and an initial state of its own.

    Attributes
    ----------
    logs
        The logs.
    gauges
        See `HeldOut`.
    is_intersample_open
        Whether nobody said what the input does between its samples.
    """

    logs: tuple[Log, ...]
    gauges: Mapping[str, GaugeErrors] = field(default_factory=dict)
    is_intersample_open: bool = False

    def errors(self, candidate: Candidate) -> list[HeldOutErrors]:
        """At all samples of the logs; see `HeldOut.errors`."""
        return self._within((-np.inf, np.inf), candidate)

    def judging(self, candidate: Candidate) -> list[HeldOutErrors]:
        """At the samples whose input lies within the range that was fitted, if there are any."""
        return self._within(fitted_range(candidate), candidate) or self.errors(candidate)

    def standing(self, candidate: Candidate) -> Candidate:
        """Over the logs; see `HeldOut.standing`."""
        fitted, (_, nuisance) = candidate.problem, self._at_its_zeros(candidate)
        parameters = fitted.parameters.with_values(candidate.parameters)
        z = np.concatenate((candidate.minimum.point[: len(fitted.free)], nuisance))
        problem = Problem(fitted.model, parameters, self.logs)
        return replace(candidate, problem=problem, minimum=replace(candidate.minimum, point=z))

    def slopes(self, candidate: Candidate) -> Array:
        """At the samples that judge; see `HeldOut.slopes`."""
        judged, limits = self.standing(candidate), fitted_range(candidate)
        problem, free = judged.problem, len(candidate.problem.free)
        first, rows, judges = problem.outputs[0], [], []
        for block in problem.blocks(judged.minimum.point, derivatives=True):
            if block.channel == first and block.jacobian is not None:
                segment = problem.segments[block.segment]
                rows.append(block.jacobian)
                judges.append(_is_within(limits, segment.input[segment.used[first]]))
        whole, judging = np.concatenate(rows), np.concatenate(judges)
        by_nuisance, by_parameter = whole[:, free:], whole[:, :free]
        if not np.isfinite(whole).all():  # it runs away there
            return by_parameter
        made_up = np.linalg.lstsq(by_nuisance, by_parameter, rcond=None)[0]
        left: Array = by_parameter - by_nuisance @ made_up
        return left[judging] if judging.any() else left

    def _at_its_zeros(self, candidate: Candidate) -> tuple[Problem, Array]:
        """The logs under the candidate's parameters, with zeros and initial states of their own.

        Found once, however often a candidate is judged.
        """
        known = _at_zeros.setdefault(self, WeakKeyDictionary())
        if candidate not in known:
            model = candidate.problem.model
            fixed = model.parameters().with_fixed(candidate.parameters)
            problem = Problem(model, fixed, self.logs)
            known[candidate] = problem, refit_nuisance(problem).unknowns
        return known[candidate]

    def _within(self, limits: tuple[float, float], candidate: Candidate) -> list[HeldOutErrors]:
        """At the samples whose input lies within limits; no row where there are none."""
        problem, nuisance = self._at_its_zeros(candidate)
        found = []
        for block in problem.blocks(nuisance, derivatives=False):
            segment = problem.segments[block.segment]
            used = segment.used[block.channel]
            measured, u = segment.outputs[block.channel][used], segment.input[used]
            judges = _is_within(limits, u)
            if judges.any():
                row = (measured[judges], block.residual[judges])
                found.append(HeldOutErrors(segment.log_name, block.channel, *row))
        return found


_at_zeros: WeakKeyDictionary[HeldOutLogs, WeakKeyDictionary[Candidate, tuple[Problem, Array]]] = (
    WeakKeyDictionary()
)
"""Results of `HeldOutLogs` for each candidate that is still referenced elsewhere."""


@dataclass(frozen=True, eq=False)
class HeldOutBlocks(HeldOut):
    """Blocks of the fitted logs.

    Attributes
    ----------
    whole
        The fitted logs with their blocks.
    blocks
        Which samples of each of them are held out.
    """

    whole: tuple[Log, ...]
    blocks: tuple[BoolArray, ...]

    def put_back(self, logs: Sequence[Log]) -> tuple[Log, ...]:
        """The fitted logs with what is held out of them.

        Parameters
        ----------
        logs
            The logs as they are fitted, in the order of ``whole``.
        """
        found = []
        for log, whole, held in zip(logs, self.whole, self.blocks, strict=True):
            found.append(replace(log, masked=np.where(held, whole.masked, log.masked)))
        return tuple(found)

    def errors(self, candidate: Candidate) -> list[HeldOutErrors]:
        """From the initial states of the fit: without the mask another start may count as rest.

        The input does between its samples what it does in the fit, which found that out.
        """
        fitted, z = candidate.problem, candidate.minimum.point
        found = []
        for log, segment, held, response in self._responses(candidate, derivatives=False):
            for name in fitted.outputs:
                judges = segment.samples_of(segment.used[name]) & held
                measured = segment.samples_of(segment.outputs[name])[judges]
                zero = z[fitted.zero_position(log, name)] if fitted.zeros else 0.0
                residual = measured - segment.samples_of(response.outputs[name])[judges] - zero
                found.append(HeldOutErrors(segment.log_name, name, measured, residual))
        return found

    def slopes(self, candidate: Candidate) -> Array:
        """With the zeros and initial states of the fit; see `HeldOut.slopes`."""
        fitted = candidate.problem
        first, chain = fitted.outputs[0], fitted.chain(candidate.minimum.point)
        rows = []
        for _, segment, held, response in self._responses(candidate, derivatives=True):
            if response.by_parameter is not None:
                judges = segment.samples_of(segment.used[first]) & held
                rows.append(segment.samples_of(response.by_parameter[first])[judges] @ chain)
        return np.concatenate(rows) if rows else np.zeros((0, len(fitted.free)))

    def _responses(
        self, candidate: Candidate, *, derivatives: bool
    ) -> Iterator[tuple[int, Segment, BoolArray, Response]]:
        """Log, segment, held-out samples of it and the response to the whole of it."""
        fitted, z = candidate.problem, candidate.minimum.point
        theta = fitted.theta(z)
        taken = [
            whole.with_intersample(log.intersample)
            for whole, log in zip(self.whole, fitted.logs, strict=True)
        ]
        segments = [(k, segment) for k, log in enumerate(taken) for segment in log.segments()]
        for at, (log, segment) in enumerate(segments):
            with np.errstate(all="ignore"):
                response = fitted.model.response(
                    theta,
                    segment,
                    fitted.outputs,
                    start=fitted.start(z, at),
                    derivatives=derivatives,
                    relative=fitted.has_equilibrium,
                )
            yield log, segment, self.blocks[log][segment.start : segment.stop], response

    def standing(self, candidate: Candidate) -> None:
        """None: the blocks are a part of the logs."""


def _is_within(limits: tuple[float, float], u: Array) -> BoolArray:
    inside: BoolArray = (u >= limits[0]) & (u <= limits[1])
    return inside


def mean_power(runs: Sequence[Array]) -> float:
    """Mean square of runs of a residual; NaN for nothing, infinite where they are not finite.

    Parameters
    ----------
    runs
        The runs.
    """
    joined = np.concatenate(runs) if runs else np.empty(0)
    if not joined.size:
        return float("nan")
    with np.errstate(over="ignore", invalid="ignore"):
        power = float(np.mean(joined**2))
    return power if np.isfinite(power) else np.inf


def _joined(errors: Sequence[HeldOutErrors], candidate: Candidate) -> Array:
    """Residuals of the first output."""
    first = candidate.problem.outputs[0]
    rows = [row.residual for row in errors if row.channel == first]
    return np.concatenate(rows) if rows else np.empty(0)


def fitted_range(candidate: Candidate) -> tuple[float, float]:
    """Least and greatest input of the fitted logs; beyond it no law of the curve is known.

    Parameters
    ----------
    candidate
        A fit.
    """
    u = np.concatenate([segment.input for segment in candidate.problem.segments])
    return float(u.min()), float(u.max())


def hold_out_blocks(logs: LogSet) -> tuple[LogSet, HeldOutBlocks]:
    """Mask contiguous blocks of every log, within the range of inputs that the rest covers.

    Parameters
    ----------
    logs
        The logs.

    Returns
    -------
    LogSet, HeldOutBlocks
        The logs without the blocks, and what is held out.
    """
    trained, blocks = [], []
    for log in logs:
        held = _blocks(log)
        trained.append(log.with_masked(held))
        blocks.append(held)
    return LogSet(tuple(trained)), HeldOutBlocks(logs.logs, tuple(blocks))


def _blocks(log: Log) -> BoolArray:
    n = len(log)
    held = np.zeros(n, bool)
    if n < FEWEST_SAMPLES:
        return held
    u = log.channels[log.input].values
    length = max(int(BLOCK_SHARE * n), 1)
    stratum = (1.0 - FIRST_SHARE) / HELD_OUT_BLOCKS
    for k in range(HELD_OUT_BLOCKS):
        place = (0.5 + k * GOLDEN_FRACTION) % 1.0
        first = int((FIRST_SHARE + k * stratum + place * (stratum - BLOCK_SHARE)) * n)
        held[first : first + length] = True
    for segment in log.segments()[1:]:  # the state in which it begins is found from its beginning
        held[segment.start : segment.start + max(length, int(FIRST_SHARE * n) // 2)] = False
    low, high = u[~held].min(), u[~held].max()
    held &= (u >= low) & (u <= high)
    return held
