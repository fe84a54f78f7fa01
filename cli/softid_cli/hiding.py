"""`softid synthesize --hide`: a log and its hold-out with hidden effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from softid.errors import SoftidError
from softid_cli.console import say
from softid_cli.model_options import of_an_option
from softid_cli.results_folder import RESULTS
from softid_cli.tables import print_rows

DEFAULT_OUT = RESULTS / "hidden"
NOTHING = "none"

_FLAGS = {
    "rate_hz": "--rate",
    "noise": "--noise",
    "coloured_share": "--coloured",
    "rest_s": "--rest",
    "unit": "--unit",
    "size": "--size",
    "protocol": "--protocol",
    "model": "--model",
    "effect": "--hide",
}
"""Word of the library → the option that it is about."""


@dataclass(frozen=True)
class HideRequest:
    """What the command line asked for.

    Attributes
    ----------
    names
        Effects to hide.
    seed
        Of all that is random.
    asked, recorded
        Options of `hidden_pair` and fields of its rig that were given.
    out, force, as_json, quiet
        As on the command line.
    """

    names: tuple[str, ...]
    seed: int
    asked: Mapping[str, Any]
    recorded: Mapping[str, Any]
    out: Path | None
    force: bool
    as_json: bool
    quiet: bool


def split_names(text: str) -> tuple[str, ...]:
    """The names in ``NAME,NAME``; ``none`` is no name."""
    names = tuple(filter(None, map(str.strip, text.split(","))))
    return () if names == (NOTHING,) else names or ("",)


def hide_effects(request: HideRequest) -> None:
    """Make the pair, write it and say what is true of it."""
    from softid.records import dump_json
    from softid.synthesis import Rig, hidden_pair, truth_document, write_hidden_pair

    try:
        rig = Rig(**request.recorded)
        pair = hidden_pair(request.names, seed=request.seed, rig=rig, **request.asked)
    except SoftidError as error:
        raise of_an_option(error, _FLAGS) from error
    out = request.out or DEFAULT_OUT
    write_hidden_pair(pair, out, overwrite=request.force)
    if not request.quiet:
        say(f"written to {out}")
    document = truth_document(pair)
    if request.as_json:
        click.echo(dump_json({"out": str(out), **document}), nl=False)
        return
    rows = [("actuator", n, f"{p['value']:.6g}", p["unit"]) for n, p in _parameters(document)]
    for effect in document["hidden"]:
        rows += [
            (effect["effect"], n, f"{p['value']:.6g}", p["unit"]) for n, p in _parameters(effect)
        ]
    print_rows([("cause", "left"), ("", "left"), ("value", "right"), ("unit", "left")], rows)


def _parameters(table: Mapping[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    return list(table["parameters"].items())
