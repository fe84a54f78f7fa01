"""Numbers that may differ between logs, each freed in turn, and what a model leaves of them."""

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
from softid.effects.scale import Scale
from softid.fitters.output_error import refit_nuisance
from softid.fitters.problem import Problem
from softid.log import Log

Array = npt.NDArray[np.float64]
Sizes = tuple[float, ...] | None
"""Of what was freed in a log; None where it is not known."""

LARGEST_SHARE = 0.55
"""A change by a larger share is no small difference of one rig."""

LARGEST_PAYLOAD = 5.0
"""An inertia may be so many times as large all the same, for a payload changes it, or a mount."""

SIGN, TURNED = "sign", -2.0
"""Kind of a difference that is a turned output, and its size: the change of a gain of 1 to −1."""

DELAY = "delay"
"""Kind of a difference whose size is in seconds."""


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


@dataclass(frozen=True, eq=False)
class Change:
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

    def joined_with(self, other: Change) -> Change | None:
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
class Turn(Change):
    """The sign of the first output, where that of some logs is turned."""

    def joined_with(self, other: Change) -> None:
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


def changes_of(reference: Candidate, scale: Scale) -> list[Change]:
    """Everything that may differ: the sign, every free parameter, and what the probes change."""
    problem, values = reference.problem, reference.parameters
    scale = _own_scale(reference, scale)
    found: list[Change] = [Turn((SIGN,), (), problem, values)]
    found += [Change((name,), (name,), problem, values) for name in problem.free]
    for law in PROBES:
        probe = law()
        own = named_values(probe, probe.starts(scale)[0])
        extended = extend(problem, (probe,), scale)
        found += [
            Change((kind,), (name,), extended, {**values, **own})
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
