"""Rivals of a cause that follow the same law or explain as much, in the catalogue or not."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.base.intersample_selection import SINGLE_DELAYS
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.usual_law import usual_law
from softid.diagnosis.residual.motion import turns_round
from softid.diagnosis.search.forward_selection import MAX_LINKS, Chain, Link
from softid.diagnosis.verdict.chain_consistency import may_hold_more
from softid.diagnosis.verdict.equivalence import PRESLIDING, EquivalenceClass
from softid.diagnosis.verdict.laws_alike import (
    BEFORE_THE_LOAD,
    HELD_INPUT,
    LEAD_AND_RELAXATION,
    ONE_WAY,
    OWN_DAMPING,
    POLE_AND_ZERO,
    STICTION,
    THINNING,
)
from softid.diagnosis.verdict.replacements import with_replacements
from softid.diagnosis_results import Cause, Remainder
from softid.effects.scale import Scale
from softid.intersample import HELD

GIVES_WAY = 0.02
"""Friction gives way by this share of the range, at most, before it slides."""

DRY = 0.1
"""Dry friction has come up at this share of the largest speed."""

FORCES = ("force", "torque")
"""Outputs that are nothing as long as the actuator does not touch its load."""

STICTION_ALONE = 9.0
"""Excess of a friction at rest over that in motion, of which less than a tenth is left then."""

OWN_TIME = 0.2
"""An actuator keeps no time of its own when it is below this share of the lag's."""

LASTING_RATIO = 3.0
"""A creep or a relaxation goes on for so many times as long as the motion itself, at least; what is
over sooner may be any other pole and zero."""

ABOUT = 0.1
"""A time is half an interval where that lies no farther outside the interval of its error: what
else is in the model takes or gives a little of it."""


def with_rivals(
    chain: Chain,
    causes: Sequence[Cause],
    forms: Sequence[str],
    is_named: Sequence[bool],
    base: BaseFit,
    remainder: Remainder,
) -> list[Link]:
    """The links of a chain with rivals that follow the same law, or explain as much in its place.

    Parameters
    ----------
    chain
        The chain.
    causes
        The parameters of its links.
    forms
        Keys of the forms as which they are told.
    is_named
        Which of them may be named.
    base
        What the chain begins with.
    remainder
        What it leaves.
    """
    links = [
        with_law_rivals(link, cause, form, chain.final, base.scale)
        for link, cause, form in zip(chain.links, causes, forms, strict=True)
    ]
    is_doubtful = sum(is_named) == MAX_LINKS or may_hold_more(remainder)
    return with_replacements(links, is_named, chain.final, base, is_doubtful=is_doubtful)


def with_law_rivals(link: Link, cause: Cause, key: str, final: Candidate, scale: Scale) -> Link:
    r"""The link with rivals that no log tells from its cause, for they follow its law.

    Dry friction that gives way a little before it slides follows Dahl's law, which is that of the
    hysteresis: only the distance tells a guide that rubs from a material with inner friction. With
    M = N = 0, a lag whose time goes with the pressure inside, τ(pa) ṗa + pa = p, is x = pa/Q with
    τ(Qx) Q ẋ + Q x = p: a damping that goes with the position. In a linear model a creep is one
    pole and one zero, as is the lag of a gauge or the lead of a sensor; a relaxation is one in any,
    as the lead of a sensor is. An input that is held until its next sample is late by half an
    interval. Fc tanh(v/vs) with a large vs is a damping that falls with the speed, and so is one
    whose speed has one sign throughout.

    Parameters
    ----------
    link, cause
        A link and its parameters.
    key
        The form of its effect as which it is told.
    final
        The model with all causes.
    scale
        Sizes of the base fit.
    """
    told = _Told(cause, key, final, scale)
    alike = next((alike for alike, holds in LAWS_BY_NUMBERS if holds(told)), None)
    others = () if alike is None else (key for key in alike.effects if key != cause.effect)
    return replace(link, rivals=tuple(dict.fromkeys((*link.rivals, *others))))


@dataclass(frozen=True, eq=False)
class _Told:
    """A cause as which a link is told, the form of its effect, the model and its sizes."""

    cause: Cause
    form: str
    final: Candidate
    scale: Scale

    def value(self, name: str) -> float:
        """A parameter of the cause; without it NaN, with which no comparison holds."""
        values = {p.name: p.value for p in self.cause.parameters}
        return values.get(f"{self.cause.effect}_{name}", np.nan)


def _gives_way_soon(told: _Told) -> bool:
    is_hysteresis = told.cause.effect == "hysteresis"
    return is_hysteresis and told.value("zs") <= GIVES_WAY * told.scale.x_span


def _leaves_no_own_time(told: _Told) -> bool:
    is_uneven = told.form == "pneumatic_lag.level"
    return is_uneven and own_time(told.final) < OWN_TIME * told.value("tau")


def _never_turns_round(told: _Told) -> bool:
    return told.cause.effect == "coulomb_friction" and not turns_round(told.final)


def _clips_a_force_at_rest(told: _Told) -> bool:
    return told.form == "sensor_clipping.lower" and told.final.problem.outputs[0] in FORCES


def _holds_at_rest_alone(told: _Told) -> bool:
    return told.value("beta") > STICTION_ALONE


def _comes_up_slowly(told: _Told) -> bool:
    is_friction = told.cause.effect == "coulomb_friction"
    return is_friction and told.value("vs") > DRY * told.scale.v_max


def _may_be_held(told: _Told) -> bool:
    """Whether what makes an input late that goes on between its samples is half of an interval."""
    if told.form not in SINGLE_DELAYS:
        return False
    log, tau = told.final.problem.logs[0], told.cause.parameters[0]
    if tau.ci95 is None or log.effective_intersample in HELD:
        return False
    half_s = 0.5 * log.as_recorded.period_s
    return (1.0 - ABOUT) * tau.ci95[0] <= half_s <= (1.0 + ABOUT) * tau.ci95[1]


def _creeps_while_it_moves(told: _Told) -> bool:
    is_one_pole = told.cause.effect == "creep" and told.final.problem.model.is_linear
    return is_one_pole and told.value("tau") < LASTING_RATIO * told.scale.motion_s


def _relaxes_while_it_moves(told: _Told) -> bool:
    is_relaxation = told.cause.effect == "relaxation"
    return is_relaxation and told.value("tau") < LASTING_RATIO * told.scale.motion_s


LAWS_BY_NUMBERS: tuple[tuple[EquivalenceClass, Callable[[_Told], bool]], ...] = (
    (PRESLIDING, _gives_way_soon),
    (OWN_DAMPING, _leaves_no_own_time),
    (ONE_WAY, _never_turns_round),
    (BEFORE_THE_LOAD, _clips_a_force_at_rest),
    (STICTION, _holds_at_rest_alone),
    (THINNING, _comes_up_slowly),
    (HELD_INPUT, _may_be_held),
    (POLE_AND_ZERO, _creeps_while_it_moves),
    (LEAD_AND_RELAXATION, _relaxes_while_it_moves),
)
"""Causes alike, and where the numbers of one of them say so. The first that holds counts: friction
that nobody has seen turn round has no speed at which it comes up."""


def own_time(final: Candidate) -> float:
    """Time constant that a law of motion keeps beside its effects, damping over stiffness, in s.

    Parameters
    ----------
    final
        An extended model; the time is infinite where there is no spring.
    """
    law = usual_law(final)
    return law.damping_s if law is not None and law.stiffness > 0.0 else np.inf
