"""`softid synthesize`: logs whose true parameters are known."""

from __future__ import annotations

from pathlib import Path

import click

from softid.errors import UsageError
from softid_cli.console import progress, say
from softid_cli.options import FILE, json_option, out_options, quiet_option

DEFAULT_OUT = Path("softid-out") / "synthetic"


@click.command()
@click.argument("recipes", nargs=-1, type=FILE, metavar="[RECIPE]...")
@click.option("--seed", type=click.IntRange(min=0), metavar="N", help="Use this seed in each.")
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
    """
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
