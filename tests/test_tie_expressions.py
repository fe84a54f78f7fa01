"""A tie is arithmetic of parameters, whether it is typed, set in Python or read from a file."""

from __future__ import annotations

import pytest

from softid.errors import UsageError
from softid.parameters import Parameter, ParameterSet
from softid.tie_expressions import names_in_tie

ALLOWED = {
    "0.1*c2": {"c2"},
    "-(M + 2.5e-3)/c2**2": {"M", "c2"},
    "+sqrt(abs(M)) - max(c2, 0.1)": {"M", "c2"},
    " 0.017 * c2 ": {"c2"},
    "3": set(),
}
REFUSED = {
    "len(open('/etc/passwd').read())*1e-5": "cannot hold len(open('/etc/passwd').read())",
    "open('x')": "cannot hold open('x')",
    "M.real": "cannot hold M.real",
    "M[0]": "cannot hold M[0]",
    "__import__('os')": "cannot hold __import__('os')",
    "sqrt": "cannot hold sqrt",
    "sqrt()": "cannot hold sqrt()",
    "sqrt(M, c2)": "cannot hold sqrt(M, c2)",
    "max(M)": "cannot hold max(M)",
    "sqrt(x=M)": "cannot hold sqrt(x=M)",
    "sqrt(*M)": "cannot hold *M",
    "'a'*3": "cannot hold 'a'",
    "True + M": "cannot hold True",
    "1j*M": "cannot hold 1j",
    "M if M else 1": "cannot hold M if M else 1",
    "[M for M in c2]": "cannot hold [M for M in c2]",
    "(lambda: M)()": "cannot hold (lambda: M)()",
    "M // 2": "cannot hold M // 2",
    "M = 3": "not an expression",
    "3*": "not an expression",
    "": "not an expression",
    "M\0": "not an expression",
    "(" * 300 + "M" + ")" * 300: "not an expression",
    "M" * 1001: "longer than 1000 characters",
}


@pytest.mark.parametrize("expression", ALLOWED)
def test_arithmetic(expression: str) -> None:
    assert names_in_tie(expression, where="here") == ALLOWED[expression]
    assert Parameter("a", 1.0, tie=expression).tie == expression


@pytest.mark.parametrize("expression", REFUSED)
def test_anything_else(expression: str) -> None:
    with pytest.raises(UsageError) as refused:
        names_in_tie(expression, where="here")
    assert REFUSED[expression] in refused.value.what
    assert "such as 0.1*c2" in str(refused.value)
    with pytest.raises(UsageError, match="parameter a"):
        Parameter("a", 1.0, tie=expression)


def test_names_that_only_the_interpreter_knows() -> None:
    """lmfit's interpreter has constants of its own, which a record does not say."""
    declared = ParameterSet((Parameter("M", 1.0), Parameter("N", 1.0, tie="pi*M")))
    with pytest.raises(UsageError, match="there is no parameter pi"):
        declared.to_lmfit()
