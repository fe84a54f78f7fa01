"""Over which model the answer comes, by rule: models and searches that are none."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_diagnosis import diagnosis
from handmade_searches import base_fit, search_over

from softid.diagnosis import best_answer as module
from softid.diagnosis.best_answer import best_answer
from softid.diagnosis.changes.log_differences import LogDifferences
from softid.diagnosis.report.changes import HELD_OUT_CHANGE
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.fitted_together import NOT_TOGETHER, TOLD_TOGETHER, Together
from softid.diagnosis.searches.over_plainer_models import ModelSearch
from softid.diagnosis_results import Diagnosis, Variation, Verdict
from softid.errors import Issue

NOTHING: Any = None


def answer(verdict: Verdict, effect: str = "creep", *, structured: bool = False) -> Diagnosis:
    """An answer whose causes, if it has any, are of one name."""
    found = diagnosis(verdict)
    causes = tuple(replace(cause, effect=effect) for cause in found.causes)
    left = replace(found.remainder, structured=structured)
    return replace(found, causes=causes, remainder=left)


BARE: Any = SimpleNamespace(final=SimpleNamespace(effects=()))
PLAIN_CURVE = answer(Verdict.AMBIGUOUS, "static_curve", structured=True)
PLAIN_CREEP = answer(Verdict.PARTIAL, structured=True)
PLAIN_SETTLED = answer(Verdict.NAMED)
RICH_UNKNOWN = answer(Verdict.UNKNOWN, structured=True)
RICH_SETTLED = answer(Verdict.NAMED, "delay")


@pytest.mark.parametrize(
    ("plain", "rich", "likelier", "is_rich"),
    [
        (PLAIN_SETTLED, RICH_SETTLED, True, False),
        (PLAIN_CURVE, RICH_UNKNOWN, False, True),
        (PLAIN_CREEP, RICH_UNKNOWN, False, False),
        (PLAIN_CREEP, RICH_UNKNOWN, True, True),
        (PLAIN_CREEP, RICH_SETTLED, False, True),
        (answer(Verdict.UNKNOWN, structured=True), RICH_UNKNOWN, False, True),
    ],
    ids=["settled", "curve", "named", "likelier", "leaves noise", "no name"],
)
def test_a_richer_model_where_a_plainer_one_leaves_something(
    plain: Diagnosis,
    rich: Diagnosis,
    likelier: bool,
    is_rich: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A curve at rest may be the spring of the model that predicts best; a creep is none."""
    base = SimpleNamespace(candidate=SimpleNamespace(problem=None), sigma={})
    search: Any = SimpleNamespace(explained_by_moments=lambda: None, base=base)
    chosen = ModelSearch(NOTHING, NOTHING, NOTHING)
    models = SimpleNamespace(
        chosen=chosen,
        likeliest=lambda: ModelSearch(NOTHING, NOTHING, NOTHING),
        is_chosen=lambda base: False,
        richer_than=lambda base: [chosen],
    )
    monkeypatch.setattr(module, "fitted_together", lambda *args: None)
    monkeypatch.setattr(module, "PlainerModels", lambda *args: models)
    monkeypatch.setattr(module, "_over_this_or_plainer", lambda *args: (plain, base, BARE))
    monkeypatch.setattr(module, "_surest_answer", lambda *args: (rich, base, BARE))
    monkeypatch.setattr(module, "search_causes", lambda *args: (None, None))
    monkeypatch.setattr(module, "is_one_step", lambda problem: False)
    monkeypatch.setattr(module, "is_likelier", lambda *args: likelier)
    request: Any = SimpleNamespace(model=None)
    found, _, _ = best_answer(NOTHING, request, search, NOTHING, is_in_doubt=False)
    assert (found is rich) is is_rich


