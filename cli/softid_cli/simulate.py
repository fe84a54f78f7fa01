"""`softid simulate`: the predicted response as CSV."""

from __future__ import annotations

from pathlib import Path

import click

from softid_cli.console import announce_compilation, say
from softid_cli.options import FILE, assignments, channel_option, quiet_option


@click.command()
@click.argument("params", type=FILE)
@click.option(
    "--input",
    "source",
    type=FILE,
    required=True,
    metavar="LOG",
    help="Log file whose input channel drives the model; it needs only time and the input. (In "
    "other commands --input names a channel.)",
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

    The CSV has time_s, the input as the model takes it (without its noise where the fitted logs
    were taken so), the simulated outputs in the units of the fitted logs, and the measured ones
    where the log has them. A log that was fitted gets its own sensor zero and initial state back;
    any other starts at rest with the mean sensor zero of the fitted logs.
    """
    from softid.prediction import simulate as predict
    from softid.readers import load
    from softid.records import load_params, simulation_csv, write_atomic

    saved = load_params(params)
    log = load(
        source,
        channels=assignments(channel, option="--channel", form="NAME=COL:UNIT") or None,
        input=saved.input,
        outputs=None,
        roles_of=f"the model {saved.path}",
    )
    with announce_compilation(quiet=quiet):
        simulation = predict(saved, log)
    if not quiet:
        for issue in simulation.issues:
            say(f"{issue.severity}: {issue.message}")
    text = simulation_csv(simulation, display=saved.display)
    if out is None:
        click.echo(text, nl=False)
    else:
        write_atomic(out, text, overwrite=force)
        if not quiet:
            say(f"written to {out}")
