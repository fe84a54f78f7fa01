"""`softid simulate`: the predicted response as CSV."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from softid_cli.console import announce_compilation, say
from softid_cli.options import FILE, channel_option, quiet_option

if TYPE_CHECKING:
    pass


@click.command()
@click.argument("params", type=FILE)
@click.option(
    "--input",
    "source",
    type=FILE,
    required=True,
    metavar="LOG",
    help="Log whose input drives the model; time and pressure are enough.",
)
@click.option("--out", type=FILE, metavar="FILE.csv", help="Write there instead of to stdout.")
@click.option("--force", is_flag=True, help="Replace the file if it is there already.")
@channel_option
@quiet_option
def simulate(
    params: Path,
    source: Path,
    out: Path | None,
    force: bool,
    channel: tuple[str, ...],
    quiet: bool,
) -> None:
    """Predict the response of the model in PARAMS (a params.json) to the input of a log.

    The CSV has time_s, the input, the simulated outputs in the units of the fitted logs, and the
    measured ones where the log has them. A log that was fitted gets its own sensor zero and initial
    state back; any other starts at rest with a zero of 0.
    """
    from softid.records import load_params, simulation_csv, write_atomic
    from softid.simulation import simulate as simulate_model

    saved = load_params(params)
    log = load_logs([source], channel, saved.input, saved.outputs)[0]
    if not quiet:
        announce_compilation(quiet=False)
        for issue in (*saved.issues, *_extrapolations(saved, log)):
            say(f"{issue.severity}: {issue.message}")
    nuisance = saved.nuisances.get(log.name) if _is_the_fitted_log(saved, log) else None
    simulation = simulate_model(saved.build_model(), saved.values, log, nuisance=nuisance)
    text = simulation_csv(simulation, display=saved.display)
    if out is None:
        click.echo(text, nl=False)
    else:
        write_atomic(out, text, overwrite=force)
        if not quiet:
            say(f"written to {out}")
