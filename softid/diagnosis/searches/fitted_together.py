"""Parameters that the fitted logs hardly tell, where nothing else is wrong on what is held out.

A slow log is followed by many motions, and which of them it was shows in a faster one. A model that
was fitted to the slow log alone errs there by far more than its errors foretell, for these hold
near the optimum only, or a term was dropped that no sample showed. Fitted to both at once, the
right model leaves noise on both, and nothing of it is missing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOutLogs, mean_power
from softid.diagnosis.residual.noise_floor import fastest_part
from softid.diagnosis.residual.one_step import is_one_step
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis.verdict.held_out_error import OTHER_LOG
from softid.diagnosis_results import Remainder
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
    base, held_out = search.base, search.base.held_out
    left = search.remainder_of(base.candidate)
    is_open = left.structured or left.colour_s is not None or left.open_jumps > 0
    if is_open or is_one_step(base.candidate.problem) or not isinstance(held_out, HeldOutLogs):
        return None
    if _is_noise(held_out, base.candidate, left):
        return None
    choice = base.identified.choice
    asked = request if choice is None else replace(request, model=choice.model, preferred=())
    logs = LogSet((*recordings.logs, *recordings.hold_out))
    whole = replace(search, base=asked.fit_base(logs, (), thorough=False))
    model = whole.base.candidate
    rms = held_out.rms(model)
    if whole.remainder_of(model).structured:
        share = _share_taken(held_out, base.candidate, model, left.noise_power)
        return Together(None, not_together(base, rms), share)
    alone = whole.without_causes()
    if alone is None or alone.remainder.open_jumps or not _is_noise(held_out, model, left):
        return None
    found = replace(left, held_out_share=1.0, misses_held_out=False, explained_share=1.0)
    return Together(SearchResult(search.nothing, found, ()), told_together(base, model, rms))


def _is_noise(held_out: HeldOutLogs, model: Candidate, left: Remainder) -> bool:
    """Whether a model leaves no more on what is held out than noise, which may be louder there."""
    runs = held_out.runs(model)
    noise = max(left.noise_power, fastest_part(runs).variance)
    return mean_power(runs) <= OTHER_LOG * noise


def _share_taken(held_out: HeldOutLogs, before: Candidate, after: Candidate, noise: float) -> float:
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


def told_together(base: BaseFit, together: Candidate, rms: float) -> Issue:
    """That the model follows all logs with parameters that the fitted ones do not tell.

    Parameters
    ----------
    base
        The fit to some logs.
    together
        That to all of them.
    rms
        What the latter leaves on what is held out, in the unit of the first output.
    """
    problem = base.candidate.problem
    fitted, held, left = _names_and_size(base, rms)
    values = [
        f"{name} is {together.parameters[name]:.3g} {p.unit} then, and {_before(base, name)} before"
        for name, p in together.problem.parameters.items()
        if name in together.problem.free and _differs(base, together, name)
    ]
    told = f": {'; '.join(values)}" if values else ""
    return Issue(
        TOLD_TOGETHER,
        "warning",
        f"nothing is missing from the {problem.model.name} model, for fitted to {fitted} and "
        f"{held} together it leaves {left} rms on {held}, which is noise; {fitted} alone hardly "
        f"{'tells' if len(problem.logs) == 1 else 'tell'} its parameters{told}",
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


def _is_seen(base: BaseFit, name: str) -> bool:
    return name in base.candidate.problem.free and name not in base.identified.found.unseen


def _differs(base: BaseFit, together: Candidate, name: str) -> bool:
    if not _is_seen(base, name):
        return True
    before, after = base.candidate.parameters[name], together.parameters[name]
    return not np.isclose(after, before, rtol=DIFFERS, atol=0.0)


def _before(base: BaseFit, name: str) -> str:
    return f"{base.candidate.parameters[name]:.3g}" if _is_seen(base, name) else "could not be seen"
