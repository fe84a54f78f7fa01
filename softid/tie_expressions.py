"""What the expression of a tie may hold: arithmetic of parameters, and nothing that acts.

lmfit computes a tie with an interpreter that can also read files, and people hand each other the
records that carry ties.
"""

from __future__ import annotations

import ast
from functools import cache
from typing import TypeGuard

from softid.errors import UsageError

FUNCTIONS = ("abs", "cos", "exp", "log", "log10", "max", "min", "sin", "sqrt", "tan")
"""Functions that an expression may call."""

_OF_SEVERAL = ("max", "min")

LONGEST = 1000
"""Characters of an expression; a longer one was not written by a person."""

_ARITHMETIC = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow, ast.USub, ast.UAdd)
_REMEDY = (
    "write it in numbers and the names of other parameters, such as 0.1*c2, with + - * / ** ( ) "
    f"and {', '.join(FUNCTIONS)}"
)


@cache
def names_in_tie(expression: str, *, where: str) -> frozenset[str]:
    """Names of the parameters that an expression takes.

    Parameters
    ----------
    expression
        Right-hand side of a tie.
    where
        Option, parameter or file, for the error.

    Raises
    ------
    UsageError
        The expression is none, or holds something else than arithmetic.

    Examples
    --------
    >>> sorted(names_in_tie("0.1*sqrt(c2) + M", where="parameter a2"))
    ['M', 'c2']
    """
    try:
        tree = ast.parse(expression[: LONGEST + 1].strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        reason = error.msg if isinstance(error, SyntaxError) else "it cannot be parsed"
        raise _refused(f"this is not an expression: {reason}", expression, where) from error
    if len(expression) > LONGEST:
        raise _refused(f"this is longer than {LONGEST} characters", expression[:40] + "…", where)
    names = set()
    waiting: list[ast.AST] = [tree.body]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Name) and node.id not in FUNCTIONS:
            names.add(node.id)
        elif isinstance(node, ast.BinOp | ast.UnaryOp) and isinstance(node.op, _ARITHMETIC):
            parts = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.operand,)
            waiting += parts
        elif _is_call(node):
            waiting += node.args
        elif not _is_number(node):
            said = ast.get_source_segment(expression.strip(), node) or type(node).__name__
            raise _refused(f"a tie cannot hold {said}", expression, where)
    return frozenset(names)


def _is_call(node: ast.AST) -> TypeGuard[ast.Call]:
    if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)) or node.keywords:
        return False
    name, count = node.func.id, len(node.args)
    return name in FUNCTIONS and (count > 1 if name in _OF_SEVERAL else count == 1)


def _is_number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def _refused(what: str, expression: str, where: str) -> UsageError:
    return UsageError(what, where=where, value=expression, remedy=_REMEDY)
