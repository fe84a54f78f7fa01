"""Over which model the answer comes, by rule: models and searches that are none."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_diagnosis import diagnosis

from softid.diagnosis import best_answer as module
from softid.diagnosis.best_answer import best_answer
from softid.diagnosis.searches.over_plainer_models import ModelSearch
from softid.diagnosis_results import Diagnosis, Verdict

NOTHING: Any = None


def answer(verdict: Verdict, effect: str = "creep", *, structured: bool = False) -> Diagnosis:
    """An answer whose causes, if it has any, are of one name."""
    found = diagnosis(verdict)
    causes = tuple(replace(cause, effect=effect) for cause in found.causes)
    left = replace(found.remainder, structured=structured)
    return replace(found, causes=causes, remainder=left)


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
    monkeypatch.setattr(module, "explained_by_held_out", lambda *args: None)
    monkeypatch.setattr(module, "PlainerModels", lambda *args: models)
    monkeypatch.setattr(module, "_over_this_or_plainer", lambda *args: (plain, base, None))
    monkeypatch.setattr(module, "_surest_answer", lambda *args: (rich, base, None))
    monkeypatch.setattr(module, "search_causes", lambda *args: (None, None))
    monkeypatch.setattr(module, "is_one_step", lambda problem: False)
    monkeypatch.setattr(module, "is_likelier", lambda *args: likelier)
    request: Any = SimpleNamespace(model=None)
    found, _, _ = best_answer(NOTHING, request, search, NOTHING, is_in_doubt=False)
    assert (found is rich) is is_rich
