"""The answer that stands: over which model, and from which search it comes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import islice

from softid.diagnosis.answer import answer_of
from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.changes.held_out_difference import held_out_difference
from softid.diagnosis.report.changes import HELD_OUT_CHANGE
from softid.diagnosis.report.issues import unsure_issues
from softid.diagnosis.report.other_explanations import OtherExplanations
from softid.diagnosis.report.other_model import tie_with_other_model, unasked_model_issues
from softid.diagnosis.residual.one_step import is_one_step
from softid.diagnosis.search.bic_ranking import is_likelier
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.search.rival_in_place import with_rivals_in_place
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.fitted_together import (
    Together,
    causes_fitted_together,
    fitted_together,
)
from softid.diagnosis.searches.over_plainer_models import ModelSearch, OtherModel, PlainerModels
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis.searches.smoothed_record import smoothed_alone
from softid.diagnosis.searches.strategy import Searched, search_causes, search_with_intersample
from softid.diagnosis.searches.without_idle import without_idle
from softid.diagnosis.verdict.revision import (
    as_named_whole,
    as_unknown,
    exchanged_causes,
    with_ties,
)
from softid.diagnosis_results import Diagnosis, Verdict
from softid.errors import Issue

Answered = tuple[Diagnosis, BaseFit, Chain]
"""A diagnosis, the base that it extends, and the chain with all that is named or described."""

CONCLUSIVE_VERDICTS = (Verdict.ADEQUATE, Verdict.NAMED, Verdict.AMBIGUOUS)
"""Verdicts that leave no question open, unless a tie leaves more than noise."""

CURVES = ("static_curve", "dead_zone")
"""Causes that make a curve of a line, as the spring of a muscle does by itself."""

MOST_RIVALS = 2
"""Rivals that are tried in the place of a cause whose numbers refuse its name."""

CHANGE_LEAVES = 0.25
"""Share of what the base, fitted to all logs, leaves on those held out that a number which differs
there may leave: the true one leaves noise, others help as parameters do that are fitted to both."""

HOLLOW = 3
"""A model of which so many parameters are not identified beside its causes may be a plainer one."""


def best_answer(
    recordings: Recordings,
    request: Request,
    search: CauseSearch,
    others: OtherExplanations,
    *,
    is_in_doubt: bool,
) -> Answered:
    """The diagnosis over the model that the logs call for.

    Where causes over that one leave something, or have no name, a model with more parameters is
    extended, too, and kept if its own leave noise, or if it is likelier with them. What predicts
    best by itself is also kept where a plainer model has no name, or a curve at rest, to offer.

    Parameters
    ----------
    recordings, request, search, others, is_in_doubt
        As in `search_causes`.
    """
    alone = search.explained_by_moments()
    if alone is not None:
        return _answer(alone, search)
    together = fitted_together(recordings, request, search)
    if together is not None and together.alone is not None:
        return _with_issues(_answer(together.alone, search), (together.issue,))
    best = _over_best_model(recordings, request, search, others, is_in_doubt=is_in_doubt)
    if together is not None:
        best = _without_lesser_change(best, together)
        if not _says_what_it_is(best[0]):
            return _with_issues((as_unknown(best[0]), *best[1:]), (together.issue,))
    if best[0].verdict is Verdict.PARTIAL:
        return _named_if_told_together(best, recordings, request, search)
    if best[0].verdict is not Verdict.UNKNOWN:
        return best
    told = unasked_model_issues(recordings, request, search, best[2].final)
    return _with_issues(best, told) if told else best


def _named_if_told_together(
    answered: Answered, recordings: Recordings, request: Request, search: CauseSearch
) -> Answered:
    """The same; named where only parameters were off on what is held out, beside what is named."""
    answer, base, chain = answered
    left = replace(answer.remainder, misses_held_out=False)
    varies = any(cause.variation is not None for cause in answer.causes)
    is_all = not (left.leaves_something or varies or answer.descriptive)
    if not (is_all and answer.remainder.misses_held_out):
        return answered
    over = replace(search, base=base)
    told = causes_fitted_together(recordings, request, over, chain.final, answer.remainder)
    if told is None:
        return answered
    return _with_issues((as_named_whole(answer, left), base, chain), (told,))


def _says_what_it_is(answer: Diagnosis) -> bool:
    """Whether there is a cause, a description, or a number in which what is held out differs."""
    return _tells_change(answer) or bool(answer.causes or answer.descriptive)


def _tells_change(answer: Diagnosis) -> bool:
    return any(issue.code == HELD_OUT_CHANGE for issue in answer.issues)


def _without_lesser_change(answered: Answered, together: Together) -> Answered:
    """The same, but no number differs in what is held out if parameters make up for nearly as much.

    Those are the base's, fitted to all logs; what is missing from it would be told as a change.
    """
    answer, base, chain = answered
    if chain.final.effects or not _tells_change(answer):
        return answered
    differs = held_out_difference(chain.final, answer.remainder, base.held_out, base.scale)
    if differs is None or 1.0 - differs.share <= CHANGE_LEAVES * (1.0 - together.share):
        return answered
    kept = tuple(issue for issue in answer.issues if issue.code != HELD_OUT_CHANGE)
    return replace(answer, issues=kept), base, chain


def _over_best_model(
    recordings: Recordings,
    request: Request,
    search: CauseSearch,
    others: OtherExplanations,
    *,
    is_in_doubt: bool,
) -> Answered:
    """The same, where the base leaves more than the moments of jumps explain."""
    models = PlainerModels(recordings, request, search)
    over = search_with_intersample if is_in_doubt else search_causes

    @cache
    def searched(model: ModelSearch) -> Searched:
        return over(recordings, model.request, model.search, others, model.first)

    asked = models.likeliest()
    best = _over_this_or_plainer(models, asked, searched, others)
    if _is_settled(best) or is_one_step(best[1].candidate.problem):
        return best
    is_plainer = not models.is_chosen(best[1])
    if not is_plainer and others.all(best[1]):
        return best
    for rival in models.richer_than(best[1]):
        other = _surest_answer(*searched(rival))
        is_bare = is_plainer and _names_at_most_a_curve(best[0])
        if (
            is_bare
            or _is_settled(other)
            or is_likelier(other[2].final, best[2].final, search.base.sigma)
        ):
            best = other
    return best


def _names_at_most_a_curve(answer: Diagnosis) -> bool:
    """Whether the largest cause is none, or one that the spring of a richer model may be."""
    named = answer.causes[:1] if answer.verdict is not Verdict.UNKNOWN else ()
    return all(cause.effect in CURVES for cause in named)


def _is_settled(answered: Answered) -> bool:
    """Whether the causes have names and leave no more than noise, or there are none."""
    answer = answered[0]
    return answer.verdict in CONCLUSIVE_VERDICTS and not answer.remainder.structured


def _over_this_or_plainer(
    models: PlainerModels,
    asked: ModelSearch,
    searched: Callable[[ModelSearch], Searched],
    others: OtherExplanations,
) -> Answered:
    """The diagnosis over a model, or over a plainer one that does better."""
    found, last = searched(asked)

    def over_plainer_model() -> Answered | None:
        plainer = models.after_first_cause(asked, found.chain)
        return _answered(*searched(plainer)) if plainer is not None else None

    surest = _surest_answer(found, last, over_plainer_model)
    answer, base, chain = surest
    is_open = not found.chain.links and is_one_step(base.candidate.problem)
    if base is not last.base or is_open:  # a plainer model has settled it, or nothing does
        return surest
    unnamed = answer.verdict is Verdict.UNKNOWN
    plainer = models.after_all_causes(
        asked,
        chain,
        is_named=not unnamed,
        is_doubted=unnamed or _is_hollow(answer, base),
        is_explained=unnamed and bool(others.all(last.base)),
    )
    if plainer is None:
        is_last = _is_settled(surest) and base is models.search.base
        other_model = models.explaining_as_well(asked, chain) if is_last else None
        return _tied_with(answer, other_model), base, chain
    other = _surest_answer(*searched(plainer))
    return other if unnamed or other[0].verdict is not Verdict.UNKNOWN else surest


def _tied_with(answer: Diagnosis, other: OtherModel | None) -> Diagnosis:
    """The diagnosis with causes in ties with those that another model has in their place."""
    if other is None:
        return answer
    lost, added = exchanged_causes(answer, other.effects)
    ties = [tie_with_other_model(answer.alternatives, cause, added, other) for cause in lost]
    return with_ties(answer, ties, lost)


def _is_hollow(answer: Diagnosis, base: BaseFit) -> bool:
    """Whether the logs know little of the model that carries the causes."""
    if answer.extended is None:
        return False
    own = set(base.candidate.problem.parameters.names)
    rows = [p for p in answer.extended.parameters if p.name in own]
    return sum(p.verdict == "not identified" for p in rows) >= HOLLOW


def _answer(found: SearchResult, search: CauseSearch) -> Answered:
    """The diagnosis of what was found."""
    return answer_of(search.base, found, search.seed), search.base, found.chain


def _answered(found: SearchResult, search: CauseSearch) -> Answered:
    """The same, without descriptions behind which there may be nothing, if that leaves noise."""
    search.report("computing errors", 0.9)
    answered = _answer(found, search)
    answer = answered[0]
    if answer.verdict is not Verdict.UNKNOWN:
        kept = without_idle(found, search, answer.descriptive)
        return _answer(kept, search) if kept else answered
    alone = search.alone_beside(answer.descriptive, answer.remainder)
    if alone is not None:
        return _with_issues(_answer(alone, search), unsure_issues(answer.descriptive))
    smoothed = smoothed_alone(search, answer.descriptive)
    if smoothed is not None:
        return _with_issues(_answer(smoothed[0], search), smoothed[1:])
    return answered


def _with_issues(answered: Answered, issues: tuple[Issue, ...]) -> Answered:
    """The same with more remarks."""
    answer, base, chain = answered
    return replace(answer, issues=(*answer.issues, *issues)), base, chain


def _surest_answer(
    found: SearchResult,
    search: CauseSearch,
    over_plainer_model: Callable[[], Answered | None] = lambda: None,
) -> Answered:
    """The diagnosis of what was found; where that is unknown, of what is sure in its place.

    Numbers may refuse a name that a search gave, and no other beginning has been tried then. First
    come rivals that explain as much, for their numbers may say enough. The many other first causes
    come last, for they take the longest; a plainer model that leaves no more than noise saves them.
    """
    first = _answered(found, search)
    if first[0].verdict is not Verdict.UNKNOWN or found.came_to_nothing:
        return first

    def answered(other: SearchResult | None) -> Answered | None:
        return _answer(other, search) if other else None

    for chain in islice(with_rivals_in_place(found.chain), MOST_RIVALS):
        other = search.judged(chain, found.first)
        again = answered(other if other.is_sure else None)
        if again is not None and again[0].verdict is not Verdict.UNKNOWN:
            return again
    again = answered(search.search_from_multistart(found))
    if again is not None and again[0].verdict is not Verdict.UNKNOWN:
        return again
    again = over_plainer_model()
    if again is not None and _is_settled(again):
        return again
    other = search.search_from_other_causes(found)
    again = answered(None if other.chain is found.chain else other)
    if again is not None and again[0].verdict is not Verdict.UNKNOWN:
        return again
    return first
