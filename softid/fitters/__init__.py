"""How parameters are found: simultaneous output error, and each paper's own protocol by name."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from softid.fitters import equilibrium, muscle, polynomial, protocol_spread

__all__ = ["equilibrium", "muscle", "polynomial", "protocol_spread"]


def __getattr__(name: str) -> object:
    """Import a protocol when it is first used, for a fit by output error needs none."""
    if name not in __all__:
        raise AttributeError(f"module 'softid.fitters' has no attribute {name!r}")
    return import_module(f"softid.fitters.{name}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
