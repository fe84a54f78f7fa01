"""A model with effects added, which is a model again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import STAGES, Effect, InputEffect, OutputEffect, StateEffect
from softid.effects.extension.motion import simulate_motion
from softid.effects.extension.rest import rest
from softid.effects.extension.stage_input import arriving_input
from softid.effects.extension.terms import moved_at
from softid.effects.scale import Scale
from softid.kernels.step_counts import MAX_PHASE_PER_STEP, MAX_SUBSTEPS
from softid.models.base import Model, MotionTerm, Response
from softid.models.division import Division, divide, divided
from softid.models.second_order import Law
from softid.models.time_scales import Speeds
from softid.parameters import ParameterSet
from softid.results import ModelSpec
from softid.segment import Segment

Array = npt.NDArray[np.float64]

DIFFERENCE = 1e-6
"""Relative step by which parameters of input and output effects are moved to differentiate."""

ITERATED = 30.0
"""Factor by which the step that differentiates is larger where the motion is found by iterations,
whose ends differ."""


@dataclass(frozen=True)
class ExtendedModel(Model):
    """A model whose input, motion and output are changed by effects.

    The input effects act one after the other on the recorded input, the state effects together in
    the equation of motion, and the output effects one after the other on the first output.

    Attributes
    ----------
    model
        The model that is extended.
    effects
        Its effects, in the order in which they act.
    scale
        Sizes that their bounds and knots go by.
    """

    model: Model
    effects: tuple[Effect, ...]
    scale: Scale

    name: ClassVar[str] = "extended"
    title: ClassVar[str] = "A model with effects"
    equation: ClassVar[str] = ""
    source: ClassVar[str] = ""

    def __post_init__(self) -> None:
        base = self.model
        order = sorted(self.effects, key=lambda effect: STAGES.index(effect.stage))
        inherited = {
            "effects": tuple(order),
            "name": base.name,
            "title": base.title,
            "equation": "; ".join((base.equation, *(effect.law for effect in order))),
            "source": base.source,
            "states": (*base.states, *self._followers),
            "inputs": base.inputs,
            "outputs": base.outputs,
            "own_zero": base.own_zero,
            "sticks": base.sticks or any(effect.sticks for effect in self.effects),
            "keeps_place": any(effect.keeps_place for effect in self._state_effects),
            "is_linear": base.is_linear and all(effect.is_linear for effect in order),
            "inertia_parameter": base.inertia_parameter,
            "stiffness_parameter": base.stiffness_parameter,
            "rest_parameter": base.rest_parameter,
            "damping_parameters": base.damping_parameters,
            "identified_by": dict(base.identified_by)
            | {
                extended_name(effect, parameter): effect.shown_by
                for effect in order
                for parameter in effect.parameters(self.scale)
            },
        }
        for key, value in inherited.items():
            object.__setattr__(self, key, value)

    @property
    def label(self) -> str:
        """Names of the model and of its effects."""
        return " + ".join((self.model.label, *(effect.key for effect in self.effects)))

    @property
    def without_effects(self) -> Model:
        """The model that is extended."""
        return self.model

    @property
    def start_states(self) -> tuple[str, ...]:
        """Those of the model, and by how much an effect's own state lies off the position.

        One that rests at zero starts there.
        """
        return (*self.model.start_states, *self._followers)

    def parameters(self) -> ParameterSet:
        """The model's parameters, then those of each effect as ``effect_parameter``."""
        added = [
            replace(p, name=extended_name(effect, p.name))
            for effect in self.effects
            for p in effect.parameters(self.scale).values()
        ]
        return ParameterSet((*self.model.parameters().values(), *added))

    def adapted(self, units: Mapping[str, str], *, inverted: bool = False) -> ExtendedModel:
        """The model, and the scale of its effects, with the units of the logs."""
        base = self.model.adapted(units, inverted=inverted)
        scale = replace(
            self.scale,
            u_unit=units["input"],
            x_unit=str(getattr(base, "x_unit", self.scale.x_unit)),
            y_unit=next(unit for name, unit in units.items() if name != "input"),
        )
        return replace(self, model=base, scale=scale)

    def guess(self, segments: Sequence[Segment], output: str) -> tuple[ParameterSet, ...]:
        """The model's own starts with the effects at moderate size."""
        declared = self.parameters()
        return tuple(
            declared.with_values({name: start[name].value for name in start.free})
            for start in self.model.guess(segments, output)
        )

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
        """Simulate one segment; see `Model.response`."""
        fixed_plan = plan or self.plan(theta, segment)
        first = outputs[0]

        def moved(theta: Array, *, derivatives: bool) -> Response:
            if self._split[2] == self._split[0]:  # the model's own kernels are faster
                return self.model.response(
                    theta[: self._split[0]],
                    segment,
                    outputs,
                    start=start,
                    derivatives=derivatives,
                    relative=relative,
                    plan=fixed_plan,
                )
            first_input, stage_input = arriving_input(
                self._on_input(theta), segment, fixed_plan, self.scale
            )
            return simulate_motion(
                self.model,
                self._state_effects,
                self.scale,
                theta[: self._split[0]],
                theta[self._split[1] : self._split[2]],
                segment,
                outputs,
                first_input=first_input,
                stage_input=stage_input,
                plan=fixed_plan,
                start=start,
                relative=relative,
                derivatives=derivatives,
            )

        motion = moved(theta, derivatives=derivatives)
        recorded = self._recorded(theta, segment, motion.outputs[first])
        values = dict(motion.outputs) | {first: recorded}
        if motion.by_parameter is None or motion.by_state is None:
            return Response(values, None, None, motion.start, motion.x, motion.v)
        by_parameter, by_state = {}, {}
        for name in outputs:
            by, by_start = motion.by_parameter[name], motion.by_state[name]
            if name == first:
                by = self._carried(theta, segment, motion.outputs[first], by)
                by_start = self._carried(theta, segment, motion.outputs[first], by_start)
            by_parameter[name] = self._in_order(by)
            by_state[name] = by_start
        iterated = self._state_effects or self.model.motion_law(theta[: self._split[0]]) is None
        for at in range(self._split[0], self._split[1]):
            h = self._steps[at] * (ITERATED if iterated else 1.0)
            there = moved(moved_at(theta, at, h), derivatives=False).outputs
            for name in outputs:
                y = self._recorded(theta, segment, there[name]) if name == first else there[name]
                by_parameter[name][:, at] = (y - values[name]) / h
        for at in range(self._split[2], theta.size):
            h = self._steps[at]
            y = self._recorded(moved_at(theta, at, h), segment, motion.outputs[first])
            by_parameter[first][:, at] = (y - recorded) / h
        return Response(values, by_parameter, by_state, motion.start, motion.x, motion.v)

    @cached_property
    def _state_effects(self) -> tuple[StateEffect, ...]:
        return tuple(e for e in self.effects if isinstance(e, StateEffect))

    @property
    def _followers(self) -> tuple[str, ...]:
        """Effects whose own state rests at the position, which it may not have reached."""
        return tuple(e.name for e in self._state_effects if e.has_state and e.follows_position)

    @cached_property
    def _widths(self) -> tuple[int, ...]:
        """Number of parameters of each effect."""
        return tuple(len(effect.parameters(self.scale)) for effect in self.effects)

    @cached_property
    def _split(self) -> tuple[int, int, int]:
        """Where the parameters of input, state and output effects begin."""
        counts = [len(self.model.parameters())]
        for stage in STAGES[:2]:
            widths = zip(self.effects, self._widths, strict=True)
            counts.append(sum(width for effect, width in widths if effect.stage == stage))
        first, second, third = np.cumsum(counts).tolist()
        return first, second, third

    @cached_property
    def _steps(self) -> Array:
        """Steps by which the parameters are moved to differentiate, shape (K,)."""
        declared = self.parameters().values()
        steps: Array = np.array([DIFFERENCE * p.usual_size for p in declared])
        return steps

    def _own(self, theta: Array) -> Iterator[tuple[Effect, Array]]:
        """Every effect with its parameters."""
        at = self._split[0]
        for effect, count in zip(self.effects, self._widths, strict=True):
            yield effect, theta[at : at + count]
            at += count

    def _on_input(self, theta: Array) -> list[tuple[InputEffect, Array]]:
        """The input effects with their parameters."""
        return [(e, eta) for e, eta in self._own(theta) if isinstance(e, InputEffect)]

    def _recorded(self, theta: Array, segment: Segment, y: Array) -> Array:
        """What the sensor makes of the first output."""
        since_s = segment.since_s
        for effect, eta in self._own(theta):
            if isinstance(effect, OutputEffect):
                y = effect.recorded(eta, since_s, y, segment.input, self.scale)
        return y

    def _carried(self, theta: Array, segment: Segment, y: Array, by: Array) -> Array:
        """Derivatives of the first output, shape (n, C), as the sensor passes them on."""
        if self._split[2] == theta.size:
            return by
        before = self._recorded(theta, segment, y)
        passed = np.empty_like(by)
        for column in range(by.shape[1]):
            size = float(np.max(np.abs(by[:, column]), initial=0.0))
            h = DIFFERENCE * self.scale.y_span / size if size > 0.0 else 1.0
            passed[:, column] = (self._recorded(theta, segment, y + h * by[:, column]) - before) / h
        return passed

    def _in_order(self, by: Array) -> Array:
        """Columns of base and state parameters at their places among all parameters."""
        base, state, output = self._split
        whole = np.zeros((by.shape[0], self._split[0] + sum(self._widths)))
        whole[:, :base] = by[:, :base]
        whole[:, state:output] = by[:, base:]
        return whole

    def plan(self, theta: Array, segment: Segment) -> Division:
        """Division of the sampling intervals; see `Model.plan`.

        The arriving input may change faster than the recorded one, so both decide, and so does the
        fastest of the state effects.
        """
        base = theta[: self._split[0]]
        law = self.model.motion_law(base)
        u, bends_in_s = segment.input, np.inf
        on_input = self._on_input(theta)
        for effect, eta in on_input:
            u = effect.apply(eta, segment.since_s, u, self.scale)
            bends_in_s = min(bends_in_s, effect.bends_in_s(eta))
        counts = np.ones(max(u.size - 1, 0), np.intp)
        for values in (segment.input, u) if on_input else (u,):
            if law is not None:
                found = divide(law, segment.time_s, values, implicit_only=True)
                counts = np.maximum(counts, found.counts)
            else:
                own = self.model.plan(base, replace(segment, input=values))
                counts = counts if own is None else np.maximum(counts, own.counts)
        wanted = np.ceil(np.diff(segment.time_s) * self._rate(theta) / MAX_PHASE_PER_STEP)
        counts = np.maximum(counts, np.clip(wanted, 1, MAX_SUBSTEPS).astype(np.intp))
        return divided(segment.time_s, segment.input, counts, bends_in_s=bends_in_s)

    def _rate(self, theta: Array) -> float:
        """Fastest rate that a state effect calls for, in 1/s; 0 without one."""
        rates = [
            effect.rate(eta, self.scale)
            for effect, eta in self._own(theta)
            if isinstance(effect, StateEffect)
        ]
        return max((rate for rate in rates if np.isfinite(rate)), default=0.0)

    def static_output(self, theta: Array, input_values: Array, output: str) -> Array:
        """Output at rest, without what the sensor adds; NaN where there is no rest."""
        base = theta[: self._split[0]]
        eta = theta[self._split[1] : self._split[2]]
        u = np.asarray(input_values, np.float64)
        for effect, own in self._on_input(theta):
            u = np.array([self._settled(effect, own, float(level)) for level in u])
        if not self._state_effects:
            return self.model.static_output(base, u, output)
        x = [rest(self.model, self._state_effects, self.scale, base, eta, float(v)) for v in u]
        return self.model.observed(np.array(x), output)[0]

    def _settled(self, effect: InputEffect, eta: Array, level: float) -> float:
        """What arrives when the input has long been held."""
        time_s = np.linspace(0.0, 100.0 * max(self.scale.motion_s, self.scale.period_s), 50)
        return float(effect.apply(eta, time_s, np.full(time_s.size, level), self.scale)[-1])

    def motion_law(self, theta: Array) -> Law | None:
        """That of the model without its effects."""
        return self.model.motion_law(theta[: self._split[0]])

    def motion_term(self, theta: Array) -> MotionTerm | None:
        """That of the model without its effects."""
        return self.model.motion_term(theta[: self._split[0]])

    def alternatives(self, values: Mapping[str, float]) -> tuple[ParameterSet, ...]:
        """Those of the model without its effects, which keep their values."""
        declared = self.parameters()
        own = self.model.parameters()
        kept = {name: values[name] for name in declared.names if name not in own}
        return tuple(
            declared.with_values({**other.values_dict(), **kept})
            for other in self.model.alternatives(values)
        )

    def derived(
        self, values: Mapping[str, float], input_range: tuple[float, float]
    ) -> dict[str, tuple[float, str]]:
        """Those of the model without its effects."""
        return self.model.derived(self._of_model(values), input_range)

    def speeds(self, values: Mapping[str, float], u: float) -> Speeds:
        """Those of the model without its effects."""
        return self.model.speeds(self._of_model(values), u)

    def _of_model(self, values: Mapping[str, float]) -> dict[str, float]:
        return {name: values[name] for name in self.model.parameters().names}

    def limit(
        self, theta: Array, period_s: float, input_range: tuple[float, float], longest_s: float
    ) -> tuple[Model, str] | None:
        """The limit of the model with the same effects."""
        found = self.model.limit(theta[: self._split[0]], period_s, input_range, longest_s)
        return None if found is None else (replace(self, model=found[0]), found[1])

    def spec(self) -> ModelSpec:
        """Name and options of the model, names of the effects, and the scale."""
        base = self.model.spec()
        names = tuple(effect.key for effect in self.effects)
        return ModelSpec(base.name, base.options, names, asdict(self.scale))


def extended_name(effect: Effect, parameter: str) -> str:
    """Name of an effect's parameter in an extended model."""
    return f"{effect.name}_{parameter}"


def own_values(effect: Effect, values: Mapping[str, float]) -> dict[str, float]:
    """Values of an effect's parameters among those of an extended model, by their own names."""
    prefix = extended_name(effect, "")
    return {
        name.removeprefix(prefix): value
        for name, value in values.items()
        if belongs_to(effect, name)
    }


def belongs_to(effect: Effect, parameter: str) -> bool:
    """Whether a parameter of an extended model is one of an effect's.

    No effect's name begins with that of another and an underscore; registering sees to it.
    """
    return parameter.startswith(extended_name(effect, ""))