@pytest.mark.parametrize(
    ("found", "asks"),
    [
        (answer(Verdict.NAMED), "explaining as well"),
        (answer(Verdict.AMBIGUOUS, structured=True), ""),
        (answer(Verdict.UNKNOWN, structured=True), "after all causes"),
    ],
    ids=["named", "a tie that leaves more", "unknown"],
)
def test_plainer_models_are_held_against_the_chain_that_is_answered(
    found: Diagnosis, asks: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first one may have been refused, and another beginning have led to the answer."""
    problem = SimpleNamespace(parameters=SimpleNamespace(names=()))
    base: Any = SimpleNamespace(candidate=SimpleNamespace(problem=problem))
    refused: Any = SimpleNamespace(chain=SimpleNamespace(links=(1,)))
    answered: Any = SimpleNamespace(links=(2,), final=None)
    asked: list[tuple[str, Any]] = []
    models: Any = SimpleNamespace(
        search=SimpleNamespace(base=base),
        after_all_causes=lambda model, chain, **doubts: asked.append(("after all causes", chain)),
        explaining_as_well=lambda model, chain: asked.append(("explaining as well", chain)),
    )
    others: Any = SimpleNamespace(all=lambda base: ())
    monkeypatch.setattr(module, "_surest_answer", lambda *args: (found, base, answered))
    monkeypatch.setattr(module, "is_one_step", lambda problem: False)
    searched: Any = (refused, SimpleNamespace(base=base))
    model = ModelSearch(NOTHING, NOTHING, NOTHING)
    module._over_this_or_plainer(models, model, lambda model: searched, others)
    assert all(chain is answered for _, chain in asked)
    assert {what for what, _ in asked} == {"after all causes", *filter(None, [asks])}


REFUTED = Together(None, Issue(NOT_TOGETHER, "warning", "no parameters follow both"))


@pytest.mark.parametrize(
    ("found", "verdict", "is_told"),
    [
        (answer(Verdict.ADEQUATE), Verdict.UNKNOWN, True),
        (replace(RICH_UNKNOWN, descriptive=()), Verdict.UNKNOWN, True),
        (RICH_UNKNOWN, Verdict.UNKNOWN, False),
        (RICH_SETTLED, Verdict.NAMED, False),
    ],
    ids=["adequate", "unknown", "described", "named"],
)
def test_a_base_that_follows_no_two_logs_at_once_is_not_adequate(
    found: Diagnosis, verdict: Verdict, is_told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Unsure parameters would explain what is missed; a cause that is named explains it better."""
    search: Any = SimpleNamespace(explained_by_moments=lambda: None)
    monkeypatch.setattr(module, "fitted_together", lambda *args: REFUTED)
    monkeypatch.setattr(module, "_over_best_model", lambda *args, **kwargs: (found, None, BARE))
    monkeypatch.setattr(module, "unasked_model_issues", lambda *args: ())
    told, _, _ = best_answer(NOTHING, NOTHING, search, NOTHING, is_in_doubt=False)
    assert told.verdict is verdict
    assert (REFUTED.issue in told.issues) is is_told


@pytest.mark.parametrize(
    ("refitted", "is_told"), [(0.6, True), (0.88, False)], ids=["a change", "as parameters do"]
)
def test_a_change_takes_far_more_than_parameters_that_are_fitted_to_both(
    refitted: float, is_told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A lag that a slow log hides leaves of a fast one what a drift takes 93 % of, and parameters
    88 %: neither is it."""
    change = Issue(HELD_OUT_CHANGE, "warning", "the drift of the reading changes")
    found = replace(answer(Verdict.UNKNOWN, structured=True), descriptive=(), issues=(change,))
    search: Any = SimpleNamespace(explained_by_moments=lambda: None)
    base = SimpleNamespace(held_out=None, scale=None)
    monkeypatch.setattr(module, "fitted_together", lambda *args: replace(REFUTED, share=refitted))
    monkeypatch.setattr(module, "_over_best_model", lambda *args, **kwargs: (found, base, BARE))
    monkeypatch.setattr(
        module, "held_out_difference", lambda *args: LogDifferences(("drift",), (-0.33,), 0.93)
    )
    monkeypatch.setattr(module, "unasked_model_issues", lambda *args: ())
    told, _, _ = best_answer(NOTHING, NOTHING, search, NOTHING, is_in_doubt=False)
    assert told.issues == ((change,) if is_told else (REFUTED.issue,))


VARIATION = Variation("v", 0.1, 0.2, 1e-6)
TOLD = Issue(TOLD_TOGETHER, "warning", "nothing else is missing")
PART = answer(Verdict.PARTIAL)
MISSES = replace(PART, remainder=replace(PART.remainder, misses_held_out=True))
VARIES = replace(MISSES, causes=tuple(replace(c, variation=VARIATION) for c in MISSES.causes))
LEAVES = replace(MISSES, remainder=replace(MISSES.remainder, structured=True))


@pytest.mark.parametrize(
    ("found", "told", "verdict"),
    [
        (MISSES, TOLD, Verdict.NAMED),
        (MISSES, None, Verdict.PARTIAL),
        (replace(MISSES, descriptive=MISSES.causes), TOLD, Verdict.PARTIAL),
        (PART, TOLD, Verdict.PARTIAL),
        (VARIES, TOLD, Verdict.PARTIAL),
        (LEAVES, TOLD, Verdict.PARTIAL),
    ],
    ids=["told together", "not together", "described", "no worse", "varies", "leaves structure"],
)
def test_a_cause_is_all_where_a_fit_to_all_logs_leaves_noise(
    found: Diagnosis, told: Issue | None, verdict: Verdict, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a cause leaves on what is held out alone may come from parameters that are off."""
    monkeypatch.setattr(module, "fitted_together", lambda *args: None)
    monkeypatch.setattr(module, "_over_best_model", lambda *args, **kwargs: (found, None, BARE))
    monkeypatch.setattr(module, "causes_fitted_together", lambda *args: told)
    search = search_over(base_fit())
    monkeypatch.setattr(CauseSearch, "explained_by_moments", lambda self: None)
    answered, _, _ = best_answer(NOTHING, NOTHING, search, NOTHING, is_in_doubt=False)
    assert answered.verdict is verdict
    assert (TOLD in answered.issues) is (verdict is Verdict.NAMED)
    misses = found.remainder.misses_held_out and verdict is Verdict.PARTIAL
    assert answered.remainder.misses_held_out is misses
