"""What a column's name says: the quantity, the unit and how surely."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

from softid.channels import COMMAND_WORDS
from softid.units import CHANNEL_QUANTITY, Unit, lookup_unit

EXACT, SYNONYM, LOOKALIKE = 0, 1, 2
"""How well a name fits a channel: softid's own word, another word for it, a word beside others."""

_PLAIN = (EXACT, SYNONYM)
"""Fits of a name that say plainly what the column is, so that two such columns are one question."""

_WORDS: dict[str, tuple[str, ...]] = {
    "time": ("time", "t", "timestamp", "datetime", "elapsed", "zeit"),
    "pressure": ("pressure", "p", "press", "druck"),
    "angle": ("angle", "theta", "phi", "bend", "bending", "winkel", "θ", "φ", "ϕ"),
    "contraction": ("contraction", "kontraktion"),
    "length": ("length", "len", "länge"),
    "distance": ("distance", "dist", "abstand"),
    "position": ("position", "pos", "displacement", "stroke", "weg", "hub"),
    "torque": ("torque", "moment", "drehmoment"),
    "force": ("force", "kraft"),
}
_CHANNEL_OF_WORD = {word: channel for channel, words in _WORDS.items() for word in words}
_SHORT = {word for word in _CHANNEL_OF_WORD if len(word) == 1}
_HARMLESS = frozenset(
    [
        "meas",
        "measured",
        "measurement",
        "actual",
        "act",
        "sensor",
        "value",
        "val",
        "signal",
        "reading",
        "ist",
        "fb",
        "feedback",
        "gauge",
        "stamp",
    ]
)
_SOMETHING_ELSE = frozenset(
    [
        "error",
        "err",
        "rate",
        "dot",
        "speed",
        "velocity",
        "vel",
        "acc",
        "acceleration",
        "std",
        "noise",
        "var",
        "variance",
        "volt",
        "voltage",
        "adc",
        "count",
        "counts",
        "flag",
        "valid",
        "status",
        "pwm",
        "supply",
        "ambient",
        "atmospheric",
        "atm",
        "tank",
        "baro",
        "gain",
        "constant",
        "temp",
        "temperature",
        "delay",
        "effort",
    ]
)
_INDEX_NAMES = frozenset(
    {"", "index", "idx", "unnamed: 0", "#", "no", "no.", "nr", "row", "sample", "n", "i", "id"}
)

_LONG_NAME = 8
"""Letters of a channel's name in which two slips of typing are still one."""

_BRACKETED = re.compile(r"(.*?)\s*([\[(<{])\s*([^\[\](){}<>]*?)\s*[\])>}]\s*")
_SLASHED = re.compile(r"(.*\S)\s*/\s*(\S+)")
_LAST_TOKEN = re.compile(r"(.*[^\s_.\-:,])[\s_.\-:,]+([^\s_.\-:,]+)")
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_WORD = re.compile(r"[^\W\d_]+|\d+")
# As the last part of a name these are units only where the quantity fits: inlet, minimum, index.
_AMBIGUOUS_UNITS = frozenset(
    {"in", "min", "m", "n", "s", "h", "hr", "mn", "nm", "atm", "degree", "second", "minute"}
    | {"hour", "rev"}
)


_SIGNAL_UNITS = {
    "v": "V",
    "volt": "V",
    "volts": "V",
    "mv": "mV",
    "ma": "mA",
    "count": "count",
    "counts": "count",
    "adc": "count",
}
"""What a gauge delivers before anybody has said how much of its quantity that is."""


@dataclass(frozen=True)
class ColumnName:
    """A column's name, taken apart.

    Attributes
    ----------
    text
        The name as written.
    words
        Its words and numbers in lower case, without the unit.
    unit
        The unit in it, as written, or None.
    """

    text: str
    words: tuple[str, ...]
    unit: str | None

    @property
    def known_unit(self) -> Unit | None:
        """The unit, where it is a frequent one."""
        return lookup_unit(self.unit) if self.unit else None


@lru_cache(maxsize=1024)
def read_name(text: str) -> ColumnName:
    """Take a column's name apart.

    Examples
    --------
    >>> read_name("P1_kPa")
    ColumnName(text='P1_kPa', words=('p', '1'), unit='kPa')
    >>> read_name("bending angle [deg]").words
    ('bending', 'angle')
    """
    stripped = text.strip()
    bracketed = _BRACKETED.fullmatch(stripped)
    if bracketed and bracketed[1]:
        stem, bracket, inside = bracketed[1], bracketed[2], bracketed[3]
        if inside and (bracket == "[" or lookup_unit(inside)):
            return ColumnName(text, _words(stem), inside)
    for pattern in (_SLASHED, _LAST_TOKEN):
        match = pattern.fullmatch(stripped)
        if match and _is_unit_of(match[2], _words(match[1])):
            return ColumnName(text, _words(match[1]), match[2])
    whole = lookup_unit(stripped)
    if whole and whole.quantity == "time" and stripped.lower() not in {"min", "ns"}:
        return ColumnName(text, ("time",), stripped)
    return ColumnName(text, _words(stripped), None)


def bracketed_text(text: str) -> str | None:
    """What stands in brackets at the end of a name, be it a unit or not.

    Examples
    --------
    >>> bracketed_text("pressure (furlong)"), bracketed_text("pressure_kpa")
    ('furlong', None)
    """
    match = _BRACKETED.fullmatch(text.strip())
    return match[3] or None if match else None


