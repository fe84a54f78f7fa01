"""A stand-in for the library, and what a command left behind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from softid.log import Log


@dataclass(frozen=True)
class Outcome:
    """What a command left."""

    code: int
    out: str
    err: str


@dataclass
class Desk:
    """Stands in for the library: what it was asked, and what it answers."""

    asked: dict[str, Any]
    answer: Any

    def fit(self, logs: Sequence[Log], **options: Any) -> Any:
        self.asked = {"logs": [log.name for log in logs], **options}
        if isinstance(self.answer, BaseException):
            raise self.answer
        return self.answer
