"""ROS bags: columns by topic and field, whole recordings, and what is wrong with a file."""

from __future__ import annotations

import shutil
import sqlite3
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from softid.errors import InputError, MissingExtraError
from softid.readers import files, load
from softid.readers.bag import BagTable, read_bag

pytest.importorskip("rosbags", reason="rosbags is in the test extra")
from rosbag_files import KINDS, START_NS, Types, column, numbers, told, write_bag

SUFFIXES = sorted(KINDS)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_topics_become_the_channels_that_their_names_say(tmp_path: Path, suffix: str) -> None:
    """0.5 bar are 50 kPa, 90° are π/2; ``data`` is not part of a name, a unit at its end is."""
    types = Types(suffix)
    messages = numbers(types, "/pressure_bar", {0.0: 0.0, 0.5: 0.5, 1.0: 1.0})
    messages += numbers(types, "/finger/bend_angle_deg", {0.0: 0.0, 0.5: 90.0, 1.0: 180.0})
    path = write_bag(tmp_path / "run", suffix, messages)
    log = load(path)
    assert log.time_s.tolist() == [0.0, 0.5, 1.0]
    assert log.pressure_kpa.tolist() == [0.0, 50.0, 100.0]
    np.testing.assert_allclose(log.channels["angle"].values, [0.0, np.pi / 2, np.pi], rtol=1e-12)
    assert log.channels["angle"].column == "/finger/bend_angle_deg"
    assert log.metadata["topic /pressure_bar"] == "std_msgs/msg/Float64, 3 messages"
    assert log.source is not None
    assert log.source.file_format == "bag"
    assert log.source.sha256 == files.file_fingerprint(path)
    assert log.issues == ()


def test_a_number_without_unit_is_asked_for_and_the_remedy_works(tmp_path: Path) -> None:
    types = Types(".mcap")
    messages = numbers(types, "/pressure", {0.0: 1.0, 1.0: 2.0})
    messages += numbers(types, "/tip/angle_rad", {0.0: 0.1, 1.0: 0.2})
    path = write_bag(tmp_path / "run", ".mcap", messages)
    with pytest.raises(InputError, match="the pressure has no unit") as caught:
        load(path)
    assert "--channel pressure=/pressure:" in str(caught.value)
    log = load(path, channels={"pressure": "/pressure:kPa"}, input="pressure", outputs=["angle"])
    assert log.pressure_kpa.tolist() == [1.0, 2.0]


def test_a_topic_of_the_time_s_name_is_not_the_time(tmp_path: Path) -> None:
    types = Types(".mcap")
    messages = numbers(types, "/time", {0.0: 7.0, 1.0: 8.0})
    messages += numbers(types, "/pressure_kpa", {0.0: 1.0, 1.0: 2.0})
    messages += numbers(types, "/angle_rad", {0.0: 0.1, 1.0: 0.2})
    log = load(write_bag(tmp_path / "run", ".mcap", messages))
    assert log.time_s.tolist() == [0.0, 1.0]
    assert log.channels["/time.data"].values.tolist() == [7.0, 8.0]


def test_rows_of_topics_that_no_role_needs_are_no_lost_samples(tmp_path: Path) -> None:
    """Five messages of a thermometer between two of the rig: no warning, and its column is told."""
    types = Types(".mcap")
    messages = numbers(types, "/pressure_kpa", {0.0: 1.0, 1.0: 2.0})
    messages += numbers(types, "/angle_rad", {0.0: 0.1, 1.0: 0.2})
    messages += numbers(types, "/air", {0.1 * k: 20.0 for k in range(2, 7)})
    path = write_bag(tmp_path / "run", ".mcap", messages)
    log = load(path)
    assert log.time_s.tolist() == [0.0, 1.0]
    assert set(log.channels) == {"pressure", "angle"}
    assert [(i.severity, i.code) for i in log.issues] == [("info", "column-left-out")]
    assert "left out /air" in log.issues[0].message
    assert load(path, input="/air", outputs=None).time_s.size == 5


