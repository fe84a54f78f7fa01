"""Parameters that the fitted logs hardly tell, where nothing else is wrong on what is held out.

A slow log is followed by many motions, and which of them it was shows in a faster one. A model that
was fitted to the slow log alone errs there by far more than its errors foretell, for these hold
near the optimum only, or a term was dropped that no sample showed. Fitted to both at once, the
right model leaves noise on both, and nothing of it is missing. So does one with its causes, which
then are not a part of what is wrong but all of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.base.intersample_selection import recordings_with_intersample
from softid.diagnosis.refit.candidates import Candidate, begun
from softid.diagnosis.refit.extension import extend_in_order, start_unknowns, within_bounds_of
from softid.diagnosis.refit.held_out import HeldOut, HeldOutLogs, mean_power
from softid.diagnosis.refit.parts_of_logs import REFIT_EVALUATIONS, best_settled
from softid.diagnosis.residual.noise_floor import fastest_part
from softid.diagnosis.residual.one_step import is_one_step
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis.verdict.held_out_error import OTHER_LOG
from softid.diagnosis_results import Remainder
from softid.effects import ExtendedModel
from softid.errors import Issue
from softid.log import LogSet
from softid.sentences import listed

TOLD_TOGETHER = "told-together"
"""Code of the remark that only what is held out tells some parameters."""

NOT_TOGETHER = "not-together"
"""Code of the remark that no parameters follow what is held out and the rest."""

DIFFERS = 0.1
"""Share by which a parameter of the fit to all logs differs before the two values are told."""


@dataclass(frozen=True, eq=False)
class Together:
    """What a fit to all logs says of a base that errs on those held out.

    Attributes
    ----------
    alone
        The base alone, if the fit leaves noise on all logs; None where it leaves more.
    issue
        The remark that says so.
    share
        Share that the fit to all takes away of what the base leaves there beyond noise.
    """

    alone: SearchResult | None
    issue: Issue
    share: float = 1.0


def fitted_together(
    recordings: Recordings, request: Request, search: CauseSearch
) -> Together | None:
    """What a fit to all logs says; None where there is no question, or no answer.

    Whether it is the parameters or the model is asked where the base leaves noise on the fitted
    logs and more on those held out. Single steps are none to go by: most models follow two of them.

    Parameters
    ----------
    recordings
        The logs.
    request
        What the user asked for.
    search
        The search over the base.
    """
    base, left = search.base, search.remainder_of(search.base.candidate)
    if not _is_question(base, base.candidate, left):
        return None
    held_out = base.held_out
    whole = _over_all(recordings, request, search)
    model = whole.base.candidate
    rms = held_out.rms(model)
    if whole.remainder_of(model).structured:
        share = _share_taken(held_out, base.candidate, model, left.noise_power)
        return Together(None, not_together(base, rms), share)
    alone = whole.without_causes()
    if alone is None or alone.remainder.open_jumps or not _is_noise(held_out, model, left):
        return None
    found = replace(left, held_out_share=1.0, misses_held_out=False, explained_share=1.0)
    issue = told_together(base, base.candidate, model, rms)
    return Together(SearchResult(search.nothing, found, ()), issue)


def causes_fitted_together(
    recordings: Recordings, request: Request, search: CauseSearch, model: Candidate, left: Remainder
) -> Issue | None:
    """That a model with its causes leaves noise where it is fitted to all logs, if it does.

    Asked where it leaves noise on the fitted logs and more on those held out. None where there is
    no question, where more is left, and where the base does without causes then.

    Parameters
    ----------
    recordings, request, search
        As in `fitted_together`.
    model
        The base of the search with causes.
    left
        What it leaves.
    """
    base = search.base
    if not model.effects or not _is_question(base, model, left):
        return None
    between = model.problem.logs[0].effective_intersample  # the base alone might ask for another
    taken = recordings_with_intersample(recordings, between)
    whole = _over_all(taken, request, search)
    if not whole.remainder_of(whole.base.candidate).structured:
        return None
    found = _refitted(model, whole.base)
    seen = whole.remainder_of(found)
    if seen.structured or seen.colour_s is not None or seen.open_jumps > 0:
        return None
    if found.at_bound - model.at_bound or not _is_noise(base.held_out, found, left):
        return None
    return told_together(base, model, found, base.held_out.rms(found))


def _is_question(base: BaseFit, model: Candidate, left: Remainder) -> bool:
    """Whether a model leaves noise on the fitted logs, and more on those held out."""
    is_open = left.structured or left.colour_s is not None or left.open_jumps > 0
    if is_open or is_one_step(model.problem) or not isinstance(base.held_out, HeldOutLogs):
        return False
    return not _is_noise(base.held_out, model, left)


def _over_all(recordings: Recordings, request: Request, search: CauseSearch) -> CauseSearch:
    """The search over the same model, fitted to all logs."""
    choice = search.base.identified.choice
    asked = request if choice is None else replace(request, model=choice.model, preferred=())
    logs = LogSet((*recordings.logs, *recordings.hold_out))
    return replace(search, base=asked.fit_base(logs, (), thorough=False))


def _refitted(known: Candidate, base: BaseFit) -> Candidate:
    """A model with causes refitted to the logs of a base, from where it and where that stands."""
    alone, model = base.candidate, known.problem.model
    scale = model.scale if isinstance(model, ExtendedModel) else base.scale
    extended = extend_in_order(alone.problem, known.acting, scale)
    problem = within_bounds_of(extended, known.problem)
    first = start_unknowns(problem, alone.problem, alone.minimum.point, known.parameters)
    free = known.problem.free_by_name(known.minimum.point)
    second = first.copy()
    for k, name in enumerate(problem.free):
        second[k] = free.get(name, first[k])
    begins = [begun(alone, known.effects, problem, z) for z in (first, second)]
    return best_settled(begins, base.sigma, REFIT_EVALUATIONS)


def _is_noise(held_out: HeldOut, model: Candidate, left: Remainder) -> bool:
    """Whether a model leaves no more on what is held out than noise, which may be louder there."""
    runs = held_out.runs(model)
    noise = max(left.noise_power, fastest_part(runs).variance)
    return mean_power(runs) <= OTHER_LOG * noise


def _share_taken(held_out: HeldOut, before: Candidate, after: Candidate, noise: float) -> float:
    """Share of what one model leaves beyond noise that another does not."""
    least, most = (mean_power([held_out.first_errors(c)]) - noise for c in (after, before))
    return 1.0 - least / most


def not_together(base: BaseFit, rms: float) -> Issue:
    """That the model follows some logs and those held out, and not both.

    Parameters
    ----------
    base
        The fit to some logs.
    rms
        What one to all of them leaves on what is held out, in the unit of the first output.
    """
    fitted, held, left = _names_and_size(base, rms)
    return Issue(
        NOT_TOGETHER,
        "warning",
        f"fitted to {fitted} and {held} together, the {base.candidate.problem.model.name} model "
        f"leaves {left} rms on {held}, which is more than noise: something is missing that "
        f"{fitted} alone hardly shows, or something changed between them",
        f"diagnose {fitted} and {held} together, and keep another log to judge by",
    )


def told_together(base: BaseFit, before: Candidate, together: Candidate, rms: float) -> Issue:
    """That a model follows all logs with parameters that the fitted ones do not tell.

    Parameters
    ----------
    base
        The fit to some logs.
    before
        The model as it was fitted to them, with causes or without.
    together
        The same fitted to all logs.
    rms
        What it then leaves on what is held out, in the unit of the first output.
    """
    problem = base.candidate.problem
    fitted, held, left = _names_and_size(base, rms)
    values = [
        f"{name} is {together.parameters[name]:.3g} {p.unit}".rstrip()
        + f" then, and {_before(base, before, name)} before"
        for name, p in together.problem.parameters.items()
        if name in together.problem.free and _differs(base, before, together, name)
    ]
    told = f": {'; '.join(values)}" if values else ""
    nothing = "nothing else" if together.effects else "nothing"
    causes = f" with its cause{'s' * (len(together.effects) > 1)}" if together.effects else ""
    return Issue(
        TOLD_TOGETHER,
        "warning",
        f"{nothing} is missing from the {problem.model.name} model{causes}, for fitted to "
        f"{fitted} and {held} together it leaves {left} rms on {held}, which is noise; {fitted} "
        f"alone hardly {'tells' if len(problem.logs) == 1 else 'tell'} its parameters{told}",
        f"fit {fitted} and {held} together, and keep another log to judge by",
    )


def _names_and_size(base: BaseFit, rms: float) -> tuple[str, str, str]:
    """The fitted logs and those held out by name, and an error in the unit that people know."""
    problem = base.candidate.problem
    channel = problem.logs[0].channels[problem.outputs[0]]
    size = f"{rms * channel.display_factor:.3g} {channel.display_unit}"
    logs = problem.logs, base.identified.hold_out
    fitted, held = (listed([log.name for log in own]) for own in logs)
    return fitted, held, size


def _differs(base: BaseFit, before: Candidate, together: Candidate, name: str) -> bool:
    if not _is_seen(base, before, name):
        return True
    known, now = before.parameters[name], together.parameters[name]
    return not np.isclose(now, known, rtol=DIFFERS, atol=0.0)


def _before(base: BaseFit, before: Candidate, name: str) -> str:
    seen = _is_seen(base, before, name)
    return f"{before.parameters[name]:.3g}" if seen else "could not be seen"


def _is_seen(base: BaseFit, before: Candidate, name: str) -> bool:
    return name in before.problem.free and name not in base.identified.found.unseen
