"""Named parameters with bounds, scale and ties, and the bridge to lmfit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from softid.errors import UsageError
from softid.tie_expressions import names_in_tie

if TYPE_CHECKING:
    import lmfit

Array = npt.NDArray[np.float64]
ParameterScale = Literal["linear", "log"]


@dataclass(frozen=True)
class Parameter:
    """One model parameter.

    Attributes
    ----------
    name
        Identifier, valid as a Python name.
    value
        Current value in ``unit``.
    unit
        Unit as text, ``"1"`` when there is none.
    lower, upper
        Bounds; infinite when there are none.
    scale
        ``"log"`` for a positive parameter that is searched over its logarithm.
    fixed
        Held at ``value`` in a fit.
    tie
        An expression in other parameters that gives the value, or None; see
        `softid.tie_expressions`.
    meaning
        One sentence for people.
    source
        Paper and equation.

    Raises
    ------
    UsageError
        The bounds are crossed, the value lies outside them, on a logarithmic scale they do not
        leave it positive, or the tie is no arithmetic.
    """

    name: str
    value: float
    unit: str = "1"
    lower: float = -np.inf
    upper: float = np.inf
    scale: ParameterScale = "linear"
    fixed: bool = False
    tie: str | None = None
    meaning: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        if self.scale == "log" and (self.lower < 0 or self.upper <= 0):
            raise UsageError(
                f"{self.name} must be positive, being on a logarithmic scale",
                where=f"parameter {self.name}",
                value=self.lower if self.lower < 0 else self.upper,
                remedy="give bounds above zero",
            )
        if not self.lower <= self.upper:
            raise UsageError(
                "the lower bound is above the upper bound",
                where=f"parameter {self.name}",
                value=(self.lower, self.upper),
                remedy="swap the bounds",
            )
        if not math.isfinite(self.value) or not self.lower <= self.value <= self.upper:
            raise UsageError(
                f"the value is not within [{self.lower:g}, {self.upper:g}]",
                where=f"parameter {self.name}",
                value=self.value,
                remedy="give a value inside the bounds, or widen them",
            )
        if self.tie is not None:
            names_in_tie(self.tie, where=f"parameter {self.name}")

    @property
    def usual_size(self) -> float:
        """Size by which it is moved in proportion, positive.

        That of its value; where that is zero, the width of its bounds or, without bounds, one.
        """
        if self.value != 0.0:
            return abs(self.value)
        width = self.upper - self.lower
        return width if math.isfinite(width) and width > 0.0 else 1.0


@dataclass(frozen=True)
class ParameterSet(Mapping[str, Parameter]):
    """Parameters in a fixed order.

    Raises
    ------
    UsageError
        A parameter is declared twice.

    Examples
    --------
    >>> s = ParameterSet((Parameter("M", 2.0), Parameter("N", 3.0, fixed=True)))
    >>> s.free, s.values_vector().tolist()
    (('M',), [2.0, 3.0])
    """

    parameters: tuple[Parameter, ...]

    def __post_init__(self) -> None:
        names = [p.name for p in self.parameters]
        if len(set(names)) != len(names):
            raise UsageError("a parameter is declared twice", value=names)

    def __getitem__(self, name: str) -> Parameter:
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return (p.name for p in self.parameters)

    def __len__(self) -> int:
        return len(self.parameters)

    @property
    def names(self) -> tuple[str, ...]:
        """All names, in order."""
        return tuple(p.name for p in self.parameters)

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the parameters that a fit varies."""
        return tuple(p.name for p in self.parameters if not p.fixed and p.tie is None)

    def values_vector(self) -> Array:
        """All values in order, shape (K,)."""
        return np.array([p.value for p in self.parameters], dtype=np.float64)

    def values_dict(self) -> dict[str, float]:
        """Name → value."""
        return {p.name: p.value for p in self.parameters}

    def with_values(self, values: Mapping[str, float]) -> ParameterSet:
        """The same parameters at other values, clipped to their bounds.

        Raises
        ------
        UsageError
            A name is unknown.
        """
        self._known(values)
        return ParameterSet(
            tuple(
                replace(p, value=float(min(max(values.get(p.name, p.value), p.lower), p.upper)))
                for p in self.parameters
            )
        )

    def with_fixed(self, values: Mapping[str, float]) -> ParameterSet:
        """Hold the named parameters at the given values, moving a bound that is in the way.

        Raises
        ------
        UsageError
            A parameter is unknown, or cannot take its value: not finite, or negative on a
            logarithmic scale.
        """
        self._known(values)

        def hold(p: Parameter) -> Parameter:
            if p.name not in values:
                return p
            v = float(values[p.name])
            return replace(
                p, value=v, fixed=True, lower=min(p.lower, v), upper=max(p.upper, v), tie=None
            )

        return ParameterSet(tuple(hold(p) for p in self.parameters))

    def replacing(self, parameter: Parameter) -> ParameterSet:
        """The same set with one parameter exchanged for another of the same name.

        Raises
        ------
        UsageError
            There is no parameter of that name.
        """
        self._known({parameter.name: 0.0})
        return ParameterSet(
            tuple(parameter if p.name == parameter.name else p for p in self.parameters)
        )

    def _known(self, names: Mapping[str, float]) -> None:
        known = self.names
        unknown = [n for n in names if n not in known]
        if unknown:
            raise UsageError(
                f"the model has no parameter {unknown[0]}",
                remedy=f"choose from {', '.join(self.names)}",
            )

    def to_lmfit(self) -> lmfit.Parameters:
        """The parameters as lmfit knows them; a tie becomes lmfit's ``expr``."""
        import lmfit  # about a second to import, and only users of lmfit and ties need it

        out = lmfit.Parameters()
        for p in self.parameters:
            if p.lower == p.upper:  # lmfit refuses bounds without width
                out.add(p.name, value=p.value, vary=False)
            else:
                out.add(p.name, value=p.value, vary=not p.fixed, min=p.lower, max=p.upper)
        for p in self.parameters:
            if p.tie is not None:
                _tie(out, p.name, p.tie)
        return out

    def updated_from_lmfit(self, parameters: lmfit.Parameters) -> ParameterSet:
        """Take value, bounds, ``vary`` and ``expr`` from lmfit parameters; the rest stays.

        Raises
        ------
        UsageError
            lmfit's set names a parameter that the model does not have, or as `Parameter`.
        """
        self._known(dict.fromkeys(parameters, 0.0))
        taken = []
        for p in self.parameters:
            if p.name not in parameters:
                taken.append(p)
                continue
            q = parameters[p.name]
            is_open = p.scale == "log" and np.isneginf(q.min)
            lower = 0.0 if is_open else q.min  # of a logarithm, which has no lower bound either
            taken.append(
                replace(
                    p,
                    value=float(q.value),
                    lower=float(lower),
                    upper=float(q.max),
                    fixed=not q.vary and q.expr is None,
                    tie=q.expr,
                )
            )
        return ParameterSet(tuple(taken))


def _tie(parameters: lmfit.Parameters, name: str, expression: str) -> None:
    """Hand an expression to lmfit, whose errors come from deep inside its interpreter."""
    unknown = sorted(names_in_tie(expression, where=f"parameter {name}") - {*parameters})
    if unknown:
        raise _not_computable(f"there is no parameter {unknown[0]}", name, expression)
    try:
        with np.errstate(all="ignore"):
            parameters[name].expr = expression
            parameters.update_constraints()
    except RecursionError as error:
        raise _not_computable("the parameter depends on itself", name, expression) from error
    except Exception as error:
        # Any expression may be given, so that any exception may come out of it.
        what = str(error) or type(error).__name__
        raise _not_computable(f"the tie cannot be computed: {what}", name, expression) from error


def _not_computable(what: str, name: str, expression: str) -> UsageError:
    return UsageError(
        what,
        where=f"parameter {name}",
        value=expression,
        remedy="write it in the names of other parameters, such as 0.1*c2",
    )
