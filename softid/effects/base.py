"""What an effect is: a named physical cause with a law, parameters, and words for people."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar, Literal

import numpy as np
import numpy.typing as npt

from softid.effects.scale import Scale
from softid.effects.wording import Wording
from softid.parameters import ParameterSet

Array = npt.NDArray[np.float64]
Stage = Literal["input", "state", "output"]
Step = Callable[[float, float, float, float, float, Any, Any], None]

STAGES: tuple[Stage, ...] = ("input", "state", "output")

LEAST_AMPLITUDE = 1e-6
"""Lower bound of an amplitude on the logarithmic scale, which has no zero, as a share of a size
that would be felt throughout: so little is lost in any noise."""

MOST_LOST = 0.9
"""Share of a stiffness, an inertia or a gain that an effect may take away at most: with a tenth
left the law keeps its sign."""

SHARPEST_BEND = 3e-3
"""Lower bound of the speed or distance over which a law turns from one branch to the other, as a
share of the largest: a motion passes so little within a few samples, and a log sees a jump."""


@dataclass(frozen=True)
class Effect(ABC):
    """A physical effect; a subclass of one of the three stages is one file and one table line.

    Words, which people read
    ------------------------
    name, title
        Name in the catalogue and heading for people.
    variant
        Empty, or what tells a richer form of the same cause from its plain form.
    law
        The law in one line of plain text, with the names of the parameters.
    meaning
        What happens physically, in one plain sentence.
    signature
        What it leaves in the residual of a model that ignores it.
    neighbours
        Effects that it can be confused with; those that name it are added by `confusable_with`.
    remedy
        What to do in hardware, or an empty text when there is nothing.
    shown_by
        The experiment that shows it.
    source
        Where the law comes from.

    Law, which a fit needs
    ----------------------
    stage
        Where it acts: on the input, in the equation of motion, or on the output; from the base
        class.
    amplitude
        Parameter at whose value zero the effect vanishes; None where it vanishes only as a limit
        leaves the range, as `sensor_clipping`.
    changes_sign
        Set it where the amplitude may have either sign, as a drift. A start is then kept whichever
        way the residual asks for, and no cause is named while its interval holds zero.
    sticks
        Set it for a force that holds the actuator off its equilibrium at rest, as
        `coulomb_friction` does. A log that begins at rest then has a free position at its start.
    counts_position
        Set it where the law goes by the position, as `ageing` does, so that it matters where that
        is zero. The rest of the model is then fitted, too, for which a sensor zero stands else.
    readings
        Parameters that are positions or readings, as the place ``xw`` of a `contact`. They are
        stored without the sensor zero of a log and told with it, and their bounds move with it.
    mutes
        Set it where the reading stands still, noise and all, at the ends of its range, as
        `sensor_clipping` has it. Other effects then act before it, and samples that stand there say
        nothing of the noise.
    is_linear
        Set it where the law is linear in the input or the reading, as that of a `delay`. Beside no
        other kind a linear model stays one, in which operations commute.
    begins_with_log
        Set it where the law begins anew with every log, as `softening` by use does. Where it fails
        on what is held out, the report says that this may have begun otherwise.

    Hints for the search, all of which may be left out
    --------------------------------------------------
    essential
        Parameters at either of whose bounds the law is another effect's or none, as the time of a
        `creep` that is over at once or never begins. A law that ends there is not chosen, or not
        named.
    ceilings
        Parameters for which that holds at the upper bound alone, as the speed over which
        `coulomb_friction` turns: if it is large the friction is a damping.
    floors
        The same at the lower bound, as the damping of a `line_resonance`: nothing rings for ever.
    plain_at
        Parameter of a richer form and the value at which its law is the plain one, as a ``ratio``
        of 1. The plain form is told where the interval of the parameter holds that value.
    draws
        Effects whose law this one can draw, as a `static_curve` does any spring. A chain with both
        names neither.
    slowness
        How many times the time constant of a lag its amplitude is, where both are as late: 3 for
        `valve_flow`. Where a search lets it take the place of a slow pole of the motion, it begins
        at so many times that.
    has_one_form
        Set it where the law is exact, as that of a `delay`. A small cause beside one that it may be
        confused with is taken for a correction of the form of the larger one, unless either is
        exact.
    """

    # Words
    name: ClassVar[str]
    title: ClassVar[str]
    variant: ClassVar[str] = ""
    law: ClassVar[str]
    meaning: ClassVar[str]
    signature: ClassVar[str]
    neighbours: ClassVar[tuple[str, ...]] = ()
    remedy: ClassVar[str] = ""
    shown_by: ClassVar[str]
    source: ClassVar[str]

    # Law
    stage: ClassVar[Stage]
    amplitude: ClassVar[str | None]
    changes_sign: ClassVar[bool] = False
    sticks: ClassVar[bool] = False
    counts_position: ClassVar[bool] = False
    readings: ClassVar[tuple[str, ...]] = ()
    mutes: ClassVar[bool] = False
    is_linear: ClassVar[bool] = False
    begins_with_log: ClassVar[bool] = False

    # Hints for the search
    essential: ClassVar[tuple[str, ...]] = ()
    ceilings: ClassVar[tuple[str, ...]] = ()
    floors: ClassVar[tuple[str, ...]] = ()
    plain_at: ClassVar[tuple[str, float] | None] = None
    draws: ClassVar[tuple[str, ...]] = ()
    slowness: ClassVar[float] = 1.0
    has_one_form: ClassVar[bool] = False

    @property
    def key(self) -> str:
        """Name in the table: that of the catalogue, with the variant if there is one."""
        return f"{self.name}.{self.variant}" if self.variant else self.name

    def simpler(self, values: Mapping[str, float]) -> tuple[str, Mapping[str, float]] | None:
        """Key and values of the simpler effect that the law is like at some values; None for none.

        Parameters
        ----------
        values
            Parameter → value.
        """
        del values
        return None

    def differs_within(self, values: Mapping[str, float]) -> float:
        """Time in s on which it still differs from `simpler` or its plain form; infinite if longer.

        Parameters
        ----------
        values
            Parameter → value.
        """
        del values
        return np.inf

    def alike_within(self, values: Mapping[str, float]) -> float:
        """Time in s within which it has made the noise of neighbouring samples alike; 0 for none.

        Parameters
        ----------
        values
            Parameter → value.
        """
        del values
        return 0.0

    def first_order(self, values: Mapping[str, float]) -> str | None:
        """Key of the lag that stands for a law of second order that does not ring; else None.

        Parameters
        ----------
        values
            Parameter → value.
        """
        del values
        return None

    def law_at(self, scale: Scale) -> str:
        """The law with the sizes that it takes from the logs as numbers.

        Parameters
        ----------
        scale
            Sizes of the logs and of the base model.
        """
        del scale
        return self.law

    def wording(self, values: Mapping[str, float]) -> Wording:
        """In plain words what the law is at some values.

        Parameters
        ----------
        values
            Parameter → value.
        """
        del values
        return Wording(self.title, self.meaning, self.remedy)

    def takes_time(self, scale: Scale) -> bool:
        """Whether it makes the response late, as an inertia does, outside the motion itself."""
        if self.stage == "state" or self.amplitude is None:
            return False
        return self.parameters(scale)[self.amplitude].unit == "s"

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """Parameters that must all be zero for the effect to vanish; none without an amplitude."""
        return (self.amplitude,) if self.amplitude is not None else ()

    @abstractmethod
    def parameters(self, scale: Scale) -> ParameterSet:
        """The parameters with moderate values, units, bounds and meaning.

        Parameters
        ----------
        scale
            Sizes of the logs and of the base model.
        """

    @abstractmethod
    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Complete parameter values from which a search begins, spread over the plausible range.

        Parameters
        ----------
        scale
            Sizes of the logs and of the base model.
        """


