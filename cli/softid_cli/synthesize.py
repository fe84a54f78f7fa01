"""`softid synthesize`: logs whose true parameters are known."""

from __future__ import annotations

from pathlib import Path

import click

from softid.errors import UsageError
from softid_cli.console import progress, say
from softid_cli.hiding import HideRequest, hide_effects, split_names
from softid_cli.model_options import model_option
from softid_cli.options import FILE, json_option, out_options, quiet_option

DEFAULT_OUT = Path("softid-out") / "synthetic"


@click.command()
@click.argument("recipes", nargs=-1, type=FILE, metavar="[RECIPE]...")
@click.option("--seed", type=click.IntRange(min=0), metavar="N", help="Use this seed in each.")
@click.option(
    "--hide",
    metavar="NAME[,NAME...]",
    help="Make a log and its hold-out of a random actuator in which these effects are hidden; "
    "none hides nothing.",
)
@click.option("--size", type=float, metavar="S", help="Magnitude of the effects; 1 is moderate.")
@click.option("--protocol", metavar="NAME", help="rich (default), paper, sine, step or slow.")
@model_option("muscle (default), oscillator or equilibrium.")
@click.option("--noise", type=float, metavar="SHARE", help="Output noise over its range; 0.005.")
@click.option("--coloured", type=float, metavar="SHARE", help="Coloured part of its variance; 0.")
@click.option("--rate", type=float, metavar="HZ", help="Sampling rate; 100.")
@click.option("--rest", type=float, metavar="S", help="Seconds of rest added at the end.")
@click.option("--unit", type=click.Choice(["mm", "deg"]), help="Unit of the output; mm.")
@click.option(
    "--check",
    is_flag=True,
    help="Write nothing: make the logs again and exit with 1 if any differs from the manifest "
    "in DIR (without --out, the bundled one).",
)
@out_options
@json_option
@quiet_option
@click.pass_context
def synthesize(
    ctx: click.Context,
    recipes: tuple[Path, ...],
    seed: int | None,
    hide: str | None,
    size: float | None,
    protocol: str | None,
    model: str | None,
    noise: float | None,
    coloured: float | None,
    rate: float | None,
    rest: float | None,
    unit: str | None,
    check: bool,
    out: Path | None,
    force: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Make a synthetic log, its truth known, from each RECIPE (TOML).

    Without recipes all bundled logs are made again, byte for byte. DIR gets the folders recipes and
    data and a manifest.json with truth, noise, seed and fingerprint of every log. Without --out
    that is softid-out/synthetic.

    With --hide, DIR gets train.csv, hold_out.csv and truth.json instead; without --out that is
    softid-out/hidden. A name that is unknown gets the list of all.
    """
    asked = {"size": size, "protocol": protocol, "model": model}
    recorded = {
        "noise": noise,
        "coloured_share": coloured,
        "rate_hz": rate,
        "rest_s": rest,
        "unit": unit,
    }
    given = any(value is not None for value in (*asked.values(), *recorded.values()))
    if hide is not None:
        if check or recipes:
            raise UsageError(
                "effects are hidden in new logs, not in recipes or checks",
                where="--hide",
                remedy="leave out the recipes and --check",
            )
        hide_effects(
            HideRequest(
                names=split_names(hide),
                seed=seed or 0,
                asked={k: v for k, v in asked.items() if v is not None},
                recorded={k: v for k, v in recorded.items() if v is not None},
                out=out,
                force=force,
                as_json=as_json,
                quiet=quiet,
            )
        )
        return
    if given:
        raise UsageError(
            "--size, --protocol, --model, --noise, --coloured, --rate, --rest and --unit belong to "
            "--hide; a recipe says all this itself",
            remedy="add --hide NAME, or --hide none",
        )
    if check and (seed is not None or force):
        raise UsageError(
            "a check takes the seeds from the manifest and writes nothing",
            where="--check",
            remedy="leave out --seed and --force",
        )
    if check:
        passed = compare(recipes, out=out, as_json=as_json, quiet=quiet)
        if not passed:
            ctx.exit(1)
    else:
        make(
            recipes,
            out=out or DEFAULT_OUT,
            seed=seed,
            force=force,
            as_json=as_json,
            quiet=quiet,
        )


def make(
    recipes: tuple[Path, ...],
    *,
    out: Path,
    seed: int | None,
    force: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Make logs and write them."""
    from softid.records import dump_json
    from softid.synthesis import bundled_recipes, make_dataset, write_dataset
    from softid_cli.tables import print_rows

    with progress(quiet=quiet) as report:
        dataset = make_dataset(recipes or bundled_recipes(), seed=seed, progress=report)
    write_dataset(dataset, out, overwrite=force)
    if not quiet:
        say(f"written to {out}")
    if as_json:
        click.echo(dump_json({"out": str(out), "logs": list(dataset.entries)}), nl=False)
        return
    print_rows(
        [("log", "left"), ("model", "left"), ("rows", "right"), ("seed", "right"), ("", "left")],
        [
            (log.name, log.recipe.model, str(log.time_s.size), str(log.seed), log.recipe.title)
            for log in dataset.logs
        ],
    )


def compare(recipes: tuple[Path, ...], *, out: Path | None, as_json: bool, quiet: bool) -> bool:
    """Make logs again and compare; returns whether all are equal."""
    from softid.records import dump_json
    from softid.synthesis import bundled_datasets, check_dataset

    folder = out or bundled_datasets()
    with progress(quiet=quiet) as report:
        differences = check_dataset(folder, recipes=recipes, progress=report)
    if as_json:
        found = {"folder": str(folder), "equal": not differences, "differences": differences}
        click.echo(dump_json(found), nl=False)
    else:
        for difference in differences:
            click.echo(difference)
        if not differences:
            click.echo(f"All logs of {folder} are made again byte for byte.")
    return not differences
