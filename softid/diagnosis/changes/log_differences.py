"""Whether a misfit is a difference between logs: another gain, load, stiffness or delay in each.

Something was changed between two logs, and one model is to follow both. A model that follows one of
them is put to the others with one change for each, which is fitted with its zero and initial state.
Where one does not do, a second is freed beside it: a payload adds inertia and weight.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from operator import is_

import numpy as np
import numpy.typing as npt

from softid.diagnosis.changes.probes import PROBES
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import elastic_force
from softid.diagnosis.refit.extension import extend, named_values
from softid.diagnosis.residual.noise_floor import SMALLEST_EXCESS
from softid.effects.scale import Scale
from softid.fitters.output_error import refit_nuisance
from softid.fitters.problem import Problem
from softid.log import Log
from softid.parallel import in_parallel

Array = npt.NDArray[np.float64]
Sizes = tuple[float, ...] | None
"""Of what was freed in a log; None where it is not known."""

LEAST_TAKEN = 0.9
"""A difference must take away so much of the misfit above the noise."""

RIVAL_SHARE = 0.97
"""Kinds that take away so much of what the best does are told beside it."""

SAME_SQUARES = 1.0
"""Kinds whose sums of squares differ by less, in variances of the noise, are the same here, and the
first that is declared stands for them: a gain of the reading and one of the pressure, in a linear
model."""

LARGEST_SHARE = 0.55
"""A change by a larger share is no small difference of one rig."""

LARGEST_PAYLOAD = 5.0
"""An inertia may be so many times as large all the same, for a payload changes it, or a mount."""

MUST_LEAVE = 0.5
"""Share of what one change leaves of the misfit that a second one beside it may leave at most."""

LEAST_START = 0.25
"""Share of the misfit above the noise that a change takes away by itself before a second one is
tried beside it."""

ZERO = "zero"
"""Kind of a difference that every log has anyway."""

SIGN, TURNED = "sign", -2.0
"""Kind of a difference that is a turned output, and its size: the change of a gain of 1 to −1."""

DELAY = "delay"
"""Kind of a difference whose size is in seconds."""


@dataclass(frozen=True)
class LogDifferences:
    """What differs from log to log.

    Attributes
    ----------
    kinds
        What differs, the one that takes most first: ``sign``, ``gain``, ``delay``, ``drift`` and
        ``settling_drift`` of the reading, ``load``, ``stiffness``, ``damping``, ``pressure_gain``,
        ``pressure_zero`` or a parameter of the model; all others take nearly as much. It is
        ``zero`` alone where that does.
    sizes
        Of the first kind, for each log: shares, a load as a share of the elastic force, a zero of
        the pressure as a share of the input's range, a drift as one of the output's over the
        longest log, a delay in s; no numbers for a zero.
    share
        Share of the misfit above the noise that goes.
    beside
        What differs besides, where one number for each log does not take so much; its share is that
        of both.
    """

    kinds: tuple[str, ...]
    sizes: tuple[float, ...]
    share: float
    beside: LogDifferences | None = None


def log_differences(
    reference: Candidate,
    scale: Scale,
    logs: Sequence[Log],
    *,
    before: float,
    noise: float,
    own: float = 0.0,
    zero_counts: bool = False,
) -> LogDifferences | None:
    """What differs from log to log and takes away nearly all of the misfit that is more than noise.

    Parameters
    ----------
    reference
        A model whose parameters stay.
    scale
        Sizes of the base fit.
    logs
        Other logs, with the channels of the model.
    before, noise
        Sums of squares of the first output over these logs, and over what belongs to ``own``: of
        the misfit, and of the noise.
    own
        Sum of squares that the reference leaves on what it was fitted to, if that counts.
    zero_counts
        Whether a zero of their own is a difference.

    Returns
    -------
    LogDifferences or None
        None where neither one kind nor two take so much.
    """
    misfit = before - noise
    if not misfit > 0.0:
        return None
    problem, values = reference.problem, reference.parameters
    same = SAME_SQUARES * noise / (misfit * sum(log.time_s.size for log in logs))

    def tried(changes: Sequence[_Change]) -> _Tried:
        fitted = in_parallel(lambda change: [change.on(log) for log in logs], changes)
        rows = [[sizes for _, sizes in each] for each in fitted]
        left = [sum(squares for squares, _ in each) for each in fitted]
        falls = [
            (before - own - squares) / misfit if change.may_be(sizes) else -np.inf
            for change, squares, sizes in zip(changes, left, rows, strict=True)
        ]
        return _Tried(changes, rows, np.array(falls), same)

    single = tried(_changes(reference, scale))
    if zero_counts:
        zero = tried([_Change((ZERO,), (), problem, values)])
        if zero.most > max(LEAST_TAKEN, RIVAL_SHARE * single.most):
            return zero.told(problem.free)
    left = misfit * (1.0 - single.most)
    pairs = single.joined_with_best() if single.most > LEAST_START else []
    if pairs and (single.most <= LEAST_TAKEN or left > SMALLEST_EXCESS * noise):
        both = tried(pairs)
        if both.most > max(LEAST_TAKEN, 1.0 - MUST_LEAVE * (1.0 - single.most)):
            return both.told(problem.free)
    return single.told(problem.free) if single.most > LEAST_TAKEN else None


def standing_over(logs: Sequence[Log], model: Candidate) -> tuple[Problem, Array]:
    """A model over whole logs of which it was fitted to parts, and its unknowns there.

    Parameters
    ----------
    logs
        The logs.
    model
        A model whose parameters stay.
    """
    if len(logs) == len(model.problem.logs) and all(map(is_, logs, model.problem.logs)):
        return model.problem, model.minimum.point
    held = model.problem.parameters.with_fixed(model.parameters)
    problem = Problem(model.problem.model, held, logs)
    return problem, refit_nuisance(problem).unknowns


def squares_of(problem: Problem, z: Array) -> float:
    """Sum of squares that is left of the first output.

    Parameters
    ----------
    problem
        The logs and their model.
    z
        Its unknowns, shape (U,).
    """
    blocks = problem.blocks(z, derivatives=False)
    parts = (b.residual for b in blocks if b.channel == problem.outputs[0])
    return float(sum(part @ part for part in parts))


def turned_output(
    reference: Candidate, logs: Sequence[Log], before: float
) -> LogDifferences | None:
    """That the first output of other logs has the other sign, whatever else a model misses.

    Parameters
    ----------
    reference, logs
        As in `log_differences`.
    before
        Sum of squares that the model leaves of the first output over these logs.
    """
    change = _Turn((SIGN,), (), reference.problem, reference.parameters)
    rows = [change.on(log) for log in logs]
    share = 1.0 - sum(left for left, _ in rows) / before if before > 0.0 else 0.0
    sizes = tuple(size for _, row in rows for size in row or ())
    return LogDifferences((SIGN,), sizes, share) if share > LEAST_TAKEN and any(sizes) else None


def squares_with(
    reference: Candidate, scale: Scale, logs: Sequence[Log], found: LogDifferences
) -> float:
    """Sum of squares that a model leaves of other logs if each has its own of what differs.

    Parameters
    ----------
    reference, scale, logs
        As in `log_differences`.
    found
        What differs; of kinds that do as well the first.

    Returns
    -------
    float
        Infinite where the model has no such number.
    """
    changes = {change.kinds[0]: change for change in _changes(reference, scale)}
    asked = changes.get(found.kinds[0])
    if asked is not None and found.beside is not None:
        second = changes.get(found.beside.kinds[0])
        asked = None if second is None else asked.joined_with(second)
    return np.inf if asked is None else sum(asked.on(log)[0] for log in logs)


@dataclass(frozen=True, eq=False)
class _Change:
    """Free parameters beside others that stay, or none.

    Attributes
    ----------
    kinds
        As in `LogDifferences`, one for each parameter; not its name where it is that of a probe.
    names
        The parameters; none where only the zero differs.
    problem
        The model over the logs that it was fitted to.
    values
        The values that stay, and those of the parameters as they were.
    """

    kinds: tuple[str, ...]
    names: tuple[str, ...]
    problem: Problem
    values: Mapping[str, float]

    def joined_with(self, other: _Change) -> _Change | None:
        """Both at once; None where no model holds the parameters of both."""
        wider = self if len(self.values) >= len(other.values) else other
        names = (*self.names, *other.names)
        if not other.names or not set(names) <= set(wider.values):
            return None
        return replace(wider, kinds=(*self.kinds, *other.kinds), names=names)

    def may_be(self, sizes: Sequence[Sizes]) -> bool:
        """Whether changes are small enough for one rig; only its bounds limit a delay."""
        return all(row is not None and all(map(self._is_small, self.kinds, row)) for row in sizes)

    def _is_small(self, kind: str, size: float) -> bool:
        if kind == self.problem.model.inertia_parameter:
            return 1.0 / LARGEST_PAYLOAD <= 1.0 + size <= LARGEST_PAYLOAD
        return kind == DELAY or abs(size) <= LARGEST_SHARE

    def on(self, log: Log) -> tuple[float, Sizes]:
        """What is left of a log, and the changes: of parameters of the model as shares of them.

        No change is known at a bound, nor of a parameter of the model that was 0, which has no
        share; the sizes of a probe are about 0 and stand for themselves.
        """
        others = {name: value for name, value in self.values.items() if name not in self.names}
        declared = self.problem.parameters.with_values(self.values).with_fixed(others)
        problem = Problem(self.problem.model, declared, (log,))
        z = refit_nuisance(problem).unknowns
        left = squares_of(problem, z)
        at_bound, found = problem.at_bound(z), problem.values(z)
        if any(at_bound[problem.free.index(name)] for name in self.names):
            return left, None
        sizes = []
        for kind, name in zip(self.kinds, self.names, strict=False):
            value, known = float(found[name]), self.values[name]
            if kind == name and not known:
                return left, None
            sizes.append(value / known - 1.0 if kind == name else value)
        return left, tuple(sizes)


@dataclass(frozen=True, eq=False)
class _Turn(_Change):
    """The sign of the first output, where that of some logs is turned."""

    def joined_with(self, other: _Change) -> None:
        """None: what is turned is looked at again when it is mended."""

    def may_be(self, sizes: Sequence[Sizes]) -> bool:
        """Whether any is; without one it is a zero of their own."""
        return any(size for row in sizes for size in row or ())

    def on(self, log: Log) -> tuple[float, Sizes]:
        """What is left of a log with the better sign, and its change."""
        channel = log.channels[self.problem.outputs[0]]
        turned = replace(channel, values=-channel.values)
        as_it_is, _ = super().on(log)
        left, _ = super().on(replace(log, channels={**log.channels, channel.name: turned}))
        return (as_it_is, (0.0,)) if as_it_is <= left else (left, (TURNED,))


@dataclass(frozen=True, eq=False)
class _Tried:
    """Changes that were put to logs.

    Attributes
    ----------
    changes
        What was changed.
    rows
        For each change and each log, the sizes.
    falls
        Shares of the misfit above the noise that they take away; −∞ for what may not be, shape
        (changes,).
    same
        Falls that are no further apart are the same here.
    """

    changes: Sequence[_Change]
    rows: Sequence[Sequence[Sizes]]
    falls: Array
    same: float

    @property
    def most(self) -> float:
        """The largest share."""
        return float(self.falls.max())

    def joined_with_best(self) -> list[_Change]:
        """The change that takes the most, with each of the others."""
        first = self.changes[int(self.falls.argmax())]
        joined = (first.joined_with(change) for change in self.changes if change is not first)
        return [pair for pair in joined if pair is not None]

    def told(self, own: Sequence[str]) -> LogDifferences:
        """The kinds that take nearly as much as the best; of changes at once, the last's.

        Parameters
        ----------
        own
            Parameters of the model: what has a name of its own comes before them.
        """
        ranked = np.argsort(self.falls)[::-1].tolist()
        alike = [k for k in ranked if self.falls[k] > RIVAL_SHARE * self.most]
        level = sorted(k for k in alike if self.most - self.falls[k] < self.same)
        alike = [*level, *(k for k in alike if k not in level)]
        alike = [k for k in alike if self.changes[k].kinds[-1] not in own] or alike
        best, share = alike[0], min(float(self.falls[alike[0]]), 1.0)
        last = tuple(row[-1] for row in self.rows[best] if row)
        kinds = tuple(self.changes[k].kinds[-1] for k in alike)
        found = LogDifferences(kinds, last, share)
        if len(self.changes[best].kinds) == 1:
            return found
        first = tuple(row[0] for row in self.rows[best] if row)
        return LogDifferences(self.changes[best].kinds[:1], first, share, found)


def _changes(reference: Candidate, scale: Scale) -> list[_Change]:
    """Everything that may differ: the sign, every free parameter, and what the probes change."""
    problem, values = reference.problem, reference.parameters
    scale = _own_scale(reference, scale)
    found: list[_Change] = [_Turn((SIGN,), (), problem, values)]
    found += [_Change((name,), (name,), problem, values) for name in problem.free]
    for law in PROBES:
        probe = law()
        own = named_values(probe, probe.starts(scale)[0])
        extended = extend(problem, (probe,), scale)
        found += [
            _Change((kind,), (name,), extended, {**values, **own})
            for kind, name in zip(probe.kinds, own, strict=True)
        ]
    return found


def _own_scale(reference: Candidate, scale: Scale) -> Scale:
    """Sizes with the reference's own force: a law may be known up to a factor of all forces."""
    problem = reference.problem
    theta = problem.theta(reference.minimum.point)
    u = np.concatenate([segment.input for segment in problem.segments])
    force = elastic_force(problem.model, theta, u, (scale.x_low, scale.x_high))
    return replace(scale, force=force) if np.isfinite(force) else scale
