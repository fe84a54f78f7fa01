"""The small TOML files of the user: opened, decoded, parsed, with one sentence for each fault."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from softid.errors import InputError


@dataclass(frozen=True)
class TomlKind:
    """What a file is to be.

    Attributes
    ----------
    name
        What the errors call it: ``"recipe"``.
    form
        What the user may do where the file is none, in the imperative.
    largest_bytes
        A larger file is taken for a slip.
    """

    name: str
    form: str
    largest_bytes: int = 1_000_000


def read_toml_bytes(path: Path, kind: TomlKind) -> bytes:
    """The bytes of a small file.

    Raises
    ------
    InputError
        The file is missing, a folder, too large or may not be read.
    """
    try:
        with path.open("rb") as stream:
            content = stream.read(kind.largest_bytes + 1)
    except (OSError, ValueError) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise InputError(
            f"the {kind.name} cannot be read ({reason.lower()})",
            where=str(path),
            remedy="check the path and its permissions",
        ) from error
    if len(content) > kind.largest_bytes:
        raise InputError(
            f"this file is too large for a {kind.name}, of more than {kind.largest_bytes} bytes",
            where=str(path),
            remedy=kind.form,
        )
    return content


def parse_toml(content: bytes, kind: TomlKind, *, where: str) -> dict[str, Any]:
    r"""The tables of a file.

    Parameters
    ----------
    content
        TOML in UTF-8, with or without a byte order mark.
    kind
        What it is to be.
    where
        Name of the file, for the errors.

    Raises
    ------
    InputError
        The content is no text, or no TOML.

    Examples
    --------
    >>> parse_toml(b"seed = 3\n", TomlKind("recipe", "name a recipe"), where="a.toml")
    {'seed': 3}
    """
    try:
        return tomllib.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise InputError(
            f"the {kind.name} is not text in UTF-8",
            where=f"{where}, byte {error.start + 1}",
            remedy=kind.form,
        ) from error
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        deep = isinstance(error, RecursionError)
        reason = "it is nested too deeply" if deep else str(error)
        raise InputError(
            f"the {kind.name} is no TOML: {reason[:1].lower()}{reason[1:]}",
            where=where,
            remedy=f"correct that line, or {kind.form}",
        ) from error
