"""Sidecar, geometry and recipe are refused in the same words, which name file, place and remedy."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from softid.errors import InputError
from softid.models import load_actuator
from softid.readers.sidecar import read_sidecar
from softid.synthesis.recipe import load_recipe

READERS: dict[str, Callable[[Path], object]] = {
    "sidecar": read_sidecar,
    "geometry": load_actuator,
    "recipe": load_recipe,
}
BAD = {
    "binary": (b"seed = 3\n\xff\xfe\x00", "byte 10: the {} is not text in UTF-8; "),
    "cut": (b"[geom", "the {} is no TOML: expected ']' at the end of a table declaration (at"),
    "deep": (b"a = " + b"[" * 9_000, "the {} is no TOML: it is nested too deeply; correct"),
    "large": (b"#" * 1_000_001, "this file is too large for a {}, of more than "),
}


@pytest.mark.parametrize("kind", READERS)
@pytest.mark.parametrize("fault", BAD)
def test_one_sentence_for_every_fault(tmp_path: Path, kind: str, fault: str) -> None:
    content, said = BAD[fault]
    path = tmp_path / "it.toml"
    path.write_bytes(content)
    with pytest.raises(InputError) as refused:
        READERS[kind](path)
    assert "it.toml" in str(refused.value)
    assert said.format(kind) in str(refused.value)
    assert refused.value.remedy


@pytest.mark.parametrize("kind", READERS)
def test_a_file_that_cannot_be_opened(tmp_path: Path, kind: str) -> None:
    for path in (tmp_path, tmp_path / "absent.toml", tmp_path / "a\0b"):
        with pytest.raises(InputError, match=f"the {kind} cannot be read"):
            READERS[kind](path)


def test_a_byte_order_mark_is_no_fault(tmp_path: Path) -> None:
    """Windows editors write one before UTF-8."""
    path = tmp_path / "it.toml"
    path.write_bytes(b"\xef\xbb\xbf[roles]\ninput = 'force'\n")
    assert read_sidecar(path).input == "force"
