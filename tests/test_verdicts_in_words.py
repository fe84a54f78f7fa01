"""Of a diagnosis, `report` writes the words: it sets no verdict, and takes no cause away."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

REPORT = Path(__file__).resolve().parents[1] / "softid" / "diagnosis" / "report"


def decisions(tree: ast.Module) -> list[int]:
    """Lines of calls that set a `Verdict`, or say that there are no causes.

    The verdict on a parameter is a word, and that on a diagnosis is a `Verdict` or comes from
    another one.
    """
    return [
        node.value.lineno
        for call in ast.walk(tree)
        if isinstance(call, ast.Call)
        for node in call.keywords
        if (node.arg == "verdict" and not isinstance(node.value, ast.Constant))
        or (node.arg == "causes" and isinstance(node.value, ast.Tuple) and not node.value.elts)
    ]


def test_the_words_decide_nothing() -> None:
    """What decides is in `verdict`, and `completion.py` says when."""
    paths = sorted(REPORT.rglob("*.py"))
    assert paths
    wrong = [
        f"{path.name}:{line}: set it in softid/diagnosis/verdict/"
        for path in paths
        for line in decisions(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    ("code", "found"),
    [
        ("replace(answer, verdict=Verdict.UNKNOWN)", True),
        ("replace(answer, verdict=other.verdict)", True),
        ("replace(answer, causes=())", True),
        ("replace(answer, causes=tuple(weaker))", False),
        ("replace(estimate, verdict='weakly identified')", False),
    ],
)
def test_a_decision_is_seen(code: str, found: bool) -> None:
    """The rule above is only worth what its detector sees."""
    assert bool(decisions(ast.parse(code))) is found
