"""Whether a misfit is a difference between logs: another gain, load, stiffness or delay in each.

Something was changed between two logs, and one model is to follow both. A model that follows one of
them is put to the others with one change for each, which is fitted with its zero and initial state.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.changes.probes import PROBES
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import elastic_force
from softid.diagnosis.refit.extension import extend, named_values
from softid.effects.scale import Scale
from softid.fitters.output_error import refit_nuisance
from softid.fitters.problem import Problem
from softid.log import Log
from softid.parallel import in_parallel

Array = npt.NDArray[np.float64]

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
    """

    kinds: tuple[str, ...]
    sizes: tuple[float, ...]
    share: float


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
        None where no kind takes so much.
    """
    misfit = before - noise
    if not misfit > 0.0:
        return None
    changes = _changes(reference, scale)
    fitted = in_parallel(lambda change: [change.on(log) for log in logs], changes)
    falls = [
        (before - own - sum(left for left, _ in rows)) / misfit
        if change.may_be([size for _, size in rows])
        else -np.inf
        for change, rows in zip(changes, fitted, strict=True)
    ]
    ranked = np.argsort(falls[1:])[::-1] + 1
    if zero_counts and falls[0] > RIVAL_SHARE * falls[ranked[0]]:
        ranked = np.zeros(1, np.intp)
    most = falls[ranked[0]]
    if not most > LEAST_TAKEN:
        return None
    alike = [k for k in ranked.tolist() if falls[k] > RIVAL_SHARE * most]
    variance = noise / sum(log.time_s.size for log in logs)
    level = sorted(k for k in alike if (most - falls[k]) * misfit < SAME_SQUARES * variance)
    alike = [*level, *(k for k in alike if k not in level)]
    outside = [k for k in alike if changes[k].kind not in reference.problem.free]
    alike = outside or alike  # what has a name of its own comes before a parameter
    sizes = tuple(size for _, size in fitted[alike[0]] if size is not None)
    return LogDifferences(tuple(changes[k].kind for k in alike), sizes, min(falls[alike[0]], 1.0))


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


@dataclass(frozen=True, eq=False)
class _Change:
    """One free parameter beside others that stay, or none.

    Attributes
    ----------
    kind
        As in `LogDifferences`; not its name where it is that of a probe.
    name
        The parameter; empty where only the zero differs.
    problem
        The model over the logs that it was fitted to.
    values
        The values that stay, and that of the parameter as it was.
    """

    kind: str
    name: str
    problem: Problem
    values: Mapping[str, float]

    def may_be(self, sizes: Sequence[float | None]) -> bool:
        """Whether changes are small enough for one rig; only its bounds limit a delay."""
        return all(s is not None and (self.kind == DELAY or abs(s) <= LARGEST_SHARE) for s in sizes)

    def on(self, log: Log) -> tuple[float, float | None]:
        """What is left of a log, and the change: of a parameter of the model as a share of it.

        No change is known at a bound, nor of a parameter of the model that was 0, which has no
        share; the sizes of a probe are about 0 and stand for themselves.
        """
        others = {name: value for name, value in self.values.items() if name != self.name}
        declared = self.problem.parameters.with_values(self.values).with_fixed(others)
        problem = Problem(self.problem.model, declared, (log,))
        z = refit_nuisance(problem).unknowns
        left = squares_of(problem, z)
        if not self.name:
            return left, 0.0
        if problem.at_bound(z)[problem.free.index(self.name)]:
            return left, None
        value, known = float(problem.values(z)[self.name]), self.values[self.name]
        if self.kind != self.name:  # that of a probe
            return left, value
        return left, value / known - 1.0 if known else None


@dataclass(frozen=True, eq=False)
class _Turn(_Change):
    """The sign of the first output, where that of some logs is turned."""

    def may_be(self, sizes: Sequence[float | None]) -> bool:
        """Whether any is; without one it is a zero of their own."""
        return any(sizes)

    def on(self, log: Log) -> tuple[float, float | None]:
        """What is left of a log with the better sign, and its change."""
        channel = log.channels[self.problem.outputs[0]]
        turned = replace(channel, values=-channel.values)
        as_it_is, _ = super().on(log)
        left, _ = super().on(replace(log, channels={**log.channels, channel.name: turned}))
        return (as_it_is, 0.0) if as_it_is <= left else (left, TURNED)


def _changes(reference: Candidate, scale: Scale) -> list[_Change]:
    """Everything that may differ: the zero, every free parameter, and what the probes change."""
    problem, values = reference.problem, reference.parameters
    scale = _own_scale(reference, scale)
    found = [_Change(ZERO, "", problem, values), _Turn(SIGN, "", problem, values)]
    found += [_Change(name, name, problem, values) for name in problem.free]
    for law in PROBES:
        probe = law()
        own = named_values(probe, probe.starts(scale)[0])
        extended = extend(problem, (probe,), scale)
        found += [
            _Change(kind, name, extended, {**values, **own})
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
