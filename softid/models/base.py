"""What a model is: declared parameters, start values from data, and a response with derivatives."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.models.division import Division
from softid.models.option_kinds import require_kinds
from softid.models.products import Keep, Products
from softid.models.second_order import Law
from softid.models.time_scales import Speeds
from softid.parameters import ParameterSet
from softid.results import ModelSpec
from softid.segment import Segment

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Response:
    """Output of a model over one segment, with derivatives.

    Attributes
    ----------
    outputs
        Output channel → samples without sensor zero, shape (n,).
    by_parameter
        Output channel → ∂y/∂θ, shape (n, K), in the order of `Model.parameters`; None if not asked.
    by_state
        Output channel → ∂y/∂(initial state), shape (n, S), in the order of `Model.start_states`;
        None if not asked.
    start
        Initial state used, shape (S,).
    x, v
        Position and velocity in the law of motion, each of shape (n,); None without one.
    """

    outputs: Mapping[str, Array]
    by_parameter: Mapping[str, Array] | None
    by_state: Mapping[str, Array] | None
    start: Array
    x: Array | None = None
    v: Array | None = None


@dataclass(frozen=True, eq=False)
class MotionTerm:
    """A law of motion that is not affine in its state, for the integrator of effects.

    Attributes
    ----------
    address
        Address of the compiled law.
    parameters
        θ, and behind it the constants of the law, shape (K + C,).
    slopes_address
        Address of what differentiates it by θ; see `softid.kernels.equation.Equation`.
    equilibrium
        Position at rest under an input; NaN when there is none.
    elastic
        Force by which the spring pulls back from a position.
    drift_at
        Which of θ is a drift rate that the sensor adds to every output; None for none.
    """

    address: int
    parameters: Array
    slopes_address: int
    equilibrium: Callable[[float], float]
    elastic: Callable[[float], float]
    drift_at: int | None = None

    def with_drift(self, found: Response, theta: Array, time_s: Array) -> Response:
        """The response with the drift that the model's own sensor adds."""
        at = self.drift_at
        if at is None:
            return found
        values = {name: y + theta[at] * time_s for name, y in found.outputs.items()}
        for by in (found.by_parameter or {}).values():
            by[:, at] = time_s
        return replace(found, outputs=values)


