"""Values and their 95 % intervals as people read them."""

from __future__ import annotations

import math

from softid.results import ParameterEstimate

FEWEST_DIGITS = 4
"""Significant digits of an end in a table, unless its width asks for more."""

MOST_DIGITS = 9
"""More would show the rounding of the search."""

NO_LIMIT = "no limit"
"""What is said where the logs limit a value on neither side."""


def interval_in_words(
    ci95: tuple[float | None, float | None] | None,
    *,
    lower: float | None = None,
    upper: float | None = None,
    value: float | None = None,
    fewest_digits: int = FEWEST_DIGITS,
) -> str:
    """A confidence interval; an end that is open, or not within the bounds of the search, is none.

    Parameters
    ----------
    ci95
        Its ends; None gives no words.
    lower, upper
        Bounds of the search.
    value
        What the interval is of, where the width of a half tells the digits.
    fewest_digits
        Significant digits, or as many as show the width to two.

    Examples
    --------
    >>> interval_in_words((0.12, 3.4)), interval_in_words((1e-30, 2.0), lower=1e-15)
    ('[0.12, 3.4]', 'at most 2')
    >>> interval_in_words((0.01429572, 0.01431257))
    '[0.014296, 0.014313]'
    """
    if ci95 is None:
        return ""
    low, high = _ends(ci95, lower, upper)
    digits = _digits((low, high, value), fewest_digits)
    if low is None and high is None:
        return NO_LIMIT
    if low is None:
        return f"at most {high:.{digits}g}"
    if high is None:
        return f"at least {low:.{digits}g}"
    return f"[{low:.{digits}g}, {high:.{digits}g}]"


def value_in_words(p: ParameterEstimate, *, fewest_digits: int = FEWEST_DIGITS) -> str:
    """A value with as many digits as its interval, the interval, and the unit.

    Parameters
    ----------
    p
        The parameter.
    fewest_digits
        As in `interval_in_words`.
    """
    told = interval_in_words(
        p.ci95, lower=p.lower, upper=p.upper, value=p.value, fewest_digits=fewest_digits
    )
    if told and not told.startswith("["):
        told = f"({told})"
    unit = "" if p.unit == "1" else p.unit
    return " ".join(
        filter(None, (number_in_words(p.value, p, fewest_digits=fewest_digits), told, unit))
    )


def number_in_words(
    number: float, p: ParameterEstimate, *, fewest_digits: int = FEWEST_DIGITS
) -> str:
    """A number of the size of a parameter, with as many digits as its value has.

    Parameters
    ----------
    number
        The value, or what is told in its place.
    p
        The parameter.
    fewest_digits
        As in `interval_in_words`.
    """
    ends = _ends(p.ci95, p.lower, p.upper)
    return f"{number:.{_digits((*ends, p.value), fewest_digits)}g}"


def _ends(
    ci95: tuple[float | None, float | None] | None, lower: float | None, upper: float | None
) -> tuple[float | None, float | None]:
    """The ends that are numbers and within the bounds."""
    low, high = ci95 or (None, None)
    if low is not None and (not math.isfinite(low) or (lower is not None and low <= lower)):
        low = None
    if high is not None and (not math.isfinite(high) or (upper is not None and high >= upper)):
        high = None
    return low, high


def _digits(numbers: tuple[float | None, ...], fewest: int) -> int:
    """Significant digits of the largest number that show how far all are apart, to two of its."""
    known = [number for number in numbers if number is not None]
    width = max(known, default=0.0) - min(known, default=0.0)
    if not 0.0 < width < math.inf:
        return fewest
    largest = max(map(abs, known))
    decades = math.floor(math.log10(largest)) - math.floor(math.log10(width))
    return min(max(decades + 2, fewest), MOST_DIGITS)
