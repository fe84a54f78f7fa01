"""What an effect is called in plain words."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Wording:
    """What an effect is called, what happens, and what to do in hardware."""

    title: str
    meaning: str
    remedy: str
