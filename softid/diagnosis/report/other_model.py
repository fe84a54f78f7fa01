"""That another model explains the logs as well, with another cause in the place of one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from softid.diagnosis.plainer_model import OtherModel
from softid.diagnosis.report.ambiguity import SPLITS
from softid.diagnosis.report.phrases import titles_of
from softid.diagnosis_results import Alternative, Cause, Diagnosis, Verdict
from softid.effects import EFFECTS
from softid.effects.base import Effect


def with_other_model(found: Diagnosis, other: OtherModel | None) -> Diagnosis:
    """The diagnosis with the causes of another model in ties with those that it does without.

    A lag behind an actuator whose time constant stays the same at every pressure may be a pole of
    the actuator itself: no name is sure that another model does not need.

    Parameters
    ----------
    found
        A diagnosis in numbers, over the model that softid has chosen.
    other
        The other model; None where there is none.
    """
    if other is None or found.verdict not in (Verdict.NAMED, Verdict.AMBIGUOUS):
        return found
    theirs = {effect.name for effect in other.effects}
    known = {cause.effect for cause in found.causes}
    added = [effect for effect in other.effects if effect.name not in known]
    lost = [cause for cause in found.causes if cause.effect not in theirs]
    if not added or not lost:
        return found
    ties = tuple(_tie(found.alternatives, cause, added, other) for cause in lost)
    apart = {cause.effect for cause in lost}
    kept = tuple(a for a in found.alternatives if apart.isdisjoint(a.effects))
    return replace(found, verdict=Verdict.AMBIGUOUS, alternatives=(*kept, *ties))


def _tie(
    known: Sequence[Alternative], cause: Cause, added: Sequence[Effect], other: OtherModel
) -> Alternative:
    """The tie that a cause is in already, or a new one, with the causes of the other model."""
    alone = Alternative((cause.effect,), {cause.effect: 0.0}, "", (cause.key,))
    tie = next((a for a in known if cause.effect in a.effects), alone)
    names, keys = zip(*((effect.name, effect.key) for effect in added), strict=True)
    explains = "explains" if len(added) == 1 else "explain"
    return Alternative(
        (*tie.effects, *names),
        {**tie.delta_bic, **dict.fromkeys(names, max(other.behind, 0.0))},
        f"Over the {other.label} model, which has fewer parameters, {titles_of(keys)} {explains} "
        f"these logs as well{SPLITS}{_experiment(cause)}.",
        (*tie.keys, *keys),
    )


def _experiment(cause: Cause) -> str:
    """What tells a cause from what another model makes of it."""
    stage = EFFECTS[cause.key].stage if cause.key in EFFECTS else "state"
    if stage == "output":
        return "the sensor beside another one that is faster and linear"
    if stage == "input":
        return "the pressure at the actuator itself"
    return "small fast steps about several levels, whose time constants tell the models apart"
