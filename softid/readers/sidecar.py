"""The sidecar: a small TOML file beside a log that says what its columns are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from softid.errors import InputError
from softid.toml_files import TomlKind, parse_toml, read_toml_bytes

_TABLES = ("channels", "roles", "metadata")
_FORM = 'pressure = {column = "P1", unit = "bar"}'
_KIND = TomlKind("sidecar", f"write a channel as {_FORM}")


@dataclass(frozen=True)
class SidecarChannel:
    """Where a channel is: a column's name or 1-based number, and its unit or None."""

    column: str | int
    unit: str | None


@dataclass(frozen=True)
class Sidecar:
    """What a sidecar says.

    Attributes
    ----------
    path
        The file, or None when there is none.
    channels
        Channel name → column and unit; ``time`` among them.
    input
        Channel that drives, or None.
    outputs
        Channels to explain.
    metadata
        Free facts.
    """

    path: Path | None = None
    channels: Mapping[str, SidecarChannel] = field(default_factory=dict)
    input: str | None = None
    outputs: tuple[str, ...] = ()
    metadata: Mapping[str, str] = field(default_factory=dict)


def find_sidecar(log: Path, stem: str) -> Path | None:
    """The sidecar beside a log: its full name with ``.toml`` added, else its stem with it."""
    for name in (f"{log.name}.toml", f"{stem}.toml"):
        beside = log.parent / name
        if beside.is_file():
            return beside
    return None


def read_sidecar(path: Path) -> Sidecar:
    """Read and check a sidecar.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, or says something that is not understood.
    """
    said = parse_toml(read_toml_bytes(path, _KIND), _KIND, where=str(path))
    unknown = [key for key in said if key not in _TABLES]
    if unknown:
        raise InputError(
            f"the sidecar has no table {unknown[0]}",
            where=str(path),
            remedy=f"choose from {', '.join(f'[{name}]' for name in _TABLES)}",
        )
    roles = _table(said, "roles", path)
    return Sidecar(
        path,
        {k: _channel(k, v, path) for k, v in _table(said, "channels", path).items()},
        _input(roles, path),
        _outputs(roles, path),
        {k: str(v) for k, v in _table(said, "metadata", path).items()},
    )


def _table(said: Mapping[str, object], name: str, path: Path) -> Mapping[str, object]:
    table = said.get(name, {})
    if not isinstance(table, dict):
        raise InputError(
            f"{name} is not a table", where=str(path), remedy=f"write it as [{name}] with lines"
        )
    return table


def _channel(name: str, said: object, path: Path) -> SidecarChannel:
    where = f"{path}, [channels] {name}"
    entry = said if isinstance(said, dict) else {"column": said}
    column, unit = entry.get("column"), entry.get("unit")
    if (
        isinstance(column, bool)
        or not isinstance(column, str | int)
        or entry.keys()
        - {
            "column",
            "unit",
        }
    ):
        raise InputError("this is not a column and a unit", where=where, value=said, remedy=_FORM)
    if unit is not None and not isinstance(unit, str):
        raise InputError("the unit is not a text", where=where, value=unit, remedy=_FORM)
    return SidecarChannel(column, unit)


def _input(roles: Mapping[str, object], path: Path) -> str | None:
    unknown = [key for key in roles if key not in ("input", "output", "outputs")]
    if unknown:
        raise InputError(
            f"there is no role {unknown[0]}",
            where=f"{path}, [roles]",
            remedy="write input and output",
        )
    said = roles.get("input")
    if said is not None and not isinstance(said, str):
        raise InputError(
            "the input is not a name", where=f"{path}, [roles]", value=said, remedy='"pressure"'
        )
    return said


def _outputs(roles: Mapping[str, object], path: Path) -> tuple[str, ...]:
    said = roles.get("output", roles.get("outputs", ()))
    names = [said] if isinstance(said, str) else said
    if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
        raise InputError(
            "the outputs are not names",
            where=f"{path}, [roles]",
            value=said,
            remedy='output = "angle"',
        )
    return tuple(names)
