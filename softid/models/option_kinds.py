"""What the options of a model are: numbers, whole numbers or texts, as its fields declare them."""

from __future__ import annotations

import math
import typing
from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import cache
from numbers import Real
from typing import Literal

from softid.errors import UsageError

OptionKind = Literal["number", "whole number", "text"]

_KINDS: dict[object, OptionKind] = {float: "number", int: "whole number", str: "text"}
_EXAMPLES = {"number": "2.5", "whole number": "4"}


@cache
def option_kinds(options_class: type) -> Mapping[str, OptionKind]:
    """Option → kind, from the types of a dataclass's fields; switches have none.

    Examples
    --------
    >>> from softid.models.polynomial import Polynomial
    >>> option_kinds(Polynomial)["order"]
    'whole number'
    """
    hints = typing.get_type_hints(options_class)
    kinds = {}
    for option in (f.name for f in fields(options_class)):
        kind = _kind(hints[option])
        if kind is not None:
            kinds[option] = kind
    return kinds


def _kind(hint: object) -> OptionKind | None:
    if typing.get_origin(hint) is Literal:
        return "text"
    inner = (hint, *typing.get_args(hint))  # a union may have None beside it
    return next((_KINDS[one] for one in inner if one in _KINDS), None)


def option_value(text: str, kind: OptionKind, *, where: str) -> float | int | str:
    """What somebody wrote for an option.

    Raises
    ------
    UsageError
        The text is not of its kind.

    Examples
    --------
    >>> option_value("4", "whole number", where="--option order")
    4
    """
    if kind == "text":
        return text
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    _require(value, kind, shown=text, where=where)
    return int(value) if kind == "whole number" else value


def require_kinds(options: object) -> None:
    """Refuse a model that was made with a text for a number, or with a number for a text.

    Parameters
    ----------
    options
        A dataclass whose fields are options.

    Raises
    ------
    UsageError
        A value is not of its kind.
    """
    kinds = option_kinds(type(options))  # type: ignore[arg-type]
    for option, kind in kinds.items():
        value = getattr(options, option)
        if value is not None:
            _require(value, kind, shown=value, where=f"option {option}")


def _require(value: object, kind: OptionKind, *, shown: object, where: str) -> None:
    right = isinstance(value, str) if kind == "text" else _is_number(value, kind)
    if not right:
        raise UsageError(
            f"this is no {kind}",
            where=where,
            value=shown,
            remedy=f"write one such as {_EXAMPLES[kind]}" if kind in _EXAMPLES else "write a word",
        )


def _is_number(value: object, kind: OptionKind) -> bool:
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    number = float(value)
    return number.is_integer() if kind == "whole number" else abs(number) < math.inf


def require_choice(option: str, value: object, choices: Sequence[str]) -> None:
    """Refuse a model option that is not one of its choices.

    Raises
    ------
    UsageError
        The value is none of them.
    """
    if value not in choices:
        raise UsageError(
            f"the model has no such {option}",
            where=f"option {option}",
            value=value,
            remedy=f"choose from {', '.join(choices)}",
        )
