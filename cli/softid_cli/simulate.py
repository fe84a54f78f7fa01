"""`softid simulate`: the predicted response as CSV."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from softid_cli.console import announce_compilation, say
from softid_cli.options import FILE, assignments, channel_option, quiet_option

if TYPE_CHECKING:
    from softid.log import Log
    from softid.records import SavedModel


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
    from softid.identification.issues import extrapolation
    from softid.identification.stalls import as_remembered
    from softid.records import load_params, simulation_csv, write_atomic
    from softid.simulation import simulate as simulate_model

    saved = load_params(params)
    log = load_driving(source, channel, saved)
    if not quiet:
        beyond = extrapolation(log, log.input, saved.fitted_range)
        for issue in (*saved.issues, *log.issues, *([beyond] if beyond else [])):
            say(f"{issue.severity}: {issue.message}")
    with announce_compilation(quiet=quiet):
        model = saved.build_model()
        nuisance = saved.nuisance_for(log)
        log = as_remembered(log, model, saved.values)
        simulation = simulate_model(model, saved.values, log, nuisance=nuisance)
    text = simulation_csv(simulation, display=saved.display)
    if out is None:
        click.echo(text, nl=False)
    else:
        write_atomic(out, text, overwrite=force)
        if not quiet:
            say(f"written to {out}")


def load_driving(source: Path, channel: tuple[str, ...], saved: SavedModel) -> Log:
    """Read a log that needs the model's input only; an output that it lacks is all missing.

    Raises
    ------
    InputError
        The log cannot be read or lacks the input.
    """
    import numpy as np

    from softid.channels import make_channel
    from softid.identification.input_treatment import InputTreatment, input_as_fitted
    from softid.readers import load

    columns = assignments(channel, option="--channel", form="NAME=COL:UNIT")
    log = load(
        source,
        channels=columns or None,
        input=saved.input,
        outputs=None,
        roles_of=f"the model {saved.path}",
    )
    missing = {
        name: make_channel(name, np.full(len(log), np.nan), saved.display[name][0])
        for name in saved.outputs
        if name not in log.channels
    }
    driving = replace(log, channels={**log.channels, **missing}, outputs=saved.outputs)
    return input_as_fitted(driving, InputTreatment.of(saved)).with_intersample(saved.intersample)
