"""Numbers of a module that set an accuracy or a decision say why they are what they are.

A constant is followed by a sentence in quotes, one for lines that stand together. Drawings, readers
and texts are left out: their numbers are sizes on paper and spellings.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("kernels", "models", "fitters", "diagnosis", "uncertainty", "identification")


def assigned(node: ast.stmt) -> tuple[list[str], ast.expr] | None:
    """The names that a statement gives a value, and that value."""
    if isinstance(node, ast.Assign):
        targets: Sequence[ast.expr] = node.targets
    elif isinstance(node, ast.AnnAssign):
        targets = [node.target]
    else:
        return None
    if node.value is None:
        return None
    names = [n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)]
    return names, node.value


def holds_a_number(value: ast.expr) -> bool:
    return any(
        isinstance(node, ast.Constant) and type(node.value) in (int, float)
        for node in ast.walk(value)
    )


def follows(body: Sequence[ast.stmt], k: int) -> bool:
    """Whether a statement stands on the line below the one before it."""
    return k < len(body) and body[k].lineno == (body[k - 1].end_lineno or 0) + 1


def is_text(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def unexplained(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and names of the constants with numbers whose lines no text follows."""
    for k, node in enumerate(tree.body):
        found = assigned(node)
        if found is None or not all(name.isupper() for name in found[0]):
            continue
        after = k + 1
        while follows(tree.body, after) and assigned(tree.body[after]) is not None:
            after += 1
        explained = follows(tree.body, after) and is_text(tree.body[after])
        if holds_a_number(found[1]) and not explained:
            yield node.lineno, ", ".join(found[0])


@pytest.mark.parametrize("package", PACKAGES)
def test_numbers_have_a_reason(package: str) -> None:
    """Stands on the source: a bare number is a decision that nobody can judge or change."""
    wrong = [
        f"{path.relative_to(ROOT).as_posix()}:{line}: say below {names} why it has this value"
        for path in sorted((ROOT / "softid" / package).rglob("*.py"))
        for line, names in unexplained(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    ("code", "found"),
    [
        ("LIMIT = 3", ["LIMIT"]),
        ("_LIMIT: float = 2 * other", ["_LIMIT"]),
        ("LOW, HIGH = 1, 2", ["LOW, HIGH"]),
        ('LIMIT = 3\n"""Why."""', []),
        ('LOW = 1\nHIGH = 2\n"""Why."""', []),
        ('LOW = 1\n\nHIGH = 2\n"""Why."""', ["LOW"]),
        ('LIMIT = 3\n\n"""Of something else."""', ["LIMIT"]),
        ('NAMES = ("M", "N")', []),
        ("limit = 3", []),
    ],
)
def test_the_search_for_bare_numbers_finds_them(code: str, found: list[str]) -> None:
    """The rule above is only worth what its detector sees."""
    assert [names for _, names in unexplained(ast.parse(code))] == found
