"""ROS bags for tests, written by rosbags' own writers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from softid.readers.base import Table

START_NS = 1_700_000_000 * 10**9
"""The time of second 0: a date of 2023, as in any recording."""

KINDS = {".bag": 1, ".db3": StoragePlugin.SQLITE3, ".mcap": StoragePlugin.MCAP}

CUSTOM = {
    "rig_msgs/msg/Pad": "float64 pressure_kpa\nfloat64[] taps\nstring note\nrig_msgs/Part[] parts",
    "rig_msgs/msg/Part": "float64 x",
    "rig_msgs/msg/State": "std_msgs/Header header\nfloat64 pressure\nrig_msgs/Tip tip",
    "rig_msgs/msg/Tip": "float32 angle\nfloat64[40] trace\nbool from",
}

Message = tuple[str, float, Any]
"""Topic, second of receipt and message."""


class Types:
    """Message types of one ROS, with those of a rig of its own.

    Parameters
    ----------
    suffix
        Ending of the bags that they are for.
    """

    def __init__(self, suffix: str) -> None:
        self.is_first = suffix == ".bag"
        self.store = get_typestore(Stores.ROS1_NOETIC if self.is_first else Stores.ROS2_HUMBLE)
        for name, text in CUSTOM.items():
            self.store.register(get_types_from_msg(text, name))

    def make(self, kind: str, **fields: Any) -> Any:
        """A message."""
        return self.store.types[kind](**fields)

    def number(self, value: float) -> Any:
        """A std_msgs/Float64."""
        return self.make("std_msgs/msg/Float64", data=float(value))

    def header(self, second: float | None, start_ns: int = START_NS) -> Any:
        """A header with a stamp of that second, or a zero one."""
        total = 0 if second is None else start_ns + round(second * 1e9)
        stamp = self.make("builtin_interfaces/msg/Time", sec=total // 10**9, nanosec=total % 10**9)
        more: Mapping[str, Any] = {"seq": 0} if self.is_first else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id="rig", **more)

    def vector(self, x: float, y: float, z: float) -> Any:
        """A geometry_msgs/Vector3."""
        return self.make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)


def write_bag(
    folder: Path, suffix: str, messages: Iterable[Message], *, compressed: bool = False
) -> Path:
    """Write messages to a bag in a folder that is not there yet; the path of its file."""
    types = Types(suffix)
    writer: Any
    if suffix == ".bag":
        folder.mkdir()
        path = folder / "log.bag"
        writer = Writer1(path)
    else:
        path = folder / f"{folder.name}{suffix}"
        writer = Writer2(folder, version=9, storage_plugin=KINDS[suffix])
        if compressed:
            writer.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
    connections: dict[str, Any] = {}
    serialize = types.store.serialize_ros1 if suffix == ".bag" else types.store.serialize_cdr
    with writer:
        for topic, second, message in sorted(messages, key=lambda m: m[1]):
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=types.store)
            writer.write(
                connections[topic], START_NS + round(second * 1e9), serialize(message, kind)
            )
    return path


def column(table: Table, name: str) -> list[float]:
    """The numbers of a column."""
    return table.numbers(table.head.names.index(name)).tolist()


def unit(table: Table, name: str) -> str | None:
    """The unit of a column."""
    return table.head.units[table.head.names.index(name)]


def told(table: Table, code: str) -> str:
    """What the issues of a code say."""
    return " ".join(issue.message for issue in table.head.issues if issue.code == code)


def numbers(types: Types, topic: str, values: Mapping[float, float]) -> list[Message]:
    """Messages of std_msgs/Float64, from second and value."""
    return [(topic, second, types.number(value)) for second, value in values.items()]
