"""`softid synthesize`: logs whose true parameters are known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from softid.errors import UsageError
from softid.sentences import listed
from softid_cli.console import progress, say
from softid_cli.hiding import HideRequest, hide_effects, split_names
from softid_cli.model_options import model_option
from softid_cli.options import FILE, json_option, named_if, out_options, quiet_option
from softid_cli.requests import takes
from softid_cli.results_folder import RESULTS

DEFAULT_OUT = RESULTS / "synthetic"


@dataclass(frozen=True)
class SynthesizeRequest:
    """What the user asked of `softid synthesize`; the fields are its options."""

    recipes: tuple[Path, ...] = ()
    seed: int | None = None
    hide: str | None = None
    size: float | None = None
    protocol: str | None = None
    model: str | None = None
    noise: float | None = None
    coloured: float | None = None
    rate: float | None = None
    rest: float | None = None
    unit: str | None = None
    check: bool = False
    out: Path | None = None
    force: bool = False
    as_json: bool = False
    quiet: bool = False

    @property
    def asked(self) -> Mapping[str, Any]:
        """Options of `hidden_pair` that were given."""
        return _given({"size": self.size, "protocol": self.protocol, "model": self.model})

    @property
    def recorded(self) -> Mapping[str, Any]:
        """Fields of the rig of hidden effects that were given."""
        return _given(
            {
                "noise": self.noise,
                "coloured_share": self.coloured,
                "rate_hz": self.rate,
                "rest_s": self.rest,
                "unit": self.unit,
            }
        )

    @property
    def of_hiding(self) -> tuple[str, ...]:
        """Options that were given and have a meaning beside ``--hide`` only."""
        names = ("size", "protocol", "model", "noise", "coloured", "rate", "rest", "unit")
        return named_if({f"--{name}": getattr(self, name) is not None for name in names})

    def require_consistency(self) -> None:
        """Refuse options of which one has no meaning beside another.

        Raises
        ------
        UsageError
            An option belongs to hidden effects, to recipes or to neither of them.
        """
        if self.hide is not None:
            beside = named_if({"the recipes": self.recipes, "--check": self.check})
            if beside:
                raise UsageError(
                    "effects are hidden in new logs, not in recipes or checks",
                    where="--hide",
                    remedy=f"leave out {listed(beside)}",
                )
        elif self.of_hiding:
            raise UsageError(
                "without --hide the recipe says this",
                where=", ".join(self.of_hiding),
                remedy="add --hide NAME, or --hide none",
            )
        elif self.check:
            given = named_if({"--seed": self.seed is not None, "--force": self.force})
            if given:
                raise UsageError(
                    "a check takes the seeds from the manifest and writes nothing",
                    where="--check",
                    remedy=f"leave out {listed(given)}",
                )


def _given(options: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in options.items() if value is not None}


@click.command()
@click.argument("recipes", nargs=-1, type=FILE, metavar="[RECIPE]...")
@click.option("--seed", type=click.IntRange(min=0), metavar="N", help="Random seed for every log.")
@click.option(
    "--hide",
    metavar="NAME[,NAME...]",
    help="Make a log and a hold-out of a random actuator with these effects hidden in them, or "
    "with none if NAME is none. An unknown name prints the list of all.",
)
@click.option("--size", type=float, metavar="FACTOR", help="Size of the effects; 1 is moderate.")
@click.option(
    "--protocol",
    metavar="NAME",
    help="Excitation: rich (default; staircase, sine, chirp, hold), paper (steps, one sine), "
    "levels (random held levels), lever (random ramps), triangles (three triangle speeds), "
    "multisine (25 tones, hold), sine (0.5 Hz only), step (one single step) or slow (one slow "
    "triangle).",
)
@model_option("Model of the actuator: muscle (default), oscillator or equilibrium.")
@click.option(
    "--noise",
    type=float,
    metavar="SHARE",
    help="Standard deviation of the output noise, as a fraction of the output range (default "
    "0.005).",
)
@click.option(
    "--coloured",
    type=float,
    metavar="SHARE",
    help="Fraction of the noise variance that is coloured (default 0).",
)
@click.option("--rate", type=float, metavar="HZ", help="Sampling rate in Hz (default 100).")
@click.option(
    "--rest", type=float, metavar="S", help="Seconds of rest added at the end (default 0)."
)
@click.option("--unit", type=click.Choice(["mm", "deg"]), help="Unit of the output (default mm).")
@click.option(
    "--check",
    is_flag=True,
    help="Write nothing: make the logs again and exit with 1 if any differs from the manifest "
    "in DIR (without --out, the bundled one).",
)
@out_options()
@json_option
@quiet_option
@takes(SynthesizeRequest)
def synthesize(request: SynthesizeRequest) -> None:
    """Make a synthetic log with known true parameters from each RECIPE (TOML).

    Without recipes all bundled logs are made again, byte for byte. DIR gets the folders recipes and
    data and a manifest.json with truth, noise, seed and fingerprint of every log. Without --out
    that is softid-out/synthetic.

    With --hide, DIR gets train.csv, hold_out.csv and truth.json instead; without --out that is
    softid-out/hidden. The options --size, --protocol, --model, --noise, --coloured, --rate, --rest
    and --unit need --hide.
    """
    request.require_consistency()
    if request.hide is not None:
        hide_effects(
            HideRequest(
                names=split_names(request.hide),
                seed=request.seed or 0,
                asked=request.asked,
                recorded=request.recorded,
                out=request.out,
                force=request.force,
                as_json=request.as_json,
                quiet=request.quiet,
            )
        )
    elif not request.check:
        make(request)
    elif not compare(request):
        click.get_current_context().exit(1)


def make(request: SynthesizeRequest) -> None:
    """Make logs and write them."""
    from softid.records import dump_json
    from softid.synthesis import bundled_recipes, make_dataset, write_dataset
    from softid_cli.tables import print_rows

    recipes, out = request.recipes or bundled_recipes(), request.out or DEFAULT_OUT
    with progress(quiet=request.quiet) as report:
        dataset = make_dataset(recipes, seed=request.seed, progress=report)
    write_dataset(dataset, out, overwrite=request.force)
    if not request.quiet:
        say(f"written to {out}")
    if request.as_json:
        click.echo(dump_json({"out": str(out), "logs": list(dataset.entries)}), nl=False)
        return
    print_rows(
        [("log", "left"), ("model", "left"), ("rows", "right"), ("seed", "right"), ("", "left")],
        [
            (log.name, log.recipe.model, str(log.time_s.size), str(log.seed), log.recipe.title)
            for log in dataset.logs
        ],
    )


def compare(request: SynthesizeRequest) -> bool:
    """Make logs again and compare; returns whether all are equal."""
    from softid.records import dump_json
    from softid.synthesis import bundled_datasets, check_dataset

    folder = request.out or bundled_datasets()
    with progress(quiet=request.quiet) as report:
        differences = check_dataset(folder, recipes=request.recipes, progress=report)
    if request.as_json:
        found = {"folder": str(folder), "equal": not differences, "differences": differences}
        click.echo(dump_json(found), nl=False)
    else:
        for difference in differences:
            click.echo(difference)
        if not differences:
            click.echo(f"All logs of {folder} are made again byte for byte.")
    return not differences
