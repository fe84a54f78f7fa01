"""`softid effects`: the catalogue of physical effects."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from softid_cli.model_options import chosen_effects
from softid_cli.options import json_option, quiet_option

if TYPE_CHECKING:
    from softid.effects import Effect, Scale

STAGE_TITLES = {
    "input": "Between the recorded input and the actuator",
    "state": "In the equation of motion",
    "output": "Between the motion and the recorded output",
}
EXAMPLE = "a log of 60 s at 100 Hz, 0 to 200 kPa, 0 to 1.5 rad"


@click.command()
@click.argument("name", required=False)
@json_option
@quiet_option
def effects(name: str | None, as_json: bool, quiet: bool) -> None:
    """List the physical effects, or explain the one called NAME."""
    del quiet  # there is nothing on stderr to silence
    from softid.effects import EFFECTS
    from softid.records import dump_json

    chosen = chosen_effects(() if name is None else (name,))
    if as_json:
        click.echo(dump_json([describe(effect) for effect in chosen]), nl=False)
    elif name is None:
        print_list(chosen)
    else:
        variants = [key for key in EFFECTS if key != name and key.split(".")[0] == name]
        print_description(chosen[0], variants)


def example_scale() -> Scale:
    """Sizes of an ordinary log, for bounds that depend on them."""
    from softid.effects.registration import EXAMPLE as ORDINARY_LOG

    return ORDINARY_LOG


def describe(effect: Effect) -> dict[str, Any]:
    """An effect's entry in the catalogue as plain values."""
    from softid.effects import confusable_with

    return {
        "name": effect.key,
        "stage": effect.stage,
        "title": effect.title,
        "law": effect.law,
        "meaning": effect.meaning,
        "signature": effect.signature,
        "neighbours": confusable_with(effect),
        "shown_by": effect.shown_by,
        "remedy": effect.remedy or None,
        "source": effect.source,
        "amplitude": effect.amplitude,
        "bounds_for": EXAMPLE,
        "parameters": [
            {
                "name": p.name,
                "unit": p.unit,
                "start": p.value,
                "lower": p.lower,
                "upper": p.upper,
                "meaning": p.meaning,
            }
            for p in effect.parameters(example_scale()).values()
        ],
    }


def print_list(chosen: Sequence[Effect]) -> None:
    """Print the catalogue, one table per stage."""
    from softid_cli.tables import print_rows, print_text

    for stage, title in STAGE_TITLES.items():
        print_text(f"{title}:")
        rows = [(e.key, e.title, e.shown_by) for e in chosen if e.stage == stage]
        print_rows([("effect", "left"), ("what it is", "left"), ("is shown by", "left")], rows)
        click.echo()
    click.echo("`softid effects NAME` shows law, meaning, parameters, signature and remedy.")


def print_description(effect: Effect, variants: list[str]) -> None:
    """Print one effect's entry."""
    from softid.effects import confusable_with
    from softid_cli.tables import print_rows, print_text

    print_text(f"{effect.key}: {effect.title}")
    print_text(f"  {effect.law}")
    print_text(f"  source: {effect.source}")
    print_text(f"  where: {STAGE_TITLES[effect.stage].lower()}")
    if variants:
        print_text(f"  richer or other forms: {', '.join(variants)}")
    click.echo()
    print_text(effect.meaning)
    print_text(f"Signature: {effect.signature}")
    print_text(f"Shown by: {effect.shown_by}")
    if confused := confusable_with(effect):
        print_text(f"Easily confused with: {', '.join(confused)}")
    print_text(f"Remedy: {effect.remedy or 'none in hardware; keep it in the model'}")
    click.echo()
    rows = [
        (p.name, p.unit, f"{p.lower:.3g} … {p.upper:.3g}", p.meaning)
        for p in effect.parameters(example_scale()).values()
    ]
    columns = [("parameter", "left"), ("unit", "left"), ("bounds", "left"), ("meaning", "left")]
    print_rows(columns, rows)
    print_text(f"Bounds for {EXAMPLE}; they follow from the log.")
