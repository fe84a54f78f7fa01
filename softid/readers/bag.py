"""ROS bags: ROS 1 (.bag) and ROS 2 (.db3, .mcap), of which only topics with numbers are read."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.errors import InputError, Issue, MissingExtraError
from softid.fingerprint import content_fingerprint
from softid.readers import files
from softid.readers.bag_messages import NOT_NUMBERS, TopicRecord, layout_of
from softid.readers.bag_times import Rows, chosen_times, rows_of
from softid.readers.base import Array, Head, IntArray, Table, first_names, sample_rows
from softid.readers.columns import is_time_name

_BYTES_PER_NUMBER = 8
_METADATA = "metadata.yaml"
_SIGNATURES: Mapping[str, bytes] = {
    ".bag": b"#ROSBAG V2.0\n",
    ".db3": b"SQLite format 3\x00",
    ".mcap": b"\x89MCAP0\r\n",
}
_REPAIRS: Mapping[str, str] = {
    ".bag": "repair it with rosbag reindex",
    ".db3": "save what is left with: sqlite3 FILE .recover",
    ".mcap": "repair it with mcap recover",
}
_USUAL_UNITS = {
    "angle": "rad",
    "torque": "N·m",
    **dict.fromkeys(("position", "distance", "length", "contraction"), "m"),
}


@dataclass(frozen=True, eq=False)
class BagColumn:
    """One column.

    Attributes
    ----------
    rows
        Row of each message of its topic, counted from 0.
    values
        The number in each.
    """

    rows: IntArray
    values: Array


@dataclass(frozen=True, eq=False)
class BagTable(Table):
    """The time, then the columns of all topics, each with numbers at its own messages only.

    Attributes
    ----------
    seconds
        Time of every row since the first.
    columns
        Those after the time.
    """

    seconds: Array
    columns: Sequence[BagColumn]

    @property
    def only_on_request(self) -> bool:
        """Whether all columns together, with a cell in every row, would be too large to hold."""
        return len(self.head.names) * self.rows.size * _BYTES_PER_NUMBER > files.SIZE_LIMIT_BYTES

    @property
    def is_timed_in_s(self) -> bool:
        """True, however close messages of different topics come."""
        return True

    @property
    def usual_units(self) -> Mapping[str, str]:
        """The units of ROS (REP 103)."""
        return _USUAL_UNITS

    def numbers(self, index: int) -> Array:
        """One column as numbers, NaN in the rows of other topics."""
        if index == 0:
            return self.seconds
        column = self.columns[index - 1]
        values = np.full(self.rows.size, np.nan)
        values[column.rows] = column.values
        return values

    def timestamps(self, index: int) -> None:
        """None, for the times are numbers."""
        del index

    def rows_with(self, names: Collection[str]) -> npt.NDArray[np.bool_]:
        """Which rows are messages of topics with one of these columns."""
        held = np.zeros(self.rows.size, dtype=bool)
        for name, column in zip(self.head.names[1:], self.columns, strict=True):
            if name in names:
                held[column.rows] = True
        return held


def read_bag(path: Path) -> Table:
    """Read the numbers in the messages of a ROS bag.

    Every number of a message is a column, named by topic and field (``/ft.wrench.force.x``); the
    time is in s since the first row. Where a ``metadata.yaml`` beside a ROS 2 file lists it, all
    files of that recording are read together.

    Parameters
    ----------
    path
        File that ends in ``.bag``, ``.db3`` or ``.mcap``.

    Raises
    ------
    MissingExtraError
        rosbags is not installed.
    InputError
        The file is damaged, empty or no bag, or holds no numbers or too many.
    """
    if files.require_file(path) == 0:
        raise InputError("the file is empty", where=str(path), remedy="check how it was recorded")
    _require_signature(path)
    try:
        from rosbags.highlevel import AnyReader  # 0.15 s, and an optional dependency
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise MissingExtraError(
            "reading ROS bags needs rosbags, which is not installed",
            where=str(path),
            remedy="install it with: pip install softid[ros]",
        ) from None
    parts = _recording(path)
    newest = [store for store in Stores if store.name.startswith("ROS2_")][-1]
    default = get_typestore(newest) if path.suffix != ".bag" else None
    try:
        with AnyReader([parts[0].parent if parts else path], default_typestore=default) as reader:
            content = _Content(path, reader)
            content.read()
    except InputError:
        raise
    except Exception as error:  # damaged files raise whatever rosbags meets
        raise _damaged(path, parts) from error
    return _table(path, parts or [path], content)


class _Content:
    """What is read of a bag, and what is not."""

    def __init__(self, path: Path, reader: Any) -> None:
        self.path = path
        self.reader = reader
        self.records: dict[str, TopicRecord] = {}
        self.facts: dict[str, str] = {}
        self.left_out: list[str] = []
        self.undecoded: dict[str, TopicRecord] = {}

    def read(self) -> None:
        """Read all messages of the topics that hold numbers."""
        chosen = [c for c in self.reader.connections if self._is_wanted(c)]
        held = 0
        for connection, received_ns, data in self.reader.messages(chosen) if chosen else ():
            record = self.records.get(connection.topic)
            if record is None:
                continue
            try:
                record.add(self.reader.deserialize(data, connection.msgtype), received_ns)
            except Exception:  # noqa: BLE001 - one topic of another definition, or damage
                self.undecoded[connection.topic] = self.records.pop(connection.topic)
            held += (len(record.columns) + 2) * _BYTES_PER_NUMBER
            if held > files.SIZE_LIMIT_BYTES:
                limit = files.SIZE_LIMIT_BYTES / files.MEGABYTE
                raise files.too_large(self.path, f"over {limit:.0f} MB of numbers")
        self.records = {t: r for t, r in self.records.items() if len(r.received_ns)}

    def _is_wanted(self, connection: Any) -> bool:
        topic, kind = connection.topic, connection.msgtype
        count = sum(c.msgcount for c in self.reader.connections if c.topic == topic)
        self.facts[f"topic {topic}"] = f"{kind}, {count} messages"
        if topic in self.records:
            if self.records[topic].kind == kind:
                return True
            self.left_out.append(f"{topic} as {kind} (a second type)")
            return False
        if kind in NOT_NUMBERS:
            self._leave_out(f"{topic} ({NOT_NUMBERS[kind]})")
            return False
        try:
            layout = layout_of(kind, self.reader.typestore.fielddefs)
        except KeyError:
            self._leave_out(f"{topic} (no definition of {kind} in the bag)")
            return False
        self.left_out += [f"{topic}.{path}" for path in layout.left_out]
        if layout.fields:
            self.records[topic] = TopicRecord(topic, kind, layout)
        return bool(layout.fields)

    def _leave_out(self, what: str) -> None:
        if what not in self.left_out:
            self.left_out.append(what)


def _table(path: Path, parts: Sequence[Path], content: _Content) -> BagTable:
    records = list(content.records.values())
    if not records:
        raise _without_numbers(path, content)
    times, issues = chosen_times(records, str(path))
    rows = rows_of(times)
    if rows.seconds.size * _BYTES_PER_NUMBER > files.SIZE_LIMIT_BYTES:
        raise files.too_large(path, f"{rows.seconds.size} messages")
    names, units, columns = _columns(records, rows)
    left_out = [*content.left_out, *(f"{t} (not decoded)" for t in content.undecoded)]
    for record in records:
        left_out += [f"{name} ({why})" for name, why in record.odd.items()]
    if len(parts) > 1:
        issues = (_read_together(path, parts), *issues)
    head = Head(
        path=str(path),
        sha256=_fingerprint(parts),
        file_format="bag",
        names=("time", *names),
        units=("s", *units),
        metadata=content.facts,
        issues=(*_left_out(path, left_out), *issues),
        unaligned=_unaligned(path, records, content.undecoded.values()),
    )
    return BagTable(head, sample_rows(rows.seconds.size), "sample", rows.seconds, columns)


def _columns(
    records: Sequence[TopicRecord], rows: Rows
) -> tuple[list[str], list[str | None], list[BagColumn]]:
    names: list[str] = []
    units: list[str | None] = []
    columns = []
    for record, at in zip(records, rows.of_topic, strict=True):
        for name, values in record.columns.items():
            # A topic /time is not the time of the rows, so its field is told.
            names.append(f"{name}.data" if is_time_name(name) else name)
            units.append(record.units[name])
            columns.append(BagColumn(at, np.asarray(values, dtype=np.float64)))
    return names, units, columns


def _fingerprint(parts: Sequence[Path]) -> str:
    """Of one file its own; of several that of theirs, whichever of them was named."""
    each = [files.file_fingerprint(part) for part in parts]
    return each[0] if len(each) == 1 else content_fingerprint("".join(each).encode())


def _recording(path: Path) -> list[Path]:
    """The files that metadata.yaml beside a ROS 2 file lists, if this one is among them."""
    if path.suffix == ".bag" or path.parent.suffix == ".bag":  # rosbags takes this for ROS 1
        return []
    listed: list[Path] = []
    with suppress(OSError, UnicodeDecodeError):
        for line in (path.parent / _METADATA).read_text(encoding="utf-8").splitlines():
            entry = line.strip()
            if entry.startswith("- ") and ": " not in entry:  # an old one has folders before it
                listed.append(path.parent / PurePosixPath(entry[2:].strip(" \"'")).name)
    parts = [part for part in dict.fromkeys(listed) if part.suffix == path.suffix]
    return parts if path.parent / path.name in parts else []


def _require_signature(path: Path) -> None:
    """Refuse what is no bag of the kind that the name's ending says."""
    if path.suffix not in _SIGNATURES:
        raise InputError(
            "the ending of a bag's name is written in small letters",
            where=str(path),
            value=path.suffix,
            remedy=f"rename the file to {path.suffix.lower()}",
        )
    first = files.first_bytes(path, max(map(len, _SIGNATURES.values())))
    if first.startswith(_SIGNATURES[path.suffix]):
        return
    other = [ending for ending, signature in _SIGNATURES.items() if first.startswith(signature)]
    raise InputError(
        "this is not a ROS bag that can be read: its first bytes are not those of the format",
        where=str(path),
        remedy=f"rename the file to {other[0]}"
        if other
        else "check the name's ending, or copy the file again from where it was recorded",
    )


