"""What of a ROS message is a column, under which name and in which unit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from softid.errors import InputError
from softid.readers import load
from softid.readers.bag import read_bag

pytest.importorskip("rosbags", reason="rosbags is in the test extra")
from rosbag_files import KINDS, Message, Types, column, numbers, told, unit, write_bag

SUFFIXES = sorted(KINDS)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_nested_fields_arrays_and_what_is_no_number(tmp_path: Path, suffix: str) -> None:
    """A short array of one length is columns; a long or a varying one and text are named."""
    types = Types(suffix)
    messages: list[Message] = []
    for k in range(3):
        tip = types.make("rig_msgs/msg/Tip", angle=0.5 * k, trace=np.zeros(40), **{"from_": k > 0})
        state = types.make("rig_msgs/msg/State", header=types.header(k), pressure=k, tip=tip)
        pad = types.make(
            "rig_msgs/msg/Pad", pressure_kpa=7.0, taps=np.arange(k + 1.0), note="x", parts=[]
        )
        messages += [("/state", k, state), ("/pad", k, pad)]
        layout = types.make("std_msgs/msg/MultiArrayLayout", dim=[], data_offset=0)
        many = {"layout": layout, "data": np.array([k, -k], dtype=float)}
        messages.append(("/valves_kpa", k, types.make("std_msgs/msg/Float64MultiArray", **many)))
    table = read_bag(write_bag(tmp_path / "run", suffix, messages))
    assert set(table.head.names) == {
        *("time", "/state.pressure", "/state.tip.angle", "/state.tip.from_", "/pad.pressure_kpa"),
        *("/valves_kpa.0", "/valves_kpa.1"),
    }
    assert column(table, "/state.tip.angle") == [0.0, 0.5, 1.0]
    assert column(table, "/state.tip.from_") == [0.0, 1.0, 1.0]
    assert column(table, "/valves_kpa.1") == [0.0, -1.0, -2.0]
    assert unit(table, "/valves_kpa.1") == "kpa"  # as its topic's name has it
    left = told(table, "column-left-out")
    assert "/state.tip.trace" in left
    assert "/pad.note" in left
    assert "/pad.parts" in left
    assert "/pad.taps (an array of 1 numbers, then of 2)" in left
    assert "header" not in left
    with pytest.raises(InputError, match="then of 2, and cannot be made columns"):
        load(table.head.path, channels={"force": "/pad.taps:N"})


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_units_that_ros_fixes(tmp_path: Path, suffix: str) -> None:
    """REP 103: Pa, N, N·m and m; variance and limits of a sensor are no readings of it."""
    types = Types(suffix)
    messages: list[Message] = []
    for k in range(2):
        at = types.header(k)
        wrench = types.make(
            "geometry_msgs/msg/Wrench",
            force=types.vector(1.0, 2.0, 3.0),
            torque=types.vector(0.0, 0.0, 0.5),
        )
        gas = {"header": at, "fluid_pressure": 5e4 * k, "variance": 0.1}
        span = {"radiation_type": 0, "field_of_view": 0.1, "min_range": 0.0, "max_range": 1.0}
        messages += [
            ("/p", k, types.make("sensor_msgs/msg/FluidPressure", **gas)),
            ("/ft", k, types.make("geometry_msgs/msg/WrenchStamped", header=at, wrench=wrench)),
            ("/laser", k, types.make("sensor_msgs/msg/Range", header=at, range=0.5, **span)),
        ]
    path = write_bag(tmp_path / "run", suffix, messages)
    table = read_bag(path)
    assert unit(table, "/p.fluid_pressure") == "Pa"
    assert unit(table, "/ft.wrench.force.z") == "N"
    assert unit(table, "/ft.wrench.torque.z") == "N·m"
    assert unit(table, "/laser.range") == "m"
    assert len(table.head.names) == 9
    log = load(path, channels={"torque": "/ft.wrench.torque.z"}, outputs=["torque"])
    assert log.pressure_kpa.tolist() == [0.0, 50.0]
    assert log.channels["torque"].values.tolist() == [500.0, 500.0]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_joints_are_told_by_their_names(tmp_path: Path, suffix: str) -> None:
    """Two nodes publish joints of their own, in any order; a joint's position has no unit."""
    types = Types(suffix)

    def joints(k: int, **position: float) -> Message:
        fields = {
            "name": list(position),
            "position": np.array(list(position.values())),
            "velocity": np.array([]),
            "effort": np.array([9.0] * len(position)),
        }
        state = types.make("sensor_msgs/msg/JointState", header=types.header(k), **fields)
        return ("/joint_states", k, state)

    messages = [
        joints(0, finger=1.0, thumb=2.0),
        joints(1, thumb=3.0, finger=4.0),
        joints(2, z=5.0),
    ]
    table = read_bag(write_bag(tmp_path / "run", suffix, messages))
    np.testing.assert_equal(column(table, "/joint_states.position.finger"), [1.0, 4.0, np.nan])
    np.testing.assert_equal(column(table, "/joint_states.position.thumb"), [2.0, 3.0, np.nan])
    np.testing.assert_equal(column(table, "/joint_states.position.z"), [np.nan, np.nan, 5.0])
    assert column(table, "/joint_states.effort.z")[2] == 9.0
    assert unit(table, "/joint_states.position.finger") is None
    assert told(table, "column-left-out") == ""


def test_a_joint_is_asked_about_in_the_units_of_ros(tmp_path: Path) -> None:
    """Two joints may each be the position, in m, or an angle, in rad: one remedy each, as it is."""
    types = Types(".db3")
    messages = numbers(types, "/pressure_kpa", {0.0: 1.0, 1.0: 2.0})
    for k in range(2):
        fields = {
            "name": ["finger", "wrist"],
            "position": np.array([0.5, 0.25]) * k,
            "velocity": np.array([]),
            "effort": np.array([]),
        }
        state = types.make("sensor_msgs/msg/JointState", header=types.header(k), **fields)
        messages.append(("/js", k, state))
    path = write_bag(tmp_path / "run", ".db3", messages)
    with pytest.raises(InputError) as caught:
        load(path)
    remedy = str(caught.value.remedy)
    assert "--channel position=/js.position.finger:m, or --channel" in remedy
    assert remedy.endswith("angle=/js.position.finger:rad if it turns")
    log = load(path, channels={"angle": "/js.position.finger:rad"})
    assert log.channels["angle"].values.tolist() == [0.0, 0.5]


def test_images_are_not_decoded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from rosbags.highlevel import AnyReader

    types = Types(".mcap")
    image = types.make(
        "sensor_msgs/msg/CompressedImage",
        header=types.header(0.0),
        format="jpeg",
        data=np.zeros(9, dtype=np.uint8),
    )
    text = types.make("std_msgs/msg/String", data="hello")
    messages = [("/camera", 0.0, image), ("/chat", 0.0, text)]
    messages += numbers(types, "/pressure", {0.0: 1.0, 1.0: 2.0})
    path = write_bag(tmp_path / "run", ".mcap", messages)
    decoded: set[str] = set()
    deserialize = AnyReader.deserialize

    def watched(self: Any, data: bytes, kind: str) -> object:
        decoded.add(kind)
        return deserialize(self, data, kind)

    monkeypatch.setattr(AnyReader, "deserialize", watched)
    table = read_bag(path)
    assert decoded == {"std_msgs/msg/Float64"}
    left = [issue for issue in table.head.issues if issue.code == "column-left-out"]
    assert [issue.severity for issue in left] == ["info"]
    assert "/camera (images), /chat.data, not being numbers" in left[0].message
