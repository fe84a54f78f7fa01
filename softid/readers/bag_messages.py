"""Which numbers a ROS message holds: columns named by topic and field, with the units ROS fixes."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from keyword import iskeyword
from operator import attrgetter
from typing import Any

from softid.readers.columns import read_name

LONGEST_ARRAY = 32
"""Most elements of an array that are channels: a longer one is a scan, a spectrum or a map."""

NOT_NUMBERS: Mapping[str, str] = {
    "sensor_msgs/msg/Image": "images",
    "sensor_msgs/msg/CompressedImage": "images",
    "stereo_msgs/msg/DisparityImage": "images",
    "theora_image_transport/msg/Packet": "images",
    "sensor_msgs/msg/CameraInfo": "of a camera",
    "sensor_msgs/msg/PointCloud": "point clouds",
    "sensor_msgs/msg/PointCloud2": "point clouds",
    "sensor_msgs/msg/LaserScan": "scans",
    "sensor_msgs/msg/MultiEchoLaserScan": "scans",
    "nav_msgs/msg/OccupancyGrid": "maps",
    "rosgraph_msgs/msg/Log": "text",
    "rcl_interfaces/msg/Log": "text",
    "rcl_interfaces/msg/ParameterEvent": "text",
}
"""Type → what its messages are; they are not even decoded, being large or no measurement."""

_HEADER = "std_msgs/msg/Header"
_TIMES = ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
_LAYOUT = "std_msgs/msg/MultiArrayLayout"
_TEXT = ("string", "wstring", "char16", "wchar")
_FILLER = "structure_needs_at_least_one_member"
_NAMES_OF_ELEMENTS = ("name", "names", "joint_names")
_DESCRIPTIONS = frozenset({"variance", "radiation_type", "field_of_view", "min_range", "max_range"})
"""Fields of sensor_msgs that say something of the sensor and are no reading of it."""

_UNITS: Mapping[tuple[str, str], str] = {
    ("sensor_msgs/msg/FluidPressure", "fluid_pressure"): "Pa",
    ("sensor_msgs/msg/Range", "range"): "m",
    ("geometry_msgs/msg/Wrench", "force"): "N",
    ("geometry_msgs/msg/Wrench", "torque"): "N·m",
    ("geometry_msgs/msg/Pose", "position"): "m",
    ("geometry_msgs/msg/PointStamped", "point"): "m",
    ("geometry_msgs/msg/Transform", "translation"): "m",
}
"""(Type, field) → unit that ROS fixes (REP 103, comments of the types), where softid has it.