def _damaged(path: Path, parts: Sequence[Path]) -> InputError:
    missing = [part.name for part in parts if not part.exists()]
    if missing:
        return InputError(
            f"{_METADATA} beside it lists what is not there: {first_names(missing)}",
            where=str(path),
            remedy="copy all files of the recording together, or this one to a folder of its own",
        )
    return InputError(
        "this is not a ROS bag that can be read: it is damaged or ends too early",
        where=str(path),
        remedy=f"copy it again from where it was recorded, or {_REPAIRS[path.suffix]}",
    )


def _without_numbers(path: Path, content: _Content) -> InputError:
    if content.undecoded:
        return InputError(
            f"no message of {first_names(list(content.undecoded))} can be decoded",
            where=str(path),
            remedy=f"copy the {_METADATA} of the recording beside it, or record with a newer ROS, "
            "which writes the definitions of messages into the bag",
        )
    topics = [f"{k.removeprefix('topic ')} ({v})" for k, v in content.facts.items()]
    return InputError(
        f"the bag holds no messages with numbers ({first_names(topics) or 'no topics'})",
        where=str(path),
        remedy="record the topics of the pressure and of the motion",
    )


def _unaligned(
    path: Path, records: Sequence[TopicRecord], undecoded: Collection[TopicRecord]
) -> dict[str, InputError]:
    """Columns that would be there, with the error to raise where one is needed."""
    found = {}
    for record in records:
        for name, why in record.odd.items():
            found[name] = InputError(
                f"{name} is {why}, and cannot be made columns",
                where=str(path),
                remedy="publish the number that is meant in a field of its own",
            )
    for record in undecoded:
        for number in record.layout.fields:
            name = number.column(record.topic)
            found[name] = InputError(
                f"message {len(record.received_ns) + 1} of {record.topic} cannot be decoded as "
                f"{record.kind}",
                where=str(path),
                remedy="copy the bag again if it is damaged, else record it with the definitions "
                "of its messages",
            )
    return found


def _left_out(path: Path, names: Sequence[str]) -> tuple[Issue, ...]:
    if not names:
        return ()
    return (
        Issue(
            "column-left-out",
            "info",
            f"{path}: left out {first_names(names)}, not being numbers, or not the same ones in "
            "every message",
            "no action is needed, unless one of them is a channel",
        ),
    )


def _read_together(path: Path, parts: Sequence[Path]) -> Issue:
    others = [part.name for part in parts if part.name != path.name]
    return Issue(
        "files-read-together",
        "info",
        f"{path}: read together with {first_names(others)}, being one recording",
        "name one file of a recording only",
    )
