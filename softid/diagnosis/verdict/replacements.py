"""Named causes that others are refitted in the place of, before they are believed.

Some causes of the catalogue follow what a law in no catalogue does, or two causes together do. Each
of these is refitted in their place, with all other causes kept; and each law in no catalogue alone
in the place of all, with what is described kept and without, or beside the first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.backward_revision import refit_with_fewer
from softid.diagnosis.search.bic_ranking import Ranked, rank_either_way
from softid.diagnosis.search.contenders import INDISTINCT
from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis.verdict.equivalence import CHANGING, DRIFTS
from softid.diagnosis.verdict.refitted_laws import PROMISING_RATIO, refitted_with, standing_of
from softid.diagnosis.verdict.unlisted_curves import FineCurve, FreeSpring, PowerSpring
from softid.diagnosis.verdict.unlisted_drifts import (
    DampingDrift,
    LoadDrift,
    PressureDrift,
    PressureGainDrift,
    RecoveringSoftening,
    SettlingGain,
    SettlingPressure,
    SettlingStiffness,
)
from softid.diagnosis.verdict.unlisted_laws import (
    UNLISTED_LAWS,
    BentReading,
    InputPlay,
    OutputPlay,
    suiting,
)
from softid.diagnosis.verdict.unlisted_memories import (
    OwnBranches,
    PositionHysteresis,
    ReadingHysteresis,
    SecondCreep,
    SecondHysteresis,
)
from softid.diagnosis.verdict.unlisted_pneumatics import InputLimit, RateLimit, ReliefLeak
from softid.diagnosis.verdict.unlisted_positions import PositionDamping, PositionFriction
from softid.diagnosis.verdict.unlisted_readings import (
    EarlyReading,
    LateGauge,
    SmoothedInput,
    UnevenReading,
)
from softid.effects import effect_of, own_values
from softid.effects.base import Effect
from softid.parallel import in_parallel


@dataclass(frozen=True)
class Replacement:
    """Laws that are refitted in the place of causes.

    Attributes
    ----------
    causes
        Names or keys of the causes.
    laws
        Sets of effects, each put in the place of all of these causes.
    behind
        A BIC that is less above that of the causes says as much.
    beside
        Name of another cause that must be named as well; empty where none must.
    most
        So does a law that takes away this share of what the cause does, or that predicts what is
        held out better, which no law of its kind would if the cause were there; None where the BIC
        alone counts.
    least
        Share of what the causes leave that a law must take away for its BIC to count: theirs may
        not be followed to the last digit.
    """

    causes: tuple[str, ...]
    laws: tuple[tuple[Effect, ...], ...]
    behind: float = INDISTINCT
    beside: str = ""
    most: float | None = None
    least: float = 0.0

    def takes(self, effect: Effect) -> bool:
        """Whether an effect is one of the causes."""
        return effect.name in self.causes or effect.key in self.causes

    def takes_enough(self, other: Candidate, final: Candidate) -> bool:
        """Whether a law leaves so much less than causes that its BIC counts.

        Where it does without one of several effects it need not: what these do together is what it
        does by itself.

        Parameters
        ----------
        other, final
            As in `does_as_much`.
        """
        may_be_close = self.least == 0.0 or len(other.effects) < len(final.effects)
        return may_be_close or other.squares < (1.0 - self.least) * final.squares

    def does_as_much(self, other: Candidate, final: Candidate, base: BaseFit) -> bool:
        """Whether what stands in the place of causes does most of what these do, or predicts more.

        What they do is seen from the others, refitted without them: what these do counts for none.

        Parameters
        ----------
        other
            The model with a law in their place.
        final
            The model with all causes.
        base
            What that extends.
        """
        if self.most is None:
            return False
        if base.held_out.rms(other) < base.held_out.rms(final):
            return True
        kept = [effect for effect in final.effects if effect.key in other.keys]
        alone = base.candidate
        if kept:
            alone = refit_with_fewer(final, base.candidate, kept, base.scale, base.sigma)
        return alone.squares - other.squares > self.most * (alone.squares - final.squares)

    def asks(self, named: Sequence[Effect]) -> bool:
        """Whether one of `causes` is named, and `beside` too where it is given.

        Parameters
        ----------
        named
            The effects of all causes that are named.
        """
        has_other = not self.beside or any(effect.name == self.beside for effect in named)
        return has_other and any(self.takes(effect) for effect in named)


OF_A_STOP = 0.03
"""Share of what dry friction or a hysteresis leaves that play, or a loop of the sensor, must take
away in its place: behind a step that ends in one move a valve with play does the same as friction,
and friction whose sign is rounded creeps a little while it should hold. A judgement, a few times
what that makes of a friction that is there."""

BESIDE_A_LOOP = (
    "softening",
    "dead_zone",
    "creep",
    "stiffening",
    "static_curve",
    "quadratic_damping",
    "asymmetric_damping",
    "pressure_mass",
)
"""What a loop that gives way over several distances leaves of one distance looks like these."""

MOST_OF_A_LOOP = 0.8
"""Share of what such a cause does that a second loop does as well where there is a second loop: of
what several elements leave of one it takes nearly all, of another law hardly any."""

MOST_OF_AN_AVERAGE = 0.99
"""Share of what a moving average does that a limit of the filling rate does as well where all steps
are of one size: each is a ramp of one length then, and what is left of it goes by the moments of
the jumps, which lie between samples."""

AT_REST = ("static_curve", "stiffening")
"""What friction of another size at each position leaves of a constant one, or of one that goes with
the pressure, looks like these, for it holds the actuator elsewhere."""

REPLACEMENTS: tuple[Replacement, ...] = (
    Replacement(DRIFTS, ((LoadDrift(),), (PressureGainDrift(),), (PressureDrift(),))),
    Replacement(("sensor_warmup",), ((SettlingPressure(),),)),
    Replacement(("stiffening", "static_curve", "contact"), ((BentReading(),),)),
    Replacement(
        ("stiffening", "static_curve", "contact"), ((InputLimit(),), (ReliefLeak(),)), behind=0.0
    ),
    Replacement(
        ("stiffening", "static_curve", "contact", "dead_zone"),
        ((PowerSpring(),), (FreeSpring(),), (FineCurve(),)),
        behind=0.0,
    ),
    Replacement(("sensor_clipping",), ((InputLimit(),),)),
    Replacement(("sensor_clipping.lower", "contact.lower"), ((effect_of("dead_zone"),),)),
    Replacement(
        ("hysteresis", "coulomb_friction"),
        ((InputPlay(),), (OutputPlay(),), (ReadingHysteresis(),)),
        behind=0.0,
        least=OF_A_STOP,
    ),
    Replacement(("coulomb_friction",), ((OwnBranches(),),), behind=0.0),
    Replacement(
        ("coulomb_friction.pressure", "coulomb_friction.stribeck", *AT_REST),
        ((PositionFriction(),),),
        behind=0.0,
        beside="coulomb_friction",
    ),
    Replacement(
        ("hysteresis.pressure", *AT_REST),
        ((PositionHysteresis(),),),
        behind=0.0,
        beside="hysteresis",
    ),
    Replacement(
        ("quadratic_damping", "asymmetric_damping"),
        ((PositionDamping(),), (DampingDrift(),)),
        behind=0.0,
    ),
    Replacement(("relaxation", "smoothing"), ((LateGauge(),), (EarlyReading(),)), behind=0.0),
    Replacement(("pneumatic_lag", "valve_flow"), ((RateLimit(),),)),
    Replacement(("smoothing",), ((RateLimit(),),), most=MOST_OF_AN_AVERAGE),
    Replacement(("pneumatic_lag.separate",), ((UnevenReading(),),)),
    Replacement((*DRIFTS, "hysteresis", "softening"), ((SecondCreep(),),), beside="creep"),
    Replacement(BESIDE_A_LOOP, ((SecondHysteresis(),),), beside="hysteresis", most=MOST_OF_A_LOOP),
    Replacement(
        ("softening", "ageing", "sensor_gain_drift"),
        ((SettlingStiffness(),), (SettlingGain(),), (RecoveringSoftening(),)),
        behind=0.0,
    ),
    Replacement(
        ("sensor_clipping.both",),
        (
            (effect_of("sensor_clipping"), effect_of("dead_zone")),
            (InputLimit(), effect_of("dead_zone")),
        ),
    ),
    Replacement(
        ("line_resonance",),
        ((effect_of("pneumatic_lag"), effect_of("delay")), (SmoothedInput(),)),
    ),
)
"""Causes, and what is put in their place."""

Asked = tuple[Replacement, tuple[Effect, ...]]
"""A row of the table, and one of its sets of laws."""

Try = tuple[Replacement, tuple[Effect, ...], tuple[Effect, ...]]
"""The same, and the effects that stay."""


def with_replacements(
    links: Sequence[Link],
    is_named: Sequence[bool],
    final: Candidate,
    base: BaseFit,
    *,
    is_doubtful: bool = False,
) -> list[Link]:
    """The links; those of named causes with what explains the logs as well in their place.

    Parameters
    ----------
    links
        The chain.
    is_named
        Which of them may be named.
    final
        The model with all causes.
    base
        What the chain begins with.
    is_doubtful
        Whether the causes behind the first may together stand for one law.
    """
    named = [link.added for link, may in zip(links, is_named, strict=True) if may]
    if not named:
        return list(links)
    asked = _asked(
        named,
        is_linear=final.problem.model.is_linear,
        over_linear=base.candidate.problem.model.is_linear,
        is_doubtful=is_doubtful,
    )
    if not asked:
        return list(links)
    tries = _tries(asked, named, final.acting)
    standing, near = standing_of(final, base), PROMISING_RATIO * final.squares
    others = in_parallel(lambda each: refitted_with(standing, each[2], each[1], near=near), tries)
    rankings = rank_either_way([final, *(one for one in others if one is not None)], base.sigma)
    found = list(links)
    for (row, laws, _), other in zip(tries, others, strict=True):
        if other is None or _is_within_samples(row, laws, other, base.scale.period_s):
            continue
        is_alike = row.takes_enough(other, final) and all(
            _is_alike(other, final, row.behind, ranked) for ranked in rankings
        )
        if is_alike or row.does_as_much(other, final, base):
            found = [_with_rivals(link, row, laws, other) for link in found]
    return found


def _is_within_samples(
    row: Replacement, laws: Sequence[Effect], other: Candidate, period_s: float
) -> bool:
    """Whether laws differ from a cause in whose place they are by less than a sampling interval."""
    for law in laws:
        values = own_values(law, other.parameters)
        simpler = law.simpler(values)
        if simpler is not None and simpler[0] in row.causes:
            return law.differs_within(values) < period_s
    return False


def _is_alike(other: Candidate, final: Candidate, behind: float, ranked: Sequence[Ranked]) -> bool:
    """Whether a BIC is hardly above the least, and at most so much above that of the causes."""
    bic = {id(row.plain): row.bic for row in ranked}
    return bic[id(other)] < min(ranked[0].bic + INDISTINCT, bic[id(final)] + behind)


def _asked(
    named: Sequence[Effect],
    *,
    is_linear: bool,
    over_linear: bool = False,
    is_doubtful: bool = False,
) -> list[Asked]:
    """Rows of the table that take a named effect, each with its sets of laws one by one."""
    unlisted = suiting(UNLISTED_LAWS, is_linear=over_linear)
    rows = [row for row in REPLACEMENTS if row.asks(named)]
    found = [(row, laws) for row in rows for laws in row.laws]
    together = [named, named[1:]] if is_doubtful and len(named) > 1 else [named]
    for effects in together:
        names = tuple(effect.name for effect in effects)
        known = {laws for row, laws in found if [e for e in named if row.takes(e)] == [*effects]}
        laws_left = tuple((law(),) for law in unlisted if (law(),) not in known)
        found += [(Replacement(names, laws_left, behind=0.0), laws) for laws in laws_left]
    return [(row, laws) for row, laws in found if not (is_linear and _drifts(laws))]


def _tries(asked: Sequence[Asked], named: Sequence[Effect], acting: Sequence[Effect]) -> list[Try]:
    """What is refitted, once each, with the effects that stay; no law of the name of one of these.

    What is described may come of a wrong name, and stays and goes.
    """
    found = [
        (row, laws, tuple(e for e in acting if e not in named or not row.takes(e)))
        for row, laws in asked
    ]
    described = [e for e in acting if e not in named]
    if described:
        found += [
            (row, laws, tuple(e for e in acting if e in named and not row.takes(e)))
            for row, laws in asked
        ]
        found += [
            (row, laws, tuple(e for e in acting if not row.takes(e)))
            for row, laws in asked
            if row.beside and any(map(row.takes, described))
        ]
    return [
        (row, laws, kept)
        for row, laws, kept in dict.fromkeys(found)
        if not {law.name for law in laws} & {effect.name for effect in kept}
    ]


def _drifts(laws: Sequence[Effect]) -> bool:
    """Whether laws are what the class of a linear model tells already."""
    return any(law.name in CHANGING.effects for law in laws)


def _with_rivals(link: Link, row: Replacement, laws: Sequence[Effect], model: Candidate) -> Link:
    """The link with laws that explain as much, if it is of one of the causes of a row."""
    if not row.takes(link.added):
        return link
    names = tuple(law.name for law in laws)
    rivals = tuple(dict.fromkeys((*link.rivals, *names)))
    return replace(link, rivals=rivals, replaced=(*link.replaced, (names[-1], model)))