A joint's position has none: it is in rad or in m, and the message does not say of which kind the
joint is.
"""


@dataclass(frozen=True)
class Field:
    """A number of a message, or an array of them.

    Attributes
    ----------
    path
        Attributes that lead to it, with dots between them.
    is_array
        Whether it is an array.
    unit
        Unit that ROS fixes for it, or None.
    names_path
        Where the names of an array's elements stand in the same message, or None.
    """

    path: str
    is_array: bool
    unit: str | None
    names_path: str | None = None

    def column(self, topic: str, element: str = "") -> str:
        """Name of its column: topic and field, ``data`` left off, as it says nothing."""
        path = "" if self.path == "data" else f".{self.path}"
        return f"{topic}{path}{element}"


@dataclass(frozen=True)
class Layout:
    """What of a message type is read.

    Attributes
    ----------
    fields
        Its numbers.
    is_stamped
        Whether it begins with a header, which has a time stamp.
    left_out
        Paths of text, times and messages in arrays.
    """

    fields: tuple[Field, ...]
    is_stamped: bool
    left_out: tuple[str, ...]


def layout_of(kind: str, definitions: Mapping[str, Any]) -> Layout:
    """The numbers in a message type, nested messages included.

    Parameters
    ----------
    kind
        Message type: ``"std_msgs/msg/Float64"``.
    definitions
        Type → constants and fields, as rosbags parses them.

    Raises
    ------
    KeyError
        The type, or one that is nested in it, is not among the definitions.
    """
    fields: list[Field] = []
    left_out: list[str] = []
    for found in _walk(kind, definitions, "", None):
        if isinstance(found, Field):
            fields.append(found)
        else:
            left_out.append(found)
    top = definitions[kind][1]
    stamped = any(name == "header" and args == _HEADER for name, (_, args) in top)
    return Layout(tuple(fields), stamped, tuple(left_out))


def _walk(
    kind: str, definitions: Mapping[str, Any], before: str, unit: str | None
) -> Iterator[Field | str]:
    """Fields of a type that hold numbers, and the paths of those that hold none."""
    members = definitions[kind][1]
    names_path = _names_of_elements(members, before)
    for name, (node, args) in members:
        path = f"{before}{name}{'_' if iskeyword(name) else ''}"  # as rosbags calls the attribute
        if _is_no_reading(kind, name, args) or path == names_path:
            continue
        own_unit = _UNITS.get((kind, name), unit)
        if node.name == "NAME":
            if args in _TIMES:
                yield path
            else:
                yield from _walk(args, definitions, f"{path}.", own_unit)
        elif node.name == "BASE":
            yield path if args[0] in _TEXT else Field(path, False, own_unit)
        else:
            (element, inner), length = args
            is_short = node.name == "SEQUENCE" or length <= LONGEST_ARRAY
            if element.name == "BASE" and inner[0] not in _TEXT and is_short:
                yield Field(path, True, own_unit, names_path)
            else:
                yield path


def _names_of_elements(members: list[Any], before: str) -> str | None:
    for name, (node, args) in members:
        if name in _NAMES_OF_ELEMENTS and node.name in ("ARRAY", "SEQUENCE"):
            element, inner = args[0]
            if element.name == "BASE" and inner[0] in _TEXT:
                return f"{before}{name}"
    return None


def _is_no_reading(kind: str, name: str, args: object) -> bool:
    return (
        args in (_HEADER, _LAYOUT)
        or name == _FILLER
        or name.endswith("covariance")
        or (kind.startswith("sensor_msgs/") and name in _DESCRIPTIONS)
    )


@dataclass(eq=False)
class TopicRecord:
    """The numbers of one topic, while its messages are read.

    Attributes
    ----------
    topic, kind
        Its name and message type.
    layout
        What is read of a message.
    received_ns, stamps_ns
        When each message was received, and its stamp where it has one, in ns.
    columns
        Column name → values, one per message.
    units
        Column name → unit that ROS fixes, or None.
    odd
        Column name of an array that cannot be columns → why.
    """

    topic: str
    kind: str
    layout: Layout
    received_ns: array[int] = field(default_factory=lambda: array("q"))
    stamps_ns: array[int] = field(default_factory=lambda: array("q"))
    columns: dict[str, array[float]] = field(default_factory=dict)
    units: dict[str, str | None] = field(default_factory=dict)
    odd: dict[str, str] = field(default_factory=dict)
    _lengths: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._getters = [(f, attrgetter(f.path)) for f in self.layout.fields]

    def add(self, message: Any, received_ns: int) -> None:
        """Take the numbers of the next message."""
        for found, get in self._getters:
            if not found.is_array:
                self._put(found, found.column(self.topic), float(get(message)))
            elif found.names_path is not None:
                self._add_named(found, get(message), attrgetter(found.names_path)(message))
            else:
                self._add_array(found, get(message))
        self.received_ns.append(received_ns)
        if self.layout.is_stamped:
            stamp = message.header.stamp
            self.stamps_ns.append(stamp.sec * 10**9 + stamp.nanosec)
        count = len(self.received_ns)
        for values in self.columns.values():
            if len(values) < count:  # a joint that this message does not speak of
                values.append(float("nan"))

    def _put(self, found: Field, column: str, value: float) -> None:
        if column not in self.columns:
            self.columns[column] = array("d", [float("nan")]) * len(self.received_ns)
            of_array = read_name(found.column(self.topic)).unit if found.is_array else None
            self.units[column] = found.unit or of_array
        values = self.columns[column]
        if len(values) == len(self.received_ns):
            values.append(value)

    def _add_named(self, found: Field, values: Any, names: Any) -> None:
        if len(values) == len(names) <= LONGEST_ARRAY:
            for name, value in zip(names, values, strict=True):
                self._put(found, found.column(self.topic, f".{name}"), float(value))
        elif len(values):
            self._add_array(found, values)

    def _add_array(self, found: Field, values: Any) -> None:
        whole = found.column(self.topic)
        length = self._lengths.setdefault(whole, len(values))
        if whole in self.odd:
            return
        if length > LONGEST_ARRAY:
            self.odd[whole] = f"an array of {length} numbers"
        elif len(values) != length:
            self.odd[whole] = f"an array of {length} numbers, then of {len(values)}"
            for k in range(length):
                del self.columns[found.column(self.topic, f".{k}")]
        else:
            for k, value in enumerate(values):
                self._put(found, found.column(self.topic, f".{k}"), float(value))
