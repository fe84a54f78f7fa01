"""Arguments of the public functions that are not what they have to be, told in one sentence."""

from __future__ import annotations

from pathlib import Path

from softid.errors import UsageError
from softid.log import Log

MAKE_A_LOG = "make one of your arrays with softid.Log.from_arrays"
"""What to do with numbers that are in memory."""


def require_log(given: object) -> Log:
    """What was given, if it is a log.

    Raises
    ------
    UsageError
        It is something else, such as the name of a file.

    Examples
    --------
    >>> require_log("step.csv")
    Traceback (most recent call last):
    ...
    softid.errors.UsageError: this is not a log (got 'step.csv'); read it with softid.load first.
    """
    if isinstance(given, Log):
        return given
    path = isinstance(given, (str, Path))
    raise refused("a log", given, f"{'read it with softid.load' if path else MAKE_A_LOG} first")


def require_explainable(given: object) -> Log:
    """What was given, if it is a log with something to explain.

    Raises
    ------
    UsageError
        It is no log, or one that was read for its input alone.
    """
    log = require_log(given)
    if log.outputs:
        return log
    raise UsageError(
        "the log has no output, so there is nothing to explain",
        where=log.place,
        remedy="read it without outputs=None, or name its outputs",
    )


def refused(wanted: str, given: object, remedy: str) -> UsageError:
    """The error about an argument of another kind; names are quoted, of the rest the type is told.

    Parameters
    ----------
    wanted
        What it should have been, with its article.
    given
        What was given.
    remedy
        What to do, in the imperative.
    """
    met = str(given) if isinstance(given, (str, Path)) else type(given).__name__
    return UsageError(f"this is not {wanted}", value=met, remedy=remedy)