def signal_unit(text: str) -> str | None:
    """Volts, milliamperes or counts of a converter, where a name ends in them or is one of them.

    Examples
    --------
    >>> signal_unit("pressure_V"), signal_unit("p [mA]"), signal_unit("p/V"), signal_unit("mA")
    ('V', 'mA', 'V', 'mA')
    >>> signal_unit("pressure_kPa") is None
    True
    """
    stripped = text.strip()
    parted = _SLASHED.fullmatch(stripped) or _LAST_TOKEN.fullmatch(stripped)
    unit = bracketed_text(text) or (parted[2] if parted else stripped)
    return _SIGNAL_UNITS.get(unit.lower())


def match_channel(name: ColumnName) -> tuple[str, int] | None:
    """The channel that a name means and how surely; None when it means none."""
    words = set(name.words)
    heads = [word for word in name.words if word in _CHANNEL_OF_WORD]
    if words & _SOMETHING_ELSE:
        return None
    if not heads:
        is_pressure = name.known_unit is not None and name.known_unit.quantity == "pressure"
        return ("pressure_command", LOOKALIKE) if is_pressure and words & COMMAND_WORDS else None
    head = heads[-1]
    channel = _CHANNEL_OF_WORD[head]
    extra = [w for w in name.words if w != head and w not in _HARMLESS]
    commanded = bool(words & COMMAND_WORDS) or {"set", "point"} <= words
    if commanded:
        if channel != "pressure":
            return None
        channel = "pressure_command"
        extra = [w for w in extra if w not in COMMAND_WORDS and w != "point"]
    if head in _SHORT and not _short_word_fits(name, channel, extra):
        return None
    if extra:
        return channel, LOOKALIKE
    plain = ("pressure", "cmd"), ("pressure", "command"), (channel,)
    return channel, EXACT if name.words in plain else SYNONYM


def _short_word_fits(name: ColumnName, channel: str, extra: Sequence[str]) -> bool:
    """One letter means a channel only with a fitting unit, or alone but for a number."""
    unit = name.known_unit
    if unit is not None:
        return unit.quantity == CHANNEL_QUANTITY[channel]
    return name.unit is None and all(word.isdigit() for word in extra)


def _is_unit_of(token: str, words: Sequence[str]) -> bool:
    """Whether the last part of a name is a unit; a doubtful one has to fit the quantity."""
    unit = lookup_unit(token)
    if unit is None or token.lower() not in _AMBIGUOUS_UNITS:
        return unit is not None
    heads = [word for word in words if word in _CHANNEL_OF_WORD]
    return bool(heads) and CHANNEL_QUANTITY[_CHANNEL_OF_WORD[heads[-1]]] == unit.quantity


def is_time_name(text: str) -> bool:
    """Whether a name plainly means the time."""
    matched = match_channel(read_name(text))
    return matched is not None and matched[0] == "time" and matched[1] <= SYNONYM


def is_index_name(text: str) -> bool:
    """Whether a name is one that is given to a column that only counts rows."""
    return text.strip().lower() in _INDEX_NAMES


def meant_channel(name: str) -> str | None:
    """The known channel that somebody meant who asked for one of another name; None for none.

    That is another word for it, or its name with a slip of typing. A number in the name or a word
    beside it tells a channel of the user's own, such as ``pressure_2``.

    Examples
    --------
    >>> [meant_channel(name) for name in ("angel", "theta", "pressure_2", "range", "angle")]
    ['angle', 'angle', None, None, None]
    """
    if name in CHANNEL_QUANTITY or any(c.isdigit() for c in name):
        return None
    written = name.strip().lower()
    slips = {known: _slips(written, known) for known in CHANNEL_QUANTITY}
    nearest = min(slips, key=lambda known: slips[known])
    if slips[nearest] <= (1 if len(nearest) < _LONG_NAME else 2):
        return nearest
    matched = match_channel(read_name(name))
    return matched[0] if matched is not None and matched[1] in _PLAIN else None


def _slips(text: str, name: str) -> int:
    """Fewest letters left out, put in, mistaken or exchanged with the next between two names."""
    rows = [list(range(len(name) + 1))]
    for i, letter in enumerate(text, start=1):
        row = [i]
        for j, wanted in enumerate(name, start=1):
            cost = min(rows[-1][j] + 1, row[j - 1] + 1, rows[-1][j - 1] + (letter != wanted))
            if i > 1 and j > 1 and letter == name[j - 2] and text[i - 2] == wanted:
                cost = min(cost, rows[-2][j - 2] + 1)
            row.append(cost)
        rows.append(row)
    return rows[-1][-1]


def best_matches(names: Sequence[str], free: Iterable[int]) -> dict[str, tuple[int, ...]]:
    """Columns that could be each channel, the surest kind of match only.

    Parameters
    ----------
    names
        All column names.
    free
        Indices of the columns that may be taken.

    Returns
    -------
    dict
        Channel → indices; more than one where the names do not decide. Of two plain names for the
        time softid's own wins, for a clock beside the seconds says the same once more.
    """
    found: dict[str, dict[int, list[int]]] = {}
    for index in free:
        matched = match_channel(read_name(names[index]))
        if matched:
            channel, rank = matched
            if rank in _PLAIN and channel != "time":
                rank = EXACT
            found.setdefault(channel, {}).setdefault(rank, []).append(index)
    return {channel: tuple(ranks[min(ranks)]) for channel, ranks in found.items()}


def _words(stem: str) -> tuple[str, ...]:
    return tuple(word.lower() for word in _WORD.findall(_CAMEL.sub(" ", stem)))
