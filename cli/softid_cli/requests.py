"""What the user asked of a command, as one frozen value whose fields are the options."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from softid.errors import UsageError
from softid_cli.model_options import chosen_model
from softid_cli.options import named_if

if TYPE_CHECKING:
    from softid.models.base import Model

Asked = TypeVar("Asked")


@dataclass(frozen=True)
class Request:
    """The options of a command that finds a model in logs."""

    logs: tuple[Path, ...]
    hold_out: tuple[Path, ...] = ()
    model: str | None = None
    damping: str | None = None
    fixed_length: float | None = None
    diameter: float | None = None
    geometry: Path | None = None
    option: tuple[str, ...] = ()
    channel: tuple[str, ...] = ()
    input: str | None = None
    output: tuple[str, ...] = ()
    intersample: str | None = None
    out: Path | None = None
    force: bool = False
    no_plots: bool = False
    seed: int = 0
    as_json: bool = False
    quiet: bool = False

    def require_logs(self, verb: str) -> None:
        """Refuse to ``verb`` without a log.

        Raises
        ------
        UsageError
            No log was given, or all of them are held out.
        """
        if not self.logs:
            at_least = "name at least one log"
            raise UsageError(
                f"no log was given to {verb}",
                remedy=f"{at_least} before --hold-out" if self.hold_out else at_least,
            )

    @property
    def options_of_model(self) -> tuple[str, ...]:
        """Options that say which model it is, of those that were given."""
        return named_if(
            {
                "--model": self.model is not None,
                "--damping": self.damping,
                "--fixed-length": self.fixed_length,
                "--diameter": self.diameter,
                "--geometry": self.geometry,
                "--option": self.option,
            }
        )

    def chosen_model(self) -> Model | None:
        """The model that the options describe, or None when softid is to choose.

        Raises
        ------
        UsageError
            There is no such model, or it does not have an option that was given.
        """
        return chosen_model(
            self.model,
            damping=self.damping,
            fixed_length_mm=self.fixed_length,
            diameter_mm=self.diameter,
            geometry=self.geometry,
            other=self.option,
        )


def takes(kind: Callable[..., Asked]) -> Callable[[Callable[[Asked], None]], Callable[..., None]]:
    """Let a command take all its options as one value, which ``kind`` makes of them.

    Parameters
    ----------
    kind
        A dataclass with a field for every option and argument of the command.

    Examples
    --------
    >>> @takes(Request)
    ... def tell(request: Request) -> None:
    ...     print(request.seed, request.quiet)
    >>> tell(logs=(), seed=3, quiet=True)
    3 True
    """

    def taking(command: Callable[[Asked], None]) -> Callable[..., None]:
        @wraps(command)
        def called(**parsed: Any) -> None:
            command(kind(**parsed))

        return called

    return taking
