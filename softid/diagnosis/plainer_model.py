"""A plainer model in the place of the one that was chosen, where its first cause explains more.

A model is chosen while nothing is known of causes, so one with more parameters wins that bends to
what a cause does: a muscle with its curved spring predicts an actuator that meets a wall better
than an oscillator does, and what it leaves then has no name.
"""

from __future__ import annotations

from dataclasses import replace

from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.cause_search import CauseSearch
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.search.two_of_first_order import is_likelier
from softid.errors import IdentificationError, Issue

PLAINER_MODEL = "plainer-model"
"""Code of the remark that another model than the one that predicts best is extended."""


def first_cause_of_models(
    recordings: Recordings, request: Request, search: CauseSearch
) -> tuple[Request, CauseSearch, Chain]:
    """The first cause, over the model for which it is the likeliest.

    Plainer models that lost by prediction are extended by a first cause, too. One whose BIC is then
    below that of the chosen model with its own first cause is what the logs call for. A model that
    the user named stays, and so does one that needs no cause, or one whose first cause leaves noise
    and is no curve, which may bend to anything.

    Parameters
    ----------
    recordings
        The logs.
    request
        What the user asked for.
    search
        The search over the model that was chosen.

    Returns
    -------
    request, search, first
        With the model that is extended, and the chain of its first cause.
    """
    first, choice = search.first_cause(), search.base.identified.choice
    best = request, search, first
    if choice is None or not first.links:
        return best
    is_curve = len(first.links[0].added.amplitudes) > 1
    if not is_curve and not search.leaves_structure(first):
        return best
    for model in choice.plainer:
        asked = replace(request, model=model)
        try:
            base = asked.fit_base(recordings.logs, recordings.hold_out, thorough=False)
        except IdentificationError:  # it was drafted, but its fit came to no parameters
            continue
        other = replace(search, base=base)
        chain = other.first_cause()
        if chain.links and is_likelier(chain.final, best[2].final, search.base.sigma):
            best = asked, other, chain
    return best


def plainer_model_issues(chosen: BaseFit, extended: BaseFit) -> tuple[Issue, ...]:
    """That another model is extended than the one chosen; nothing where it is the same.

    Parameters
    ----------
    chosen
        The fit of the model that predicts best by itself.
    extended
        That of the model that is extended.
    """
    before, after = (fit.candidate.problem.model.name for fit in (chosen, extended))
    if before == after or chosen.identified.choice is None:
        return ()
    return (
        Issue(
            PLAINER_MODEL,
            "info",
            f"by itself the {before} model predicts blocks left out of the fit better, but with "
            f"its first cause the {after} model, which has fewer parameters, explains the logs "
            "more likely (BIC), and is extended",
            f"name it with --model {before} to keep that",
        ),
    )
