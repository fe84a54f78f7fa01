"""Parameters that the fitted logs hardly tell, where nothing else is wrong on what is held out.

A slow log is followed by many motions, and which of them it was shows in a faster one. A model that
was fitted to the slow log alone errs there by far more than its errors foretell, for these hold
near the optimum only, or a term was dropped that no sample showed. Fitted to both at once, the
right model leaves noise on both, and nothing of it is missing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOutLogs
from softid.diagnosis.residual.one_step import is_one_step
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis.verdict.held_out_error import with_held_out
from softid.errors import Issue
from softid.log import LogSet

TOLD_TOGETHER = "told-together"
"""Code of the remark that only what is held out tells some parameters."""

DIFFERS = 0.1
"""Share by which a parameter of the fit to all logs differs before the two values are told."""


def explained_by_held_out(
    recordings: Recordings, request: Request, search: CauseSearch
) -> tuple[SearchResult, Issue] | None:
    """The base alone with a remark, where a fit to all logs leaves nothing but noise on any.

    Single steps are none to go by: most models follow two of them.

    Parameters
    ----------
    recordings
        The logs.
    request
        What the user asked for.
    search
        The search over the base, which leaves noise on the fitted logs and errs on those held out.
    """
    base = search.base
    left = search.remainder_of(base.candidate)
    held_out = base.held_out
    is_open = left.structured or left.colour_s is not None or left.open_jumps > 0
    if is_open or is_one_step(base.candidate.problem) or not isinstance(held_out, HeldOutLogs):
        return None
    before = held_out.rms(base.candidate)
    if not with_held_out(left, before, base.candidate, held_out, base.sigma).misses_held_out:
        return None
    choice = base.identified.choice
    asked = request if choice is None else replace(request, model=choice.model, preferred=())
    together = LogSet((*recordings.logs, *recordings.hold_out))
    whole = replace(search, base=asked.fit_base(together, (), thorough=False))
    model = whole.base.candidate
    alone = whole.without_causes()
    judged = with_held_out(left, before, model, held_out, base.sigma)
    if alone is None or alone.remainder.open_jumps > 0 or judged.misses_held_out:
        return None
    found = SearchResult(search.nothing, replace(judged, explained_share=1.0), ())
    return found, told_together(base, model, held_out.rms(model))


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
    fitted = _listed([log.name for log in problem.logs])
    held = _listed([log.name for log in base.identified.hold_out])
    channel = problem.logs[0].channels[problem.outputs[0]]
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
        f"{held} together it leaves {rms * channel.display_factor:.3g} {channel.display_unit} rms "
        f"on {held}, which is noise; {fitted} alone hardly "
        f"{'tells' if len(problem.logs) == 1 else 'tell'} its parameters{told}",
        f"fit {fitted} and {held} together, and keep another log to judge by",
    )


def _is_seen(base: BaseFit, name: str) -> bool:
    return name in base.candidate.problem.free and name not in base.identified.found.unseen


def _differs(base: BaseFit, together: Candidate, name: str) -> bool:
    if not _is_seen(base, name):
        return True
    ratio = together.parameters[name] / base.candidate.parameters[name]
    return not np.isclose(ratio, 1.0, rtol=DIFFERS, atol=0.0)


def _before(base: BaseFit, name: str) -> str:
    return f"{base.candidate.parameters[name]:.3g}" if _is_seen(base, name) else "could not be seen"


def _listed(names: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
