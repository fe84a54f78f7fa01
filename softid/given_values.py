"""Arrays, names and whole numbers as somebody gives them, made into what the rest relies on."""

from __future__ import annotations

import operator
from collections.abc import Iterable
from datetime import datetime, timedelta
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.errors import InputError, UsageError

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

MOST_LETTERS = 60
"""Letters of a value that is no number which a message shows; more would hide the remedy."""


def as_numbers(given: npt.ArrayLike, *, where: str) -> Array:
    """What was given as numbers, shape (n,); NaN where a mask hides one.

    Raises
    ------
    InputError
        It is no vector, or a value in it is no real number.

    Examples
    --------
    >>> as_numbers(np.ma.array([1, 2, 3], mask=[False, True, False]), where="angle").tolist()
    [1.0, nan, 3.0]
    """
    array = _vector(given, where)
    if array.dtype.kind not in "cmMV":
        try:
            return array.astype(np.float64, copy=False)
        except (TypeError, ValueError, OverflowError):
            pass  # a value that cannot be one, which is told below
    wrong = next((k for k, value in enumerate(array) if not _is_real(value)), 0)
    raise InputError(
        "this is not a real number",
        where=f"{where}, sample {wrong + 1}",
        value=str(array[wrong])[:MOST_LETTERS] if array.size else array.dtype.name,
        remedy="give numbers, and NaN where nothing was recorded",
    )


def as_seconds(given: npt.ArrayLike, *, where: str) -> Array:
    """Times as numbers, shape (n,); dates and durations become seconds since the first of them.

    Raises
    ------
    InputError
        As `as_numbers`, or dates with and without a time zone stand beside each other.

    Examples
    --------
    >>> as_seconds(np.array(["2026-11-21T12:00", "2026-11-21T12:01"], "M8"), where="time").tolist()
    [0.0, 60.0]
    """
    array = _vector(given, where)
    if array.dtype.kind in "mM":
        return since_first(array)
    if array.dtype.kind == "O" and array.size and isinstance(array[0], (datetime, timedelta)):
        try:
            return np.array([_seconds_between(array[0], moment) for moment in array])
        except TypeError:
            raise InputError(
                "these times cannot be subtracted from each other",
                where=where,
                value=f"{array[0]} and others",
                remedy="give all of them as dates, with a time zone or without, or as seconds",
            ) from None
    return as_numbers(array, where=where)


def since_first(moments: npt.NDArray[Any]) -> Array:
    """``datetime64`` or ``timedelta64`` in seconds since the first that is known, to 1 µs."""
    known = moments[~np.isnat(moments)]
    if not known.size:
        return np.full(moments.shape, np.nan)
    kind = f"{moments.dtype.kind}8[us]"
    since: Array = (moments.astype(kind) - known[0].astype(kind)) / np.timedelta64(1, "s")
    return since


def as_mask(given: npt.ArrayLike, count: int, *, where: str) -> BoolArray:
    """What was given as a mask of all samples, shape (n,).

    Raises
    ------
    InputError
        It has another shape, which would be stretched over the log.
    """
    mask = np.asarray(given, bool)
    if mask.shape == (count,):
        return mask
    raise InputError(
        f"the mask has the shape {mask.shape}, the log {count} samples",
        where=where,
        remedy="give one value per sample, True where it is to be left out",
    )


def require_names(given: object, *, where: str) -> tuple[str, ...]:
    """What was given, if it is several names, or none.

    Raises
    ------
    UsageError
        It is one name alone, which would be taken letter by letter, or something else.
    """
    if isinstance(given, Iterable) and not isinstance(given, (str, bytes)):
        names = tuple(given)
        if all(isinstance(name, str) for name in names):
            return names
    raise UsageError(
        "this is not a list of names",
        where=where,
        value=given,
        remedy=f"write {where}=[{given!r}]" if isinstance(given, str) else "give one",
    )


def require_whole(given: object, *, least: int, where: str) -> int:
    """What was given, if it is a whole number that is not too small.

    Raises
    ------
    UsageError
        It is no whole number, or one below the least.

    Examples
    --------
    >>> require_whole(-1, least=0, where="seed")
    Traceback (most recent call last):
    ...
    softid.errors.UsageError: seed: this is not a whole number from 0 on (got -1); give one.
    """
    try:
        number = operator.index(given)  # type: ignore[arg-type]  # what it is for
    except TypeError:
        number = least - 1
    if number >= least:
        return number
    raise UsageError(
        f"this is not a whole number from {least} on", where=where, value=given, remedy="give one"
    )


def _vector(given: npt.ArrayLike, where: str) -> npt.NDArray[Any]:
    """What was given as an array of shape (n,), without its mask."""
    if isinstance(given, np.ma.MaskedArray):
        given = _unmasked(given)
    try:
        array = np.asarray(given)
    except ValueError:  # rows that differ in length
        raise _not_a_vector("rows that differ in length", where) from None
    if array.ndim != 1:
        raise _not_a_vector(f"an array of shape {array.shape}", where)
    return array


def _not_a_vector(met: str, where: str) -> InputError:
    return InputError(
        f"there is not one value per sample but {met}",
        where=where,
        remedy="give an array of shape (n,), as ravel() makes of a single column",
    )


def _unmasked(masked: np.ma.MaskedArray[Any, Any]) -> npt.NDArray[Any]:
    plain = np.array(masked.data)
    hidden = np.ma.getmaskarray(masked)
    if plain.dtype.kind in "biuf":
        return np.where(hidden, np.nan, plain.astype(np.float64))
    if plain.dtype.kind in "mM":
        plain[hidden] = "NaT"
    return plain


def _is_real(value: object) -> bool:
    if isinstance(value, (complex, np.complexfloating, np.datetime64, np.timedelta64)):
        return False
    try:
        float(value)  # type: ignore[arg-type]  # whether it can be one is asked
    except (TypeError, ValueError, OverflowError):
        return value is None
    return True


def _seconds_between(first: Any, moment: Any) -> float:
    return float("nan") if moment is None else float((moment - first).total_seconds())
