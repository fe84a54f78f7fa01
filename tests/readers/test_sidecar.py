"""The sidecar's form, and the sentence for each way to get it wrong."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from softid.errors import InputError
from softid.readers.sidecar import SidecarChannel, find_sidecar, read_sidecar

WriteFile = Callable[..., Path]


def test_what_a_sidecar_says(write_log: WriteFile) -> None:
    said = read_sidecar(
        write_log(
            '[channels]\ntime = {column = 1, unit = "ms"}\npressure = "P1"\n'
            '[roles]\ninput = "pressure"\noutputs = ["angle", "torque"]\n[metadata]\nrun = 7\n',
            "log.toml",
        )
    )
    assert said.channels == {
        "time": SidecarChannel(1, "ms"),
        "pressure": SidecarChannel("P1", None),
    }
    assert (said.input, said.outputs) == ("pressure", ("angle", "torque"))
    assert said.metadata == {"run": "7"}


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("[channels", "the sidecar is no TOML"),
        ("[channel]\n", "no table channel"),
        ("channels = 3\n", "not a table"),
        ("[channels]\npressure = {col = 1}\n", "not a column and a unit"),
        ("[channels]\npressure = true\n", "not a column and a unit"),
        ('[channels]\npressure = {column = 1, unit = 5}\n', "unit is not a text"),
        ('[roles]\ndrive = "x"\n', "no role drive"),
        ("[roles]\ninput = 3\n", "input is not a name"),
        ("[roles]\noutput = 3\n", "outputs are not names"),
    ],
)  # fmt: skip
def test_wrong_sidecars(write_log: WriteFile, text: str, what: str) -> None:
    path = write_log(text, "log.toml")
    with pytest.raises(InputError, match=what) as caught:
        read_sidecar(path)
    assert str(path) in str(caught.value)
    assert caught.value.remedy


def test_a_sidecar_that_is_named_must_be_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_sidecar(tmp_path / "none.toml")


def test_the_full_name_comes_first(write_log: WriteFile, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    assert find_sidecar(log, "log") is None
    by_stem = write_log("", "log.toml")
    assert find_sidecar(log, "log") == by_stem
    by_name = write_log("", "log.csv.toml")
    assert find_sidecar(log, "log") == by_name
