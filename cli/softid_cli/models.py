"""`softid models`: the catalogue."""

from __future__ import annotations

import dataclasses
import math
import typing
from typing import TYPE_CHECKING, Any

import click

from softid.errors import entry_named
from softid_cli.model_options import follows_from_logs
from softid_cli.options import json_option, quiet_option

if TYPE_CHECKING:
    from softid.models.base import Model


@click.command()
@click.argument("name", required=False)
@json_option
@quiet_option
def models(name: str | None, as_json: bool, quiet: bool) -> None:
    """List the models, or describe the one called NAME."""
    del quiet  # there is nothing to say beside the list; the option is there as in all commands
    from softid.models import MODELS
    from softid.records import dump_json
    from softid_cli.tables import print_rows

    named = None if name is None else entry_named(name, MODELS, unknown="there is no such model")
    if as_json:
        chosen = [named] if named else list(MODELS.values())
        click.echo(dump_json([describe(in_own_units(model())) for model in chosen]), nl=False)
    elif named is None:
        rows = [(key, model.title, model.equation) for key, model in MODELS.items()]
        print_rows([("model", "left"), ("what it describes", "left"), ("equation", "left")], rows)
        click.echo("\n`softid models NAME` shows parameters, units and what identifies them.")
    else:
        print_description(in_own_units(named()))


def in_own_units(model: Model) -> Model:
    """The model with u and x for units that it takes from the logs."""
    open_units = {
        f.name: f.name.removesuffix("_unit")
        for f in dataclasses.fields(model)
        if f.name.endswith("_unit") and getattr(model, f.name) == "1"
    }
    return dataclasses.replace(model, **open_units)


def describe(model: Model) -> dict[str, Any]:
    """A model's entry in the catalogue as plain values."""
    return {
        "name": model.name,
        "title": model.title,
        "equation": model.equation,
        "source": model.source,
        "inputs": model.inputs,
        "outputs": model.outputs,
        "options": {f.name: getattr(model, f.name) for f in dataclasses.fields(model)},
        "parameters": [
            {
                "name": p.name,
                "unit": p.unit,
                "start": p.value,
                "lower": p.lower,
                "upper": p.upper,
                "fixed": p.fixed,
                "meaning": p.meaning,
                "source": p.source,
                "identified_by": model.identified_by.get(p.name),
            }
            for p in model.parameters().values()
        ],
    }


def print_description(model: Model) -> None:
    """Print one model's entry."""
    from softid_cli.tables import print_rows, print_text

    print_text(f"{model.name}: {model.title}")
    print_text(f"  {model.equation}")
    print_text(f"  source: {model.source}")
    print_text(f"  input: {', '.join(model.inputs) or 'any channel'}")
    print_text(f"  output: {', '.join(model.outputs) or 'any channel'}")
    if model.note:
        print_text(f"  note: {model.note}")
    click.echo()
    parameters = list(model.parameters().values())
    rows = [
        (p.name, p.unit, f"{_bound(p.lower)} … {_bound(p.upper)}", p.meaning) for p in parameters
    ]
    columns = [("parameter", "left"), ("unit", "left"), ("bounds", "left"), ("meaning", "left")]
    print_rows(columns, rows)
    shown = [
        (p.name, model.identified_by[p.name]) for p in parameters if p.name in model.identified_by
    ]
    if shown:
        click.echo()
        print_rows([("parameter", "left"), ("is identified by", "left")], shown)
    options = _option_rows(model)
    if options:
        click.echo()
        print_rows([("option", "left"), ("default", "left"), ("choices", "left")], options)


def _option_rows(model: Model) -> list[tuple[str, str, str]]:
    """Name, default and choices of what ``--option`` sets."""
    kinds = typing.get_type_hints(type(model))
    rows = []
    for field in dataclasses.fields(model):
        if follows_from_logs(field.name):
            continue
        default, kind = getattr(model, field.name), kinds[field.name]
        choices = typing.get_args(kind) if typing.get_origin(kind) is typing.Literal else ()
        shown = "not given" if default is None else str(default).lower()
        shown = f"{default:g}" if isinstance(default, float) else shown
        rows.append((field.name, shown or "none", ", ".join(str(c) for c in choices)))
    return rows


def _bound(value: float) -> str:
    return "any" if math.isinf(value) else f"{value:g}"
