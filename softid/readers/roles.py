"""Which channel drives and which are to be explained, when the user does not say."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from softid.channels import OUTPUT_PREFERENCE, default_outputs
from softid.errors import InputError, Issue, UsageError
from softid.readers.assignment import Found
from softid.readers.base import first_names
from softid.units import CHANNEL_QUANTITY

INPUT_PREFERENCE = ("pressure", "pressure_command")
"""The input is the first of these that is there, else the force on something with a position."""


def choose_roles(
    found: Found,
    *,
    input: str | None,
    outputs: Sequence[str] | None,
    where: str,
    input_of: str | None = None,
    outputs_of: str | None = None,
) -> tuple[str, tuple[str, ...]]:
    """Settle input and outputs.

    A log of nothing but commanded and measured pressure is one of the pneumatics: the command
    drives and the pressure is explained.

    Parameters
    ----------
    found
        The file's channels.
    input, outputs
        Names that the user or the sidecar gave; None and empty to choose. Outputs of None mean
        that there shall be none.
    where
        File named in the errors.
    input_of, outputs_of
        The file that gave the name, such as ``"the sidecar step.toml"``; None for the user.

    Returns
    -------
    tuple
        Name of the input channel and names of the output channels.

    Raises
    ------
    UsageError
        A name that the user gave is none of the log's channels, or both input and output.
    InputError
        A role cannot be settled, or a file gave a name that is none of the log's channels.
    """
    if outputs is None:
        return _driving(found, input, where, input_of), ()
    named = tuple(
        dict.fromkeys(_resolve(found, name, "--output", where, outputs_of) for name in outputs)
    )
    if input is not None:
        chosen = _resolve(found, input, "--input", where, input_of)
        if chosen in named:
            choices = first_names(list(found.channels))
            raise UsageError(
                f"{chosen} is both input and output",
                where=where,
                remedy=f"choose another --input or --output from {choices}",
            )
        return chosen, named or _outputs(found, chosen, where)
    for name in INPUT_PREFERENCE:
        if name not in named and _there(found, name):
            return _with_outputs(found, name, named, where)
    if "force" not in named and _there(found, "position") and _there(found, "force"):
        return _with_outputs(found, "force", named, where)
    taken = next((name for name in INPUT_PREFERENCE if name in named), None)
    if taken:
        raise UsageError(
            f"{taken} is to be explained, and no other channel of the log plainly drives",
            where=f"{where}, --output",
            value=taken,
            remedy="name what drives it with --input, or leave --output away",
        )
    raise _nothing_drives(found, where)


def fallback_issues(
    found: Found, asked: Collection[str], input: str, outputs: Sequence[str]
) -> tuple[Issue, ...]:
    """A warning where a pressure is explained although somebody asked for another column.

    Parameters
    ----------
    found
        The file's channels.
    asked
        Channels that a flag or the sidecar named.
    input, outputs
        The roles that `choose_roles` chose, no output being named.
    """
    others = [name for name in asked if name in found.channels and name not in CHANNEL_QUANTITY]
    if not others or not outputs or not set(outputs) <= set(INPUT_PREFERENCE):
        return ()
    return (
        Issue(
            "pressure-explained",
            "warning",
            f"no output was named and none is recognised, so that {outputs[0]} is explained by "
            f"{input}, and {', '.join(others)} by nothing",
            f"name what is to be explained, as with --output {others[0]}",
        ),
    )


def _driving(found: Found, input: str | None, where: str, input_of: str | None) -> str:
    if input is not None:
        return _resolve(found, input, "--input", where, input_of)
    for name in INPUT_PREFERENCE:
        if _there(found, name):
            return name
    raise _nothing_drives(found, where)


def _nothing_drives(found: Found, where: str) -> InputError:
    return InputError(
        f"no input channel is recognised among {first_names(list(found.channels))}",
        where=where,
        remedy="map the pressure with --channel pressure=COLUMN:UNIT, or name what drives with "
        "--input",
    )


def _with_outputs(
    found: Found, input: str, named: tuple[str, ...], where: str
) -> tuple[str, tuple[str, ...]]:
    if named:
        return input, named
    motion = any(name in found.channels or name in found.problems for name in OUTPUT_PREFERENCE)
    if input == "pressure" and not motion and _there(found, "pressure_command"):
        return "pressure_command", ("pressure",)
    return input, _outputs(found, input, where)


def _outputs(found: Found, input: str, where: str) -> tuple[str, ...]:
    for name in OUTPUT_PREFERENCE:
        if name != input and _there(found, name):
            return (name,)
    if input == "pressure_command" and _there(found, "pressure"):
        return ("pressure",)
    return default_outputs(found.channels, input, where=where)


def _there(found: Found, name: str) -> bool:
    if name in found.problems:
        raise found.problems[name]
    return name in found.channels


def _resolve(found: Found, name: str, option: str, where: str, asked_by: str | None) -> str:
    if _there(found, name):
        return name
    if name in found.columns:
        return found.columns[name]
    bare = [column for column in found.columns if _without_unit(column) == name]
    if len(bare) == 1:
        return found.columns[bare[0]]
    if asked_by is not None:
        raise InputError(
            f"the log has no channel {name}, which {asked_by} asks for",
            where=where,
            remedy=f"map a column with --channel {name}=COLUMN:UNIT, or take a log that has it "
            f"(this one has {first_names(list(found.channels)) or 'none'})",
        )
    raise UsageError(
        f"the log has no channel {name}",
        where=f"{where}, {option}",
        remedy=f"choose from {first_names(list(found.channels))}, or map a column with --channel",
    )


def _without_unit(column: str) -> str:
    """The name of a column without the unit that stands behind it in brackets."""
    return re.sub(r"\s*(\([^()]*\)|\[[^][]*\])\s*$", "", column)