def test_of_a_large_bag_only_the_needed_columns_are_spread(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Six columns of 4 rows are 192 bytes. Held are 4 · 3 and 2 · 5 numbers, two of them times.

    The limit lies between, then a byte below what is held.
    """
    types = Types(".mcap")
    messages = numbers(types, "/pressure_kpa", {0.0: 1.0, 1.0: 2.0})
    messages += numbers(types, "/angle_rad", {0.0: 0.1, 1.0: 0.2})
    messages += [("/wind", second, types.vector(1.0, 2.0, 3.0)) for second in (0.4, 0.6)]
    path = write_bag(tmp_path / "run", ".mcap", messages)
    spread: list[int] = []
    spread_out = BagTable.numbers

    def watched(self: BagTable, index: int) -> Any:
        spread.append(index)
        return spread_out(self, index)

    monkeypatch.setattr(BagTable, "numbers", watched)
    monkeypatch.setattr(files, "SIZE_LIMIT_BYTES", 8 * (4 * 3 + 2 * 5))
    assert set(load(path).channels) == {"pressure", "angle"}
    assert sorted(spread) == [0, 1, 2]
    monkeypatch.setattr(files, "SIZE_LIMIT_BYTES", 8 * (4 * 3 + 2 * 5) - 1)
    with pytest.raises(InputError, match="over 0 MB of numbers, more than"):
        load(path)


@pytest.mark.parametrize("suffix", [".db3", ".mcap"])
def test_a_compressed_recording_is_read_by_its_metadata(tmp_path: Path, suffix: str) -> None:
    """Without metadata.yaml no message can be decoded, and the sentence says what is missing."""
    types = Types(suffix)
    messages = numbers(types, "/pressure", {0.0: 1.0, 1.0: 2.0})
    path = write_bag(tmp_path / "run", suffix, messages, compressed=True)
    assert column(read_bag(path), "/pressure") == [1.0, 2.0]
    path.with_name("metadata.yaml").unlink()
    with pytest.raises(InputError, match=r"no message of /pressure can be decoded; copy the metad"):
        read_bag(path)


def test_a_split_recording_is_read_as_one(tmp_path: Path) -> None:
    """Either file gives both, and the same fingerprint, so that one is no hold-out of the other."""
    types = Types(".db3")
    path = write_bag(tmp_path / "run", ".db3", numbers(types, "/a", {0.0: 1.0, 1.0: 2.0}))
    other = write_bag(tmp_path / "two", ".db3", numbers(types, "/a", {2.0: 3.0}))
    second = path.with_name("run_1.db3")
    shutil.copy(other, second)
    metadata = path.with_name("metadata.yaml")
    text = metadata.read_text()
    assert text.count("- run.db3") == 1
    metadata.write_text(text.replace("- run.db3", "- run.db3\n  - run_1.db3"))
    tables = [read_bag(path), read_bag(second)]
    assert column(tables[0], "/a") == column(tables[1], "/a") == [1.0, 2.0, 3.0]
    assert tables[0].head.sha256 == tables[1].head.sha256
    assert "read together with run_1.db3" in told(tables[0], "files-read-together")
    second.unlink()
    with pytest.raises(InputError, match=r"lists what is not there: run_1.db3; copy all files"):
        read_bag(path)


def test_a_file_of_another_name_is_read_alone(tmp_path: Path) -> None:
    types = Types(".db3")
    path = write_bag(tmp_path / "run", ".db3", numbers(types, "/a", {0.0: 1.0, 1.0: 2.0}))
    renamed = path.rename(path.with_name("step 3.db3"))
    assert column(read_bag(renamed), "/a") == [1.0, 2.0]


def test_old_recordings_without_definitions_take_those_of_ros(tmp_path: Path) -> None:
    """Before Iron a .db3 had no definitions: std_msgs are known, a rig's own are told."""
    types = Types(".db3")
    pad = types.make("rig_msgs/msg/Pad", pressure_kpa=7.0, taps=np.zeros(1), note="", parts=[])
    messages = [*numbers(types, "/a", {0.0: 1.0, 1.0: 2.0}), ("/pad", 0.0, pad)]
    path = write_bag(tmp_path / "run", ".db3", messages)
    path.with_name("metadata.yaml").unlink()
    with sqlite3.connect(path) as database:
        database.execute("DROP TABLE message_definitions")
        database.execute("DROP TABLE schema")
    table = read_bag(path)
    assert column(table, "/a") == [1.0, 2.0]
    assert "/pad (no definition of rig_msgs/msg/Pad in the bag)" in told(table, "column-left-out")


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("share", [0.3, 0.6, 0.95])
def test_a_truncated_bag(tmp_path: Path, suffix: str, share: float) -> None:
    types = Types(suffix)
    messages = numbers(types, "/a", {0.1 * k: k for k in range(2000)})
    whole = write_bag(tmp_path / "run", suffix, messages)
    path = tmp_path / f"cut{suffix}"
    path.write_bytes(whole.read_bytes()[: int(share * whole.stat().st_size)])
    with pytest.raises(InputError, match="it is damaged or ends too early; copy it again"):
        read_bag(path)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_bag_under_another_bag_s_name(tmp_path: Path, suffix: str) -> None:
    types = Types(suffix)
    path = write_bag(tmp_path / "run", suffix, numbers(types, "/a", {0.0: 1.0}))
    for other in set(SUFFIXES) - {suffix}:
        copied = Path(shutil.copy(path, tmp_path / f"log{other}"))
        with pytest.raises(InputError, match=rf"rename the file to \{suffix}\.$"):
            read_bag(copied)
    capital = Path(shutil.copy(path, tmp_path / f"log{suffix.upper()}"))
    with pytest.raises(InputError, match="small letters"):
        load(capital)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_bag_without_numbers_says_what_it_holds(tmp_path: Path, suffix: str) -> None:
    text = Types(suffix).make("std_msgs/msg/String", data="hello")
    path = write_bag(tmp_path / "run", suffix, [("/chat", 0.0, text)])
    with pytest.raises(InputError, match=r"\(/chat \(std_msgs/msg/String, 1 messages\)\)"):
        read_bag(path)
    with pytest.raises(InputError, match=r"no messages with numbers \(no topics\)"):
        read_bag(write_bag(tmp_path / "none", suffix, []))


def test_without_rosbags_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_bag(tmp_path / "run", ".bag", numbers(Types(".bag"), "/a", {0.0: 1.0}))
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(MissingExtraError, match=r"pip install softid\[ros\]") as caught:
        load(path)
    assert caught.value.exit_code == 2


def test_a_bag_that_may_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_bag(tmp_path / "run", ".bag", numbers(Types(".bag"), "/a", {0.0: 1.0}))

    def fail(self: Path, *_: object) -> None:
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr(Path, "open", fail)
    with pytest.raises(InputError, match="there is no permission to read it"):
        load(path)


def test_a_message_that_cannot_be_decoded_costs_its_topic(tmp_path: Path) -> None:
    """The second of three messages of a topic is cut short; without it, the rest is a log."""
    types = Types(".db3")
    messages = numbers(types, "/pressure_kpa", {0.0: 1.0, 1.0: 2.0})
    messages += numbers(types, "/angle_rad", {0.0: 0.1, 0.5: 0.2, 1.0: 0.3})
    messages += numbers(types, "/tip_position_mm", {0.0: 1.0, 1.0: 2.0})
    path = write_bag(tmp_path / "run", ".db3", messages)
    with sqlite3.connect(path) as database:
        cut = "UPDATE messages SET data = substr(data, 1, 6) WHERE timestamp = ?"
        database.execute(cut, (START_NS + 5 * 10**8,))
    with pytest.raises(InputError, match="message 2 of /angle_rad cannot be decoded as std_msgs"):
        load(path)
    log = load(path, outputs=["position"])
    assert log.channels["position"].values.tolist() == [1.0, 2.0]
    assert {i.code for i in log.issues} == {"column-left-out", "channel-not-settled"}
