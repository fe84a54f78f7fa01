"""That another model explains the logs as well with other causes, or without any."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from softid.diagnosis.base.base_fit import Recordings, Request
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.ambiguity import SPLITS
from softid.diagnosis.report.phrases import titles_of
from softid.diagnosis.search.bic_ranking import is_likelier
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.over_plainer_models import OtherModel
from softid.diagnosis_results import Alternative, Cause
from softid.effects import EFFECTS
from softid.effects.base import Effect
from softid.errors import Issue, SoftidError

UNASKED_MODEL = "unasked-model"
"""Code of the remark that another model than the one that was named explains the logs by itself."""


def unasked_model_issues(
    recordings: Recordings, request: Request, search: CauseSearch, final: Candidate
) -> tuple[Issue, ...]:
    """That the model which softid would have chosen needs no cause, where the user named another.

    Parameters
    ----------
    recordings
        The logs.
    request
        What the user asked for.
    search
        The search over the named model.
    final
        That model with all that is described, which names nothing.
    """
    if request.model is None:
        return ()
    free = replace(request, model=None, parameters=None, progress=lambda message, fraction: None)
    try:
        base = free.fit_base(recordings.logs, recordings.hold_out, thorough=False)
    except SoftidError:
        return ()
    own, chosen = (fit.candidate.problem.model for fit in (search.base, base))
    if (
        chosen.name == own.name
        or replace(search, base=base).remainder_of(base.candidate).structured
    ):
        return ()
    if not is_likelier(base.candidate, final, search.base.sigma):
        return ()
    return (
        Issue(
            UNASKED_MODEL,
            "warning",
            f"the {chosen.label} model explains these logs by itself, down to the noise, so that "
            f"what the {own.label} model misses is no effect but its own law",
            f"diagnose again with --model {chosen.name}, or without --model",
        ),
    )


def tie_with_other_model(
    known: Sequence[Alternative], cause: Cause, added: Sequence[Effect], other: OtherModel
) -> Alternative:
    """The tie that a cause is in already, or a new one, with the causes of another model.

    A lag behind an actuator whose time constant stays the same at every pressure may be a pole of
    the actuator itself.

    Parameters
    ----------
    known
        The ties of the diagnosis.
    cause
        A cause that the other model does without.
    added
        Those that it has in its place.
    other
        The other model.
    """
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
