"""The empirical polynomial of Zhao et al.: output against pressure, without any dynamics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, UsageError
from softid.models.base import Model, Response
from softid.models.division import Division
from softid.parameters import Parameter, ParameterSet
from softid.segment import Segment

Array = npt.NDArray[np.float64]

MAX_ORDER = 12
"""Highest order, a judgement: a static curve needs three or four, and higher ones follow noise."""

_NEGLIGIBLE_RISE = 1e-12
"""Share of all that a curve rises and falls between two turns that is no more than rounding."""

_SUPERSCRIPTS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True, eq=False)
class Domain:
    """The map u = (x − centre)/half that takes the fitted range to [−1, 1].

    In raw kPa the powers of 10 to 80 have a condition number of 2.3e8, in u it is 17.

    Attributes
    ----------
    centre, half
        Middle and half the width of the range.
    """

    centre: float
    half: float

    @classmethod
    def over(cls, x: npt.ArrayLike) -> Domain:
        """The domain that just holds all values."""
        values = np.asarray(x, dtype=np.float64)
        low, high = float(values.min()), float(values.max())
        return cls(0.5 * (low + high), 0.5 * (high - low) or 1.0)

    def scaled(self, x: npt.ArrayLike) -> Array:
        """The scaled variable u of values of any shape."""
        u: Array = (np.asarray(x, dtype=np.float64) - self.centre) / self.half
        return u

    def to_raw(self, order: int) -> Array:
        """Matrix that takes coefficients in u to those in x, both highest power first.

        Shape (order + 1, order + 1).
        """
        line = np.polynomial.Polynomial([-self.centre / self.half, 1.0 / self.half])
        matrix = np.zeros((order + 1, order + 1))
        power = np.polynomial.Polynomial([1.0])
        for k in range(order + 1):
            matrix[order - k : order + 1, order - k] = power.coef[::-1]
            power = power * line
        return matrix


def powers(x: npt.ArrayLike, order: int) -> Array:
    """The basis xⁿ, …, x, 1, shape (len(x), order + 1)."""
    return np.vander(np.asarray(x, dtype=np.float64), order + 1)


def evaluate(coefficients: npt.ArrayLike, x: npt.ArrayLike) -> Array:
    """f(x) = p1·xⁿ + … + p(n+1), coefficients highest power first, x of any shape."""
    value: Array = np.asarray(np.polyval(np.asarray(coefficients), np.asarray(x)), np.float64)
    return value


def turning_points(coefficients: npt.ArrayLike, low: float, high: float) -> Array:
    """Where the polynomial changes between rising and falling strictly inside (low, high).

    Parameters
    ----------
    coefficients
        Highest power first.
    low, high
        The range looked at.

    Returns
    -------
    ndarray
        The turning points in rising order; a flat point where the slope keeps its sign is none.

    Examples
    --------
    >>> turning_points([1.0, 0.0, 0.0], -1.0, 2.0).tolist()
    [0.0]
    """
    domain = Domain(0.5 * (low + high), 0.5 * (high - low))
    order = np.size(coefficients) - 1
    scaled = np.linalg.solve(domain.to_raw(order), np.asarray(coefficients, dtype=np.float64))
    curve = np.polynomial.Polynomial(scaled[::-1])
    roots = curve.deriv().roots()
    real = np.sort(roots[np.isreal(roots)].real)
    edges = np.concatenate([[-1.0], real[np.abs(real) < 1.0], [1.0]])
    rises = np.diff(curve(edges))
    # Rounding splits the double root of a flat point into two with nothing between them.
    seen = np.abs(rises) > _NEGLIGIBLE_RISE * np.abs(rises).sum()
    starts, signs = edges[:-1][seen], np.sign(rises[seen])
    turning: Array = domain.centre + domain.half * starts[1:][signs[1:] != signs[:-1]]
    return turning


def is_monotone(coefficients: npt.ArrayLike, low: float, high: float) -> bool:
    """Whether the polynomial only rises or only falls over [low, high].

    Examples
    --------
    >>> is_monotone([1.0, 0.0, 0.0], 0.0, 2.0)
    True
    """
    return turning_points(coefficients, low, high).size == 0


def backward_stretches(
    coefficients: npt.ArrayLike, low: float, high: float
) -> tuple[tuple[float, float], ...]:
    """Stretches of [low, high] where the polynomial runs against its overall direction."""
    edges = np.concatenate([[low], turning_points(coefficients, low, high), [high]])
    rises = np.diff(evaluate(coefficients, edges))
    overall = np.sign(rises.sum())
    return tuple(
        (float(a), float(b))
        for a, b, rise in zip(edges, edges[1:], rises, strict=False)
        if np.sign(rise) == -overall
    )


@dataclass(frozen=True)
class Polynomial(Model):
    """y = p1·xⁿ + … + p(n+1), a static curve of the pressure x in kPa; n = 4 in the paper.

    The curve is empirical: it holds within the fitted range and nowhere else, it need not be
    monotone (the paper's own is not), and f(0) is not zero. The last coefficient and a sensor zero
    are the same thing, so only one of the two can be estimated.

    Attributes
    ----------
    order
        n, from 1 to 12.
    output_unit, input_unit
        Units of y and x, for the units of the coefficients.

    Raises
    ------
    UsageError
        The order is no whole number, or too small or large.

    Source: Zhao et al. 2021, doi 10.1155/2021/6623059, Eq 23.
    """

    order: int = 4
    output_unit: str = "1"
    input_unit: str = "kPa"

    name: ClassVar[str] = "polynomial"
    title: ClassVar[str] = "Empirical polynomial of output against pressure"
    equation: ClassVar[str] = "y = p1 x^4 + p2 x^3 + p3 x^2 + p4 x + p5,  x in kPa"
    own_zero: ClassVar[bool] = True
    source: ClassVar[str] = "Zhao et al. 2021, doi 10.1155/2021/6623059, Eq 23"
    identified_by: ClassVar[Mapping[str, str]] = {
        f"p{k}": "more settled pressure levels than coefficients, spread over the whole range"
        for k in range(1, MAX_ORDER + 2)
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 1 <= self.order <= MAX_ORDER:
            raise UsageError(
                f"the order of a polynomial is a whole number from 1 to {MAX_ORDER}",
                value=self.order,
                remedy="choose 4, as the paper does, or choose by held-out error",
            )
        object.__setattr__(self, "order", int(self.order))

    def adapted(self, units: Mapping[str, str], *, inverted: bool = False) -> Polynomial:
        """The model with the units of the logs.

        Raises
        ------
        UsageError
            There is more than one output.
        """
        del inverted
        outputs = [name for name in units if name != "input"]
        self._one(outputs)
        return replace(
            self, output_unit=units[outputs[0]], input_unit=units.get("input", self.input_unit)
        )

    def parameters(self) -> ParameterSet:
        """The coefficients p1, …, p(n+1), highest power first, all zero and unbounded."""
        declared = []
        for k in range(self.order + 1):
            power = self.order - k
            meaning = f"coefficient of x to the power {power}" if power else "output at x = 0"
            declared.append(
                Parameter(
                    f"p{k + 1}",
                    0.0,
                    self._unit(power),
                    meaning=meaning,
                    source="Zhao et al. 2021, Eq 23",
                )
            )
        return ParameterSet(tuple(declared))

    def _unit(self, power: int) -> str:
        if power == 0 or self.input_unit == "1":
            return self.output_unit
        exponent = "" if power == 1 else str(power).translate(_SUPERSCRIPTS)
        return f"{self.output_unit}/{self.input_unit}{exponent}"

    def guess(self, segments: Sequence[Segment], output: str) -> tuple[ParameterSet, ...]:
        """The least-squares optimum itself, computed on the range scaled to [−1, 1].

        Raises
        ------
        IdentificationError
            The logs hold fewer different input values than the polynomial has coefficients.
        """
        x = np.concatenate([s.input[s.used[output]] for s in segments])
        y = np.concatenate([s.outputs[output][s.used[output]] for s in segments])
        distinct = np.unique(x).size
        if distinct <= self.order:
            raise IdentificationError(
                f"the logs hold {distinct} different input values, a polynomial of order "
                f"{self.order} needs at least {self.order + 1}",
                where=", ".join(dict.fromkeys(s.log_name for s in segments)),
                remedy="lower the order, or add a log with more levels",
            )
        domain = Domain.over(x)
        scaled = np.linalg.lstsq(powers(domain.scaled(x), self.order), y, rcond=None)[0]
        raw = domain.to_raw(self.order) @ scaled
        declared = self.parameters()
        return (declared.with_values(dict(zip(declared.names, raw.tolist(), strict=True))),)

    def response(
        self,
        theta: Array,
        segment: Segment,
        outputs: Sequence[str],
        *,
        start: Array | None,
        derivatives: bool,
        relative: bool = False,
        plan: Division | None = None,
    ) -> Response:
        """The curve at every sample; see `Model.response`.

        Raises
        ------
        UsageError
            There is more than one output.
        """
        del start, plan
        output = self._one(outputs)
        values = {output: evaluate(theta, segment.input)}
        empty = np.empty(0)
        if not derivatives:
            return Response(values, None, None, empty)
        by_parameter = {output: powers(segment.input, self.order)}
        by_state = {output: np.empty((segment.input.size, 0))}
        return Response(values, by_parameter, by_state, empty)

    def static_output(self, theta: Array, input_values: Array, output: str) -> Array:
        """The curve itself: it has no dynamics."""
        del output
        return evaluate(theta, input_values)

    def _one(self, outputs: Sequence[str]) -> str:
        if len(outputs) != 1:
            raise UsageError(
                "one polynomial describes one output",
                value=", ".join(outputs),
                remedy="fit each output on its own with --output (outputs= in Python)",
            )
        return outputs[0]
