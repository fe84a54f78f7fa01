"""The output-error problem: one vector of unknowns, one residual, one exact Jacobian.

Unknowns, in order: the free parameters (logarithms where the scale says so), one sensor zero per
log and output, and the initial state of every segment that does not start at rest, as its deviation
from the equilibrium where the model has one. Written like that, a static curve that saturates
outside the data leaves a straight valley in these unknowns instead of a bent one. Where dry
friction holds the actuator off its equilibrium, the position of a segment that starts at rest is
one of them, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Self

import numpy as np
import numpy.typing as npt

from softid.fitters.blocks import Block, undefined_blocks
from softid.fitters.reach import FREE_REACH, parameter_reach, sizes_of_states, usual_motion
from softid.fitters.rest import spans_of, starts_at_rest
from softid.fitters.ties import tied_slopes, ties_of
from softid.log import Log
from softid.models.base import Model, Response
from softid.models.division import Division
from softid.parameters import ParameterSet
from softid.segment import Segment

Array = npt.NDArray[np.float64]

AT_BOUND = 1e-6
"""Share of the width of its bounds within which an unknown lies on one."""

_LOG_FLOOR = 1e-300
"""Stands for zero where a logarithm is taken: close to the smallest number there is."""


class Problem:
    """Output error of one model over all segments of several logs.

    Parameters
    ----------
    model
        The model with its options.
    parameters
        Bounds, scales, fixed values and ties.
    logs
        Logs to be explained.
    zeros
        Whether every log has a sensor zero of its own.
    """

    def __init__(
        self, model: Model, parameters: ParameterSet, logs: Sequence[Log], *, zeros: bool = True
    ) -> None:
        self.model = model
        self.parameters = parameters
        self.logs = tuple(logs)
        self.outputs = self.logs[0].outputs
        owned = [(k, s) for k, log in enumerate(self.logs) for s in log.segments()]
        self.segments: list[Segment] = [s for _, s in owned]
        self.owner = [k for k, _ in owned]
        self.free = parameters.free
        self._free_index = [parameters.names.index(name) for name in self.free]
        self._log_scaled = np.array([parameters[name].scale == "log" for name in self.free], bool)
        self.ties = ties_of(parameters)
        self._values = parameters.values_vector()
        at_start = self._values if self.ties is None else self.ties.nearest(self._values)
        self.has_equilibrium = all(
            np.isfinite(model.static_output(at_start, s.input[:1], self.outputs[0])[0])
            for s in self.segments
        )
        self.zeros = zeros and self.has_equilibrium and not model.own_zero
        spans = [spans_of(log) for log in self.logs]
        may_rest = self.has_equilibrium and not model.keeps_place
        rests = [
            not model.start_states or (may_rest and s.index == 0 and starts_at_rest(s, spans[k]))
            for s, k in zip(self.segments, self.owner, strict=True)
        ]
        may_stick = model.sticks and bool(model.start_states)
        self.stuck = [rest and may_stick for rest in rests]
        self.at_rest = [rest and not may_stick for rest in rests]
        self._layout()

    @classmethod
    def with_segments(
        cls,
        whole: Problem,
        segments: Sequence[Segment],
        parts: Sequence[tuple[int, bool]] | None = None,
    ) -> Self:
        """All of the ``whole`` problem but its segments, and the initial states of other ones.

        Parameters
        ----------
        whole, segments
            The problem, and the segments in the place of its own.
        parts
            For each the one of its own that it is a part of, and whether it begins with that, for
            another one begins in motion; None where each stands for its own. A log without a part
            has no zero, which nothing would tell.
        """
        found = cls.__new__(cls)
        vars(found).update(vars(whole))
        found.segments = list(segments)
        if parts is not None:
            owners = [whole.owner[k] for k, _ in parts]
            kept = sorted(set(owners))
            found.logs = tuple(whole.logs[k] for k in kept)
            found.owner = [kept.index(k) for k in owners]
            found.at_rest = [begins and whole.at_rest[k] for k, begins in parts]
            found.stuck = [begins and whole.stuck[k] for k, begins in parts]
        found._layout()
        return found

    def plans(self, z: Array) -> list[Division | None]:
        """Division of every segment's sampling intervals that the parameters at ``z`` call for."""
        theta = self.theta(z)
        is_known = np.isfinite(theta).all()
        with np.errstate(all="ignore"):
            return [self.model.plan(theta, s) if is_known else None for s in self.segments]

    def _layout(self) -> None:
        vars(self).pop("_reach", None)  # that of other segments
        n = len(self.free)
        n_zero = len(self.logs) * len(self.outputs) if self.zeros else 0
        self._zero_from = n
        position = n + n_zero
        self._states: list[range] = []
        for rest, stuck in zip(self.at_rest, self.stuck, strict=True):
            count = 0 if rest else 1 if stuck else len(self.model.start_states)
            self._states.append(range(position, position + count))
            position += count
        self.size = position
        counts = (int(s.used[name].sum()) for s in self.segments for name in self.outputs)
        self.n_samples = sum(counts)  # of all channels

    @property
    def plain_segments(self) -> list[Segment]:
        """The segments with their samples alone, for starts that take the input as straight."""
        return [segment.without_knots() for segment in self.segments]

    def bounds(self) -> tuple[Array, Array]:
        """Bounds of the unknowns, each of shape (U,)."""
        lower, upper = np.full(self.size, -np.inf), np.full(self.size, np.inf)
        for k, name in enumerate(self.free):
            p = self.parameters[name]
            lower[k], upper[k] = p.lower, p.upper
            if p.scale == "log":
                lower[k] = np.log(max(p.lower, _LOG_FLOOR))
                upper[k] = np.log(p.upper)
        return lower, upper

    def at_bound(self, z: Array) -> npt.NDArray[np.bool_]:
        """Which unknowns lie on a bound, to a millionth of what their bounds allow, shape (U,)."""
        lower, upper = self.bounds()
        width = upper - lower
        near = np.where(np.isfinite(width), AT_BOUND * width, 0.0)
        found: npt.NDArray[np.bool_] = (z - lower <= near) | (upper - z <= near)
        return found

    def reach(self) -> Array:
        """How far each unknown may plausibly move from where it is, shape (U,).

        A factor of e² where the scale is logarithmic, a few times the value where it is linear, but
        no more than a part of what its bounds allow; anything for zeros and states, which the data
        always pin down.
        """
        return self._reach.copy()

    @cached_property
    def _reach(self) -> Array:
        far = parameter_reach([self.parameters[n] for n in self.free], self.logs[0], self.segments)
        return np.concatenate((far, FREE_REACH * self._nuisance_sizes()))

    def _nuisance_sizes(self) -> Array:
        """Span of the output of every zero; span or largest speed of the first for every state."""
        sizes = np.ones(self.size)
        sizes_by_output = {name: usual_motion(self.segments, name) for name in self.outputs}
        span, speed = sizes_by_output[self.outputs[0]]
        for places in self._states:
            sizes[places] = sizes_of_states(span, speed, len(places))
        for log in range(len(self.logs)) if self.zeros else ():
            for name in self.outputs:
                sizes[self.zero_position(log, name)] = sizes_by_output[name][0]
        return sizes[len(self.free) :]

    def unknowns(self, values: Mapping[str, float], *, with_zeros: bool = True) -> Array:
        """Vector of unknowns at given parameter values; zeros and states from the data.

        An optimiser finds the zeros at once: ``with_zeros`` False spares it a simulation.
        """
        z = self.free_unknowns(values)
        self._data_nuisance(z, with_zeros=with_zeros)
        return z

    def free_unknowns(self, values: Mapping[str, float]) -> Array:
        """Vector of unknowns at given parameter values; zeros and states are 0."""
        z = np.zeros(self.size)
        for k, name in enumerate(self.free):
            z[k] = values[name]
        scaled = np.flatnonzero(self._log_scaled)
        z[scaled] = np.log(np.maximum(z[scaled], _LOG_FLOOR))
        return z

    def _data_nuisance(self, z: Array, *, with_zeros: bool) -> None:
        """Start at equilibrium, or at the first sample where the model has none; zeros to match."""
        if not self.has_equilibrium:
            name = self.outputs[0]
            for k, segment in enumerate(self.segments):
                states, first = self._states[k], np.flatnonzero(segment.used[name])
                if states and first.size:
                    z[states[0]] = segment.outputs[name][first[0]]
        if self.zeros and with_zeros:
            blocks = list(self.blocks(z, derivatives=False))
            z[:] = self.with_best_zeros(z, blocks)[0]

    def with_best_zeros(self, z: Array, blocks: Sequence[Block]) -> tuple[Array, list[Block]]:
        """Move every sensor zero to its optimum, which is the mean residual of its log.

        Parameters
        ----------
        z
            Unknowns, shape (U,).
        blocks
            Residuals at ``z``.

        Returns
        -------
        z, blocks
            Moved unknowns and residuals; the Jacobian does not depend on the zeros.
        """
        if not self.zeros:
            return z, list(blocks)
        moved = z.copy()
        parts: dict[int, list[Array]] = {}
        places = [self.zero_position(self.owner[b.segment], b.channel) for b in blocks]
        for at, block in zip(places, blocks, strict=True):
            parts.setdefault(at, []).append(block.residual)
        shift = {
            at: float(np.mean(np.concatenate(rs))) for at, rs in parts.items() if sum(map(len, rs))
        }
        for at, level in shift.items():
            moved[at] += level if np.isfinite(level) else 0.0
        levels = (shift.get(at, 0.0) for at in places)
        left = [b.residual - level for b, level in zip(blocks, levels, strict=True)]
        return moved, [replace(b, residual=r) for b, r in zip(blocks, left, strict=True)]

    def with_nuisance_of(self, z: Array, other: Problem, unknowns: Array) -> Array:
        """``z`` with zeros and initial states of another problem over the same logs.

        Parameters
        ----------
        z
            Unknowns, shape (U,); an initial state that the other one has not stays as it is.
        other, unknowns
            Problem with another model, and its unknowns.
        """
        moved = z.copy()
        if self.zeros:
            count = len(self.logs) * len(self.outputs)
            moved[self._zero_from :][:count] = unknowns[other._zero_from :][:count]
        for k in range(len(self.segments)):
            theirs = dict(zip(other.model.start_states, other._states[k], strict=False))
            for name, at in zip(self.model.start_states, self._states[k], strict=False):
                if name in theirs:
                    moved[at] = unknowns[theirs[name]]
        return moved

    def zero_position(self, log: int, channel: str) -> int:
        """Where the sensor zero of one log and channel stands among the unknowns."""
        return self._zero_from + log * len(self.outputs) + self.outputs.index(channel)

    def start(self, z: Array, segment: int) -> Array | None:
        """Initial state of one segment for `Model.response`, shape (S,); None at rest."""
        states = self._states[segment]
        if not states:
            return None
        state, names = np.zeros(len(self.model.states)), self.model.states
        for name, at in zip(self.model.start_states, states, strict=False):
            state[names.index(name)] = z[at]
        return state

    def state_positions(self, segment: int) -> range:
        """Where the initial state of one segment stands among the unknowns; empty at rest."""
        return self._states[segment]

    def start_state(self, z: Array, segment: int) -> tuple[float, ...]:
        """Initial state used for one segment."""
        begin = self.segments[segment].part(slice(2))
        return tuple(float(v) for v in self.response(z, segment, begin).start)

    def response(
        self,
        z: Array,
        segment: int,
        course: Segment | None = None,
        plan: Division | None = None,
    ) -> Response:
        """Motion and first output over one segment, or over another course from its start."""
        return self.model.response(
            self.theta(z),
            self.segments[segment] if course is None else course,
            self.outputs[:1],
            start=self.start(z, segment),
            derivatives=False,
            relative=self.has_equilibrium,
            plan=plan,
        )

    def theta(self, z: Array) -> Array:
        """All parameter values at the unknowns, shape (K,); NaN where a tie is broken."""
        values = self._values.copy()
        free = z[: len(self.free)].copy()
        np.exp(free, out=free, where=self._log_scaled)
        values[self._free_index] = free
        return values if self.ties is None else self.ties(values)

    def values(self, z: Array) -> dict[str, float]:
        """Parameter → value at the unknowns."""
        return dict(zip(self.parameters.names, self.theta(z).tolist(), strict=True))

    def free_by_name(self, z: Array) -> dict[str, float]:
        """Free parameter → unknown, which is a logarithm where the scale is one."""
        return dict(zip(self.free, z[: len(self.free)].tolist(), strict=True))

    def chain(self, z: Array, theta: Array | None = None) -> Array:
        """∂θ/∂(free unknowns), shape (K, F); ``theta`` is θ at ``z`` where it is known already."""
        theta = self.theta(z) if theta is None else theta
        chain = np.zeros((theta.size, len(self.free)))
        slope = np.where(self._log_scaled, theta[self._free_index], 1.0)
        chain[self._free_index, np.arange(len(self.free))] = slope
        if self.ties is not None:
            sizes = np.abs(theta[self._free_index])
            far = np.where(self._log_scaled, 0.0, self.reach()[: len(self.free)])
            chain = tied_slopes(self.ties, theta, self._free_index, np.maximum(sizes, far)) * slope
        return chain

    def blocks(
        self,
        z: Array,
        *,
        derivatives: bool,
        plans: Sequence[Division | None] | None = None,
        only: int | None = None,
    ) -> Iterator[Block]:
        """Residuals, and Jacobians if asked, per segment and channel.

        Parameters
        ----------
        z
            Unknowns, shape (U,).
        derivatives
            Whether to compute Jacobians.
        plans
            From `plans`, to hold the discretisation still; None plans anew.
        only
            Index of the only segment wanted; None for all.
        """
        theta = self.theta(z)
        if not np.isfinite(theta).all():
            size = self.size if derivatives else None
            yield from undefined_blocks(self.segments, self.outputs, size, only=only)
            return
        chain = self.chain(z, theta) if derivatives else None
        for k, segment in enumerate(self.segments):
            if only is not None and k != only:
                continue
            moves = derivatives and bool(self.free or self._states[k])  # else zeros alone are free
            with np.errstate(all="ignore"):
                response = self.model.response(
                    theta,
                    segment,
                    self.outputs,
                    start=self.start(z, k),
                    derivatives=moves,
                    relative=self.has_equilibrium,
                    plan=plans[k] if plans is not None else None,
                )
            for name in self.outputs:
                used = segment.used[name]
                zero = z[self.zero_position(self.owner[k], name)] if self.zeros else 0.0
                used_rows = slice(None) if used.all() else used
                residual = (segment.outputs[name] - response.outputs[name] - zero)[used_rows]
                jacobian = None
                if chain is not None and (response.by_parameter is not None or not moves):
                    jacobian = np.zeros((residual.size, self.size))
                    if response.by_parameter is not None:
                        by = response.by_parameter[name][used_rows]
                        jacobian[:, : len(self.free)] = by @ chain
                    if self.zeros:
                        jacobian[:, self.zero_position(self.owner[k], name)] = 1.0
                    states = self._states[k]
                    if states and response.by_state is not None:
                        by_state = response.by_state[name][used_rows, : len(states)]
                        jacobian[:, states] = by_state
                yield Block(name, k, residual, jacobian)