@dataclass(frozen=True)
class InputEffect(Effect):
    """An effect between the recorded input and the input that drives the actuator."""

    stage: ClassVar[Stage] = "input"

    @abstractmethod
    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The input that arrives, at the same times.

        Parameters
        ----------
        eta
            Parameter values in the order of `parameters`, shape (H,).
        time_s
            Strictly increasing times since the log's start, finer than the samples, shape (m,).
        u
            Input, straight between these times and constant before the first, shape (m,).
        scale
            Sizes of the logs and of the base model.
        """

    def bends_in_s(self, eta: Array) -> float:
        """Shortest time, in s, in which what arrives bends between two corners of the input.

        Parameters
        ----------
        eta
            As in `apply`.

        Returns
        -------
        float
            0, unless an effect says more, for a corner that may be put anywhere.
        """
        del eta
        return 0.0


@dataclass(frozen=True)
class StateEffect(Effect):
    """An effect in the equation of motion.

    Class attributes
    ----------------
    has_state
        Whether it has a state z of its own.
    follows_position
        Whether z rests at the position instead of at zero.
    keeps_place
        Whether a log may begin at rest with any z, for it remembers how the actuator came there.
    """

    stage: ClassVar[Stage] = "state"
    has_state: ClassVar[bool] = False
    follows_position: ClassVar[bool] = False
    keeps_place: ClassVar[bool] = False

    @staticmethod
    @abstractmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Add the effect's part to the equation of motion; compiled, so numbers and `math` only.

        Parameters
        ----------
        x, v, z, u, t
            Position, velocity, own state, input and time since the start of the log.
        eta
            The parameters in their order, then `constants`.
        out
            Zeros; the places are named in `softid.kernels.terms`: FORCE, RATE, INERTIA, DAMPING,
            STIFFNESS and SHIFT.
        """

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """Numbers that the step needs besides the parameters.

        Parameters
        ----------
        scale
            Sizes of the logs and of the base model.
        """
        del scale
        return ()

    def rate(self, eta: Array, scale: Scale) -> float:
        """Fastest rate, in 1/s, that the integrator's steps must resolve besides the model's own.

        Parameters
        ----------
        eta
            Parameter values in the order of `parameters`, shape (H,).
        scale
            Sizes of the logs and of the base model.
        """
        del eta, scale
        return 0.0

    def address(self) -> int:
        """Address of the compiled step."""
        return int(_compiled(type(self).step).address)


@dataclass(frozen=True)
class OutputEffect(Effect):
    """An effect between the motion and the output; ``before_sensor`` if the actuator has it."""

    stage: ClassVar[Stage] = "output"
    before_sensor: ClassVar[bool] = False

    @abstractmethod
    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """What is recorded, at the same times.

        Parameters
        ----------
        eta
            Parameter values in the order of `parameters`, shape (H,).
        time_s
            Times of the samples since the start of the log, shape (n,).
        y
            True output in the channel's unit, without sensor zero, shape (n,).
        scale
            Sizes of the logs and of the base model.
        """

    def recorded(self, eta: Array, time_s: Array, y: Array, u: Array, scale: Scale) -> Array:
        """What is recorded where the sensor may also answer to the input.

        Parameters
        ----------
        eta, time_s, y, scale
            As in `apply`.
        u
            The recorded input, shape (n,).
        """
        del u
        return self.apply(eta, time_s, y, scale)


@cache
def _compiled(step: Step) -> Any:
    """Compile once a process; numba keeps the result on disk."""
    from softid.kernels.terms import compile_term

    return compile_term(step)
