"""Arguments of the public functions that are not what they have to be, told in one sentence."""

from __future__ import annotations

import math
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING

from softid.errors import UsageError
from softid.log import Log
from softid.parameters import ParameterSet

if TYPE_CHECKING:
    import lmfit

MAKE_A_LOG = "make one of your arrays with softid.Log.from_arrays"
"""What to do with numbers that are in memory."""

MOST_PERCENT = 100.0
"""A fit in per cent of this is perfect."""


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


def require_parameters(given: object) -> ParameterSet | lmfit.Parameters:
    """What was given, if it is a set of parameters.

    Raises
    ------
    UsageError
        It is something else, such as a dict of values.
    """
    if isinstance(given, ParameterSet):
        return given
    import lmfit  # a second, which only its own parameters need, and they have it in memory

    if isinstance(given, lmfit.Parameters):
        return given
    remedy = "give lmfit Parameters, or the model's own parameters() with your changes"
    raise refused("a set of parameters", given, remedy)


def require_percent(given: object, *, where: str) -> float:
    """What was given, if it is a finite number of 100 at most.

    Raises
    ------
    UsageError
        It is something else, such as text or nan.
    """
    if isinstance(given, Real) and -math.inf < float(given) <= MOST_PERCENT:
        return float(given)
    raise UsageError(
        "this is not a number of per cent, 100 at most",
        where=where,
        value=given,
        remedy="give one, such as 70",
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
    if isinstance(given, type):
        met = f"the class {given.__name__}"
    else:
        met = str(given) if isinstance(given, (str, Path)) else type(given).__name__
    return UsageError(f"this is not {wanted}", value=met, remedy=remedy)
