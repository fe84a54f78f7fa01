"""What the user knows about the parameters, laid over what the model declares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from softid.arguments import require_parameters
from softid.errors import UsageError
from softid.parameters import Parameter, ParameterSet
from softid.tie_expressions import names_in_tie

if TYPE_CHECKING:
    import lmfit


@dataclass(frozen=True, eq=False)
class ParameterConstraints:
    """Start values, bounds, fixed values and ties that the user asked for.

    What the user left as the model has it is no wish: units and direction come from the logs, and
    a limit of the model drops parameters.

    Attributes
    ----------
    base
        Parameters of the model as the user knows it, before it is adapted to the logs.
    asked
        The same with the user's changes.
    """

    base: ParameterSet
    asked: ParameterSet

    @classmethod
    def of(
        cls, base: ParameterSet, asked: ParameterSet | lmfit.Parameters | None
    ) -> ParameterConstraints:
        """Take constraints in any form that `softid.fit` accepts.

        Raises
        ------
        UsageError
            These are no parameters, or one of them is unknown, or one that the model holds with
            these options is free or has other bounds.
        """
        if asked is None:
            return cls(base, base)
        known = require_parameters(asked)
        constraints = cls(
            base, known if isinstance(known, ParameterSet) else _from_lmfit(base, known)
        )
        for name, wish in constraints.asked.items():
            if name not in base:
                raise UsageError(
                    f"the model has no parameter {name}",
                    remedy=f"choose from {', '.join(base.names)}",
                )
            if base[name].fixed and not (wish.fixed and _has_own_bounds(base[name], wish)):
                raise UsageError(
                    f"the model holds {name} at {base[name].value:g} with these options",
                    where=f"parameter {name}",
                    remedy="leave it fixed and its bounds as they are, or choose other options of "
                    "the model",
                )
        return constraints

    def among(self, declared: ParameterSet) -> ParameterConstraints:
        """The same for a model that extends this one; of what it adds the user asked nothing.

        Parameters
        ----------
        declared
            Parameters of the extended model.
        """
        added = [p for name, p in declared.items() if name not in self.base]
        base, asked = (ParameterSet((*known.values(), *added)) for known in (self.base, self.asked))
        return ParameterConstraints(base, asked)

    @cached_property
    def changed(self) -> dict[str, Parameter]:
        """The parameters that differ from the model's own."""
        return {name: p for name, p in self.asked.items() if p != self.base[name]}

    def over(self, declared: ParameterSet) -> ParameterSet:
        """Lay the constraints over the parameters of the adapted model or of one of its limits.

        A parameter that a limit has dropped stays dropped.
        """
        overlaid = declared
        for name, wish in self.changed.items():
            p = declared[name]
            if p.fixed and not self.base[name].fixed:
                continue
            overlaid = overlaid.replacing(
                replace(
                    p,
                    value=wish.value,
                    lower=wish.lower,
                    upper=wish.upper,
                    fixed=wish.fixed,
                    tie=wish.tie,
                )
            )
        return overlaid

    def keep(self, names: Set[str]) -> bool:
        """Whether a tie or a raised lower bound keeps one of these parameters in the model."""
        ties = [p.tie for p in self.changed.values() if p.tie is not None]
        used = {name for tie in ties for name in names_in_tie(tie, where="tie")}
        raised = {n for n, p in self.changed.items() if p.lower > self.base[n].lower}
        return bool((used | raised) & names)

    def bounds(self, name: str) -> bool:
        """Whether the user bounded a parameter."""
        wish, own = self.changed.get(name), self.base[name]
        return wish is not None and (wish.lower, wish.upper) != (own.lower, own.upper)

    def starts(
        self, overlaid: ParameterSet, found: Sequence[Mapping[str, float]]
    ) -> list[dict[str, float]]:
        """Starts for the optimiser: the user's own values first, then those found from the data.

        Parameters
        ----------
        overlaid
            From `over`.
        found
            Parameter name → value from the data.
        """

        def within(p: Parameter, value: float) -> float:
            return p.value if p.fixed else float(min(max(value, p.lower), p.upper))

        starts = [{n: within(p, start[n]) for n, p in overlaid.items()} for start in found]
        own = {
            n: p.value
            for n, p in self.changed.items()
            if not p.fixed and p.tie is None and p.value != self.base[n].value
        }
        if own and starts:
            starts.insert(0, starts[0] | own)
        return starts or [overlaid.values_dict()]


def _has_own_bounds(own: Parameter, held: Parameter) -> bool:
    """Whether a held parameter has the model's bounds, as far as its value is not in the way."""
    bounds = min(own.lower, held.value), max(own.upper, held.value)
    return (held.lower, held.upper) in (bounds, (own.lower, own.upper))


def _from_lmfit(base: ParameterSet, asked: lmfit.Parameters) -> ParameterSet:
    """Take lmfit's parameters as the model's; where lmfit has no bound, the model's own stays."""
    taken = []
    for name, p in base.updated_from_lmfit(asked).items():
        own = base[name]
        lower = own.lower if name in asked and np.isneginf(asked[name].min) else p.lower
        upper = own.upper if name in asked and np.isposinf(asked[name].max) else p.upper
        if p.fixed or p.tie is not None:
            lower, upper = min(lower, p.value), max(upper, p.value)
        value = float(np.clip(p.value, lower, upper))
        taken.append(replace(p, value=value, lower=lower, upper=upper))
    return ParameterSet(tuple(taken))
