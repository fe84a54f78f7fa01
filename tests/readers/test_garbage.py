"""Whatever a file holds, only softid's own errors come out of the reader, and soon.

Stands on no number: a property. Hypothesis makes the files; a deadline per example catches hangs.
"""

from __future__ import annotations

import gzip
import io
import tempfile
import warnings
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbag_files import KINDS, Types, write_bag

from softid.errors import SoftidError
from softid.log import Log
from softid.readers import READERS, load

SUFFIXES = sorted(READERS)
QUICK = settings(
    max_examples=120,
    deadline=2000,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
CLEAN = (
    "# rig: 3\ntime_s;pressure [bar];angle_deg\n"
    + "".join(f"{k / 10:.1f};{k % 7 / 10:.1f};{k * 1.5:.2f}\n" for k in range(30))
).replace(".", ",")
SPLINTERS = [
    *("", " ", "\n", "\r", "\r\n", "\t", ";", ",", "|", '"', "'", "#", "%", "//", "=", ":", "-"),
    *("nan", "NA", "inf", "-inf", "1e999", "-1e308", "1e-320", "1_000", "0x1F", "1,2,3", "ERR"),
    *("time", "pressure", "[kPa]", "(deg)", "2024-02-30", "2024-01-01T00:00:00", "25:61:61", "°"),
    *("\x00", "\ufeff", "\u2028", "٣", "s;bar;deg\n", "time_s;pressure_bar\n", "9" * 400),
]


def load_or_refuse(path: Path, **options: object) -> Log | None:
    """Load; a refusal must be softid's own and say something."""
    refusal = ""
    log = None
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        try:
            log = load(path, **options)  # type: ignore[arg-type]
        except SoftidError as error:
            refusal = str(error)
    if log is None:
        assert refusal.endswith(".")
        assert str(path) in refusal or "--" in refusal
        return None
    assert np.all(np.diff(log.time_s) > 0)
    return log


@pytest.mark.parametrize("suffix", SUFFIXES)
@QUICK
@given(data=st.binary(max_size=400))
def test_random_bytes(tmp_path: Path, suffix: str, data: bytes) -> None:
    path = tmp_path / f"log{suffix}"
    path.write_bytes(data)
    load_or_refuse(path)


@QUICK
@given(text=st.lists(st.sampled_from([*SPLINTERS, "0", "1", "2.5", "-3"]), max_size=60))
def test_text_of_splinters(tmp_path: Path, text: list[str]) -> None:
    path = tmp_path / "log.csv"
    path.write_text("".join(text), encoding="utf-8", errors="surrogatepass")
    load_or_refuse(path)
    load_or_refuse(path, channels={"time": "1:s", "pressure": "2:kPa", "angle": "2:deg"})


@QUICK
@given(
    cuts=st.lists(
        st.tuples(st.integers(0, len(CLEAN)), st.integers(0, 12), st.sampled_from(SPLINTERS)),
        min_size=1,
        max_size=6,
    )
)
def test_a_sound_file_with_splinters(tmp_path: Path, cuts: list[tuple[int, int, str]]) -> None:
    text = CLEAN
    for at, removed, added in cuts:
        text = text[:at] + added + text[at + removed :]
    path = tmp_path / "log.csv"
    path.write_bytes(text.encode("utf-8", errors="surrogatepass"))
    load_or_refuse(path)


def sound_binaries() -> dict[str, bytes]:
    columns = {"time_s": np.arange(5.0), "pressure_kpa": np.arange(5.0), "angle_deg": np.ones(5)}
    npz, mat = io.BytesIO(), io.BytesIO()
    np.savez(npz, **columns)
    scipy.io.savemat(mat, {"log": columns})
    return {
        ".npz": npz.getvalue(),
        ".mat": mat.getvalue(),
        ".csv.gz": gzip.compress(CLEAN.encode()),
    }


def sound_bags() -> dict[str, bytes]:
    found = {}
    for suffix in KINDS:
        types = Types(suffix)
        topics = ("/pressure_kpa", "/angle_rad")
        messages = [(topic, 0.1 * k, types.number(k)) for k in range(9) for topic in topics]
        with tempfile.TemporaryDirectory() as folder:
            path = write_bag(Path(folder, "run"), suffix, messages)
            found[suffix] = path.read_bytes()
    return found


BINARIES = sound_binaries() | sound_bags()


@pytest.mark.parametrize("suffix", sorted(BINARIES))
@QUICK
@given(data=st.data())
def test_a_sound_binary_with_broken_bytes(tmp_path: Path, suffix: str, data: st.DataObject) -> None:
    content = bytearray(BINARIES[suffix])
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / f"log{suffix}"
    path.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    load_or_refuse(path)


def test_the_detector_would_see_another_exception(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The properties above are worth what `load_or_refuse` lets through."""
    path = tmp_path / "log.csv"
    path.write_text(CLEAN)
    assert load_or_refuse(path) is not None
    monkeypatch.setattr("softid.readers.loading.find_channels", lambda *_, **__: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        load_or_refuse(path)