@dataclass(frozen=True)
class Model(ABC):
    """An actuator model; a subclass is a frozen dataclass whose fields are the model's options.

    Class attributes
    ----------------
    name, title
        Key of the table and heading for people.
    equation
        The law in one line of plain text.
    source
        Paper and equation numbers.
    states
        Names of the internal states; empty for a static model.
    inputs
        Input channels that the model accepts; empty for any.
    outputs
        Output channels that the model can produce; empty for any.
    own_zero
        Whether a parameter already is the output's constant, so that a sensor zero would be the
        same thing twice.
    identified_by
        Parameter name → the excitation that shows it, one sentence.
    note
        What a reader of the parameters must know beside their units; empty for nothing.
    sticks, keeps_place
        Whether it may rest off its equilibrium, held by dry friction, or by what remembers how it
        came there.
    is_linear
        Whether the law is linear with constant coefficients, whatever the input.
    inertia_parameter, stiffness_parameter
        Parameters that are the inertia and the stiffness; None where none of them is.
    force_unit
        Unit of the terms of the equation of motion where no stiffness tells it.
    rest_parameter
        Parameter that says where the position is zero, held where the sensor zero does; or None.
    damping_parameters
        Parameters in which the damping is linear, together.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    equation: ClassVar[str]
    source: ClassVar[str]
    states: ClassVar[tuple[str, ...]] = ()
    inputs: ClassVar[tuple[str, ...]] = ()
    outputs: ClassVar[tuple[str, ...]] = ()
    own_zero: ClassVar[bool] = False
    identified_by: ClassVar[Mapping[str, str]] = {}
    note: ClassVar[str] = ""
    sticks: ClassVar[bool] = False
    keeps_place: ClassVar[bool] = False
    is_linear: ClassVar[bool] = False
    inertia_parameter: ClassVar[str | None] = None
    stiffness_parameter: ClassVar[str | None] = None
    force_unit: ClassVar[str] = "1"
    rest_parameter: ClassVar[str | None] = None
    damping_parameters: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        require_kinds(self)

    @property
    def without_effects(self) -> Model:
        """The model that effects were added to; itself where there are none."""
        return self

    @property
    def label(self) -> str:
        """Name that tells variants apart."""
        return self.name

    def variants(self, input_name: str) -> tuple[Model, ...]:
        """The forms of this model to be compared when softid chooses, for one input channel."""
        del input_name
        return (self,)

    @property
    def start_states(self) -> tuple[str, ...]:
        """States whose initial value matters with these options."""
        return self.states

    @abstractmethod
    def parameters(self) -> ParameterSet:
        """The parameters with generic values, units, bounds, meaning and source."""

    def adapted(self, units: Mapping[str, str], *, inverted: bool = False) -> Model:
        """The model with its units taken from the logs.

        Parameters
        ----------
        units
            Canonical unit of the input under ``"input"`` and of each output under its name.
        inverted
            Whether the outputs fall as the input rises.
        """
        del units, inverted
        return self

    @abstractmethod
    def guess(self, segments: Sequence[Segment], output: str) -> tuple[ParameterSet, ...]:
        """Start values from data alone, most promising first.

        Parameters
        ----------
        segments
            All segments of all fitted logs.
        output
            The output channel to start from.
        """

    def ringing(self, segments: Sequence[Segment], output: str) -> tuple[ParameterSet, ...]:
        """Start values of a lightly damped motion, for a fit that left structure behind.

        Parameters
        ----------
        segments
            All segments of all fitted logs.
        output
            The output channel to start from.
        """
        del segments, output
        return ()

    def hidden_terms(self, damping: float, hidden_s: float) -> Mapping[str, float]:
        """Values of the terms that may be dropped, as large as they may be without being seen.

        Parameters
        ----------
        damping
            Coefficient of the speed.
        hidden_s
            A mode that dies out within this time is not seen.
        """
        del damping, hidden_s
        return {}

    def plainer(self) -> Model | None:
        """The same without a term that may not carry over from log to log; None without one."""
        return None

    def alternatives(self, values: Mapping[str, float]) -> tuple[ParameterSet, ...]:
        """Start values that explain about as much as ``values`` with a term of another form.

        Parameters
        ----------
        values
            Parameter name → value, all of them.
        """
        del values
        return ()

    @abstractmethod
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
        """Simulate one segment.

        Parameters
        ----------
        theta
            Parameter values in the order of `parameters`, shape (K,).
        segment
            Times and input.
        outputs
            Output channels wanted.
        start
            Initial state, shape (S,); None starts at the equilibrium of the first input.
        derivatives
            Whether to return exact derivatives too.
        relative
            Whether ``start`` is a deviation from the equilibrium of the first input, so that the
            derivatives by the parameters move the start along with it.
        plan
            Division of the sampling intervals from `plan`; None makes one.
        """

    def products(
        self,
        theta: Array,
        segment: Segment,
        channel: str,
        *,
        start: Array | None,
        relative: bool,
        plan: Division | None,
        zero: float,
        keep: Keep,
    ) -> Products | None:
        """Summed products of residual and derivatives, without a Jacobian; None if it needs one.

        Parameters
        ----------
        theta, segment, start, relative, plan
            As in `response`.
        channel
            Output channel whose measured values the segment holds.
        zero
            Its sensor zero.
        keep
            Which of the columns to keep.
        """
        del theta, segment, channel, start, relative, plan, zero, keep
        return None

    def plan(self, theta: Array, segment: Segment) -> Division | None:
        """Division of the sampling intervals that accuracy calls for; None for a static model.

        An optimiser holds the plan still while it searches: the cost would jump where a count
        changes.
        """
        del theta, segment
        return None

    @abstractmethod
    def static_output(self, theta: Array, input_values: Array, output: str) -> Array:
        """Output at rest, without sensor zero, for inputs of shape (m,); NaN where undefined."""

    def motion_law(self, theta: Array) -> Law | None:
        """The coefficients of a law of motion affine in its state; None when it is not."""
        del theta
        return None

    def motion_term(self, theta: Array) -> MotionTerm | None:
        """The law of motion when it is not affine in its state; None when it is."""
        del theta
        return None

    def observed(self, x: Array, output: str) -> tuple[Array, Array]:
        """An output, and its slope by the position, at positions of shape (n,)."""
        del output
        return x, np.ones_like(x)

    def derived(
        self, values: Mapping[str, float], input_range: tuple[float, float]
    ) -> dict[str, tuple[float, str]]:
        """Quantities that people quote, computed from the parameters: name → (value, unit).

        Parameters
        ----------
        values
            Parameter name → value.
        input_range
            Smallest and largest input that was fitted.
        """
        del values, input_range
        return {}

    def speeds(self, values: Mapping[str, float], u: float) -> Speeds:
        """How fast the motion is at one input; nothing of a model that has none.

        Parameters
        ----------
        values
            Parameter name → value.
        u
            The input.
        """
        del values, u
        return Speeds()

    def limit(
        self, theta: Array, period_s: float, input_range: tuple[float, float], longest_s: float
    ) -> tuple[Model, str] | None:
        """The simpler model to continue with when a term cannot be seen, and why.

        Parameters
        ----------
        theta
            Fitted values, shape (K,).
        period_s
            Median sampling interval of the logs.
        input_range
            Smallest and largest input that was fitted.
        longest_s
            Length of the longest log.
        """
        del theta, period_s, input_range, longest_s
        return None

    def cautions(
        self, values: Mapping[str, float], known: Sequence[str], covariance: Array | None
    ) -> tuple[Issue, ...]:
        """What to know about a fit of this model beyond the verdict on each parameter.

        Parameters
        ----------
        values
            Parameter name → fitted value.
        known
            Names of the free parameters that have standard errors.
        covariance
            Their covariance, shape (K, K), or None.
        """
        del values, known, covariance
        return ()

    def spec(self) -> ModelSpec:
        """Name and options, enough to build the model again."""
        return ModelSpec(self.name, {f.name: getattr(self, f.name) for f in fields(self)})
