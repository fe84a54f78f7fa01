"""Small parts of the sentences in which a diagnosis is told."""

from __future__ import annotations

from collections.abc import Sequence

from softid.diagnoses import NOTABLE, Remainder
from softid.effects import EFFECTS

VARIABLES = {
    "x": "the position",
    "v": "the speed",
    "p": "the input",
    "rate of p": "the rate of the input",
    "lagged p": "the input a while before",
    "t": "the time",
    "x and v": "position and speed together",
}
MOST_VARIABLES = 2


def variables_left(remainder: Remainder) -> list[str]:
    """The variables that predict most of what is left, in words; none where chance does as well."""
    if not remainder.predictable:
        return []
    ranked = sorted(remainder.by.items(), key=lambda item: -item[1])
    return [VARIABLES.get(k, k) for k, share in ranked if share > NOTABLE][:MOST_VARIABLES]


def title_of(key: str) -> str:
    """The heading of an effect within a sentence."""
    if key not in EFFECTS:
        return key
    title = EFFECTS[key].title
    return lowered(title)


def titles_of(effects: Sequence[str], *, last: str = " and ") -> str:
    """The headings of several effects within a sentence."""
    return listed([title_of(name) for name in effects], last=last)


def listed(parts: Sequence[str], *, last: str = " and ") -> str:
    """Parts joined as in a sentence."""
    return last.join(filter(None, (", ".join(parts[:-1]), parts[-1]))) if parts else ""


def lowered(text: str) -> str:
    """The text with a small first letter."""
    return text[:1].lower() + text[1:]


def percent(value: float) -> str:
    """A share in per cent."""
    return f"{100.0 * value:.0f} %"


def percent_range(interval: tuple[float, float]) -> str:
    """An interval of shares in per cent."""
    return f"{100.0 * interval[0]:z.0f} to {100.0 * interval[1]:z.0f} %"
