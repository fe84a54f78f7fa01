"""Errors that say what is wrong, where, the value met and what to do, and the milder `Issue`.

Every error that a user can cause derives from `SoftidError`; its `exit_code` is what the command
line returns. An `Issue` is the same four facts about something that did not stop the work.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeVar

Severity = Literal["info", "warning", "error"]
Entry = TypeVar("Entry")


class SoftidError(Exception):
    """A failure told in one sentence.

    Parameters
    ----------
    what
        What is wrong, without a full stop: ``"the time runs backward"``.
    where
        File, column, row or option: ``"step.csv, column time_s, row 17"``.
    value
        The offending value as met.
    remedy
        What the user can do, in the imperative and without a full stop.

    Examples
    --------
    >>> str(InputError("the file is empty", where="a.csv", remedy="check how it was recorded"))
    'a.csv: the file is empty; check how it was recorded.'
    """

    exit_code: ClassVar[int] = 3

    def __init__(
        self,
        what: str,
        *,
        where: str | None = None,
        value: object = None,
        remedy: str | None = None,
    ) -> None:
        self.what = what
        self.where = where
        self.value = value
        self.remedy = remedy
        super().__init__(self._sentence())

    def _sentence(self) -> str:
        text = f"{self.where}: {self.what}" if self.where else self.what
        if self.value is not None:
            text += f" (got {self.value!r})"
        if self.remedy:
            text += f"; {self.remedy}"
        return text + "."


class UsageError(SoftidError):
    """The request contradicts itself or names something that does not exist."""

    exit_code = 2


class InputError(SoftidError):
    """A file or array given by the user cannot be used."""

    exit_code = 3


class OutputError(SoftidError):
    """A result cannot be written; nothing partial is left behind."""

    exit_code = 3


class IdentificationError(SoftidError):
    """The data were read but no trustworthy parameters came out of them."""

    exit_code = 4


class MissingExtraError(SoftidError):
    """An optional dependency is needed for what was asked."""

    exit_code = 2


@dataclass(frozen=True)
class Issue:
    """Something noticed on the way that the user should know and that did not stop the work.

    Attributes
    ----------
    code
        Stable identifier in kebab case, for programs: ``"extrapolation"``.
    severity
        ``"info"``, ``"warning"`` or ``"error"``.
    message
        One sentence: what, where, the value.
    remedy
        What to do about it, or None.
    parameter
        The parameter whose value is doubtful, where it is about one.
    """

    code: str
    severity: Severity
    message: str
    remedy: str | None = None
    parameter: str | None = None


def entry_named(
    name: str, table: Mapping[str, Entry], *, unknown: str, where: str | None = None
) -> Entry:
    """The entry of a table that a user named.

    Parameters
    ----------
    name
        What was given.
    table
        Name → entry.
    unknown
        What is wrong if it has none: ``"there is no such model"``.
    where
        Option, for the message.

    Raises
    ------
    UsageError
        The table has no such name; the error lists those that it has.

    Examples
    --------
    >>> entry_named("yeoh", {"muscle": 1, "oscillator": 2}, unknown="there is no such model")
    Traceback (most recent call last):
    ...
    softid.errors.UsageError: there is no such model (got 'yeoh'); choose from muscle, oscillator.
    """
    if name not in table:
        raise UsageError(unknown, where=where, value=name, remedy=f"choose from {', '.join(table)}")
    return table[name]


def refuse_unknown(given: Iterable[str], allowed: Collection[str], *, where: str) -> None:
    """Refuse keys that mean nothing.

    Parameters
    ----------
    given
        Keys that were found.
    allowed
        Keys that are known.
    where
        Where they were found, for the message.

    Raises
    ------
    InputError
        A key is not among those allowed.
    """
    for key in given:
        if key not in allowed:
            raise InputError(
                "this key is unknown",
                where=where,
                value=key,
                remedy=f"choose from {', '.join(allowed)}",
            )
