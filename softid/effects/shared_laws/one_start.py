"""Effects that are so nearly linear in their parameters that one start is enough."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from softid.effects.base import Effect
from softid.effects.scale import Scale


@dataclass(frozen=True)
class OneStart(Effect):
    """An effect that is linear, or nearly so, in all of its parameters.

    A step of the search leads to its optimum from anywhere.
    """

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """The moderate values alone."""
        return (self.parameters(scale).values_dict(),)
