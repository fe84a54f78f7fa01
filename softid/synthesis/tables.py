"""Frozen records that are filled from TOML tables: types and ranges are checked in one place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from math import inf, isfinite
from typing import (
    Annotated,
    Any,
    ClassVar,
    Literal,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from softid.errors import InputError, refuse_unknown
from softid.sentences import listed

R = TypeVar("R", bound="Checked")


@dataclass(frozen=True)
class Range:
    """Numbers allowed for a field.

    Attributes
    ----------
    above
        Exclusive lower end.
    lower, upper
        Inclusive ends.
    """

    above: float = -inf
    lower: float = -inf
    upper: float = inf

    def holds(self, value: float) -> bool:
        """Whether the number is finite and inside."""
        return isfinite(value) and value > self.above and self.lower <= value <= self.upper

    def __str__(self) -> str:
        parts = []
        if self.above > -inf:
            parts.append(f"above {self.above:g}")
        if self.lower > -inf:
            parts.append(f"at least {self.lower:g}")
        if self.upper < inf:
            parts.append(f"at most {self.upper:g}")
        return listed(parts) or "finite"


Positive = Annotated[float, Range(above=0.0)]
NonNegative = Annotated[float, Range(lower=0.0)]
Fraction = Annotated[float, Range(lower=0.0, upper=0.9)]
Count = Annotated[int, Range(lower=1)]
Decimals = Annotated[int, Range(lower=0, upper=9)]

_NAMES = {float: "a number", int: "a whole number", str: "a text", bool: "true or false"}


@dataclass(frozen=True)
class Checked:
    """A record whose numbers are checked against the `Range` of their field when it is made.

    Raises
    ------
    InputError
        A number is not finite or outside its range.
    """

    def __post_init__(self) -> None:
        for name, hint in get_type_hints(type(self), include_extras=True).items():
            if get_origin(hint) is ClassVar:
                continue
            value = getattr(self, name)
            allowed = _range_of(hint)
            numbers = value if isinstance(value, tuple) else (value,)
            for number in numbers:
                plain = isinstance(number, float | int) and not isinstance(number, bool)
                if plain and not allowed.holds(number):
                    raise InputError(
                        f"{name} is out of range",
                        where=type(self).__name__,
                        value=number,
                        remedy=f"give a value {allowed}",
                    )


def _range_of(hint: Any) -> Range:
    for extra in getattr(hint, "__metadata__", ()):
        if isinstance(extra, Range):
            return extra
    for inner in get_args(hint):
        found = _range_of(inner)
        if found != Range():
            return found
    return Range()


def read_record(
    kind: type[R], table: object, *, where: str, known: Mapping[str, object] | None = None
) -> R:
    """Fill a record from a TOML table.

    Parameters
    ----------
    kind
        A frozen dataclass derived from `Checked`; its fields are the keys that are allowed.
    table
        The table as the TOML parser returned it.
    where
        File and table named in the error.
    known
        Fields that were read elsewhere, name → value; they are not looked for in the table.

    Raises
    ------
    InputError
        An unknown key, a missing key, a value of another type or out of range.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Valve(Checked):
    ...     fill_s: Positive
    >>> read_record(Valve, {"fill_s": 1}, where="a.toml, [valve]")
    Valve(fill_s=1.0)
    """
    given = require_table(table, where=where)
    done = dict(known or {})
    hints = get_type_hints(kind, include_extras=True)
    wanted = [f for f in fields(kind) if f.name not in done]
    refuse_unknown(given, [f.name for f in wanted], where=where)
    for field in wanted:
        if field.name in given:
            done[field.name] = _convert(
                given[field.name], hints[field.name], where=f"{where}, {field.name}"
            )
        elif field.default is MISSING and field.default_factory is MISSING:
            raise InputError(
                f"the key {field.name} is missing", where=where, remedy=f"add {field.name} = …"
            )
    try:
        return kind(**done)
    except InputError as error:
        deeper = error.where not in (None, kind.__name__)
        raise InputError(
            error.what,
            where=f"{where}, {error.where}" if deeper else where,
            value=error.value,
            remedy=error.remedy,
        ) from error


def require_table(value: object, *, where: str) -> dict[str, object]:
    """The value as a table.

    Raises
    ------
    InputError
        It is something else.
    """
    if not isinstance(value, dict):
        raise InputError("a table is expected", where=where, value=value, remedy="write [table]")
    return value


def _convert(value: object, hint: Any, *, where: str) -> object:
    """The TOML value as the type of a field."""
    if get_origin(hint) is Annotated:
        hint = get_args(hint)[0]
    origin = get_origin(hint)
    if origin is Union or type(hint).__name__ == "UnionType":
        return _convert(value, get_args(hint)[0], where=where)  # absent is the only way to None
    if origin is Literal:
        return _one_of(value, get_args(hint), where=where)
    if origin is tuple:
        if not isinstance(value, list) or not value:
            raise InputError(
                "a list is expected", where=where, value=value, remedy="write [ …, … ]"
            )
        return tuple(_convert(item, get_args(hint)[0], where=where) for item in value)
    if hint is float and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    if not isinstance(value, hint) or (isinstance(value, bool) and hint is not bool):
        raise InputError(f"{_NAMES[hint]} is expected", where=where, value=value)
    return value


def _one_of(value: object, choices: tuple[Any, ...], *, where: str) -> object:
    if value not in choices:
        raise InputError(
            "this is not a choice",
            where=where,
            value=value,
            remedy=f"choose from {', '.join(map(str, choices))}",
        )
    return value
