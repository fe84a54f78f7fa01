"""What a model is: declared parameters, start values from data, and a response with derivatives."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.log import Segment
from softid.parameters import ParameterSet
from softid.results import ModelSpec

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
        Output channel → ∂y/∂(initial state), shape (n, S); None if not asked.
    start
        Initial state used, shape (S,).
    """

    outputs: Mapping[str, Array]
    by_parameter: Mapping[str, Array] | None
    by_state: Mapping[str, Array] | None
    start: Array


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
    identified_by
        Parameter name → the excitation that shows it, one sentence.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    equation: ClassVar[str]
    source: ClassVar[str]
    states: ClassVar[tuple[str, ...]] = ()
    inputs: ClassVar[tuple[str, ...]] = ()
    outputs: ClassVar[tuple[str, ...]] = ()
    identified_by: ClassVar[Mapping[str, str]] = {}

    @abstractmethod
    def parameters(self) -> ParameterSet:
        """The parameters with generic values, units, bounds, meaning and source."""

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

    @abstractmethod
    def response(
        self,
        theta: Array,
        segment: Segment,
        outputs: Sequence[str],
        *,
        start: Array | None,
        derivatives: bool,
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
        """

    def derived(self, values: Mapping[str, float]) -> dict[str, tuple[float, str]]:
        """Quantities that people quote, computed from the parameters: name → (value, unit)."""
        del values
        return {}

    def limits(self) -> tuple[Model, ...]:
        """Simpler models that this one becomes when a term cannot be seen, nearest first."""
        return ()

    def spec(self) -> ModelSpec:
        """Name and options, enough to build the model again."""
        return ModelSpec(self.name, {f.name: getattr(self, f.name) for f in fields(self)})
