"""`softid fit`: from logs to parameters, tables, plots and params.json."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from softid.errors import IdentificationError, UsageError
from softid_cli.console import announce_compilation, progress
from softid_cli.model_options import (
    chosen_model,
    chosen_parameters,
    described_models,
    require_parameters,
    shape_options,
)
from softid_cli.options import (
    FILE,
    GreedyCommand,
    intersample_option,
    json_option,
    load_logs,
    log_options,
    out_options,
    quiet_option,
)
from softid_cli.profiles import print_profiles, profile_entries, profile_figures, profiled
from softid_cli.results_folder import free_folder, refuse_old_results

if TYPE_CHECKING:
    from softid.log import Log
    from softid.results import FitResult
    from softid.uncertainty.profile import ProfileResult

RESULTS = Path("softid-out")
PARAMS = "params.json"


@dataclass(frozen=True)
class FitRequest:
    """What the user asked of `softid fit`; the fields are its options."""

    logs: tuple[Path, ...]
    hold_out: tuple[Path, ...] = ()
    model: str | None = None
    damping: str | None = None
    fixed_length: float | None = None
    diameter: float | None = None
    geometry: Path | None = None
    options: tuple[str, ...] = ()
    profile: tuple[str, ...] = ()
    fix: tuple[str, ...] = ()
    bound: tuple[str, ...] = ()
    tie: tuple[str, ...] = ()
    channel: tuple[str, ...] = ()
    input: str | None = None
    output: tuple[str, ...] = ()
    intersample: str | None = None
    out: Path | None = None
    force: bool = False
    plots: bool = True
    seed: int = 0
    as_json: bool = False
    quiet: bool = False


@click.command(cls=GreedyCommand, greedy=("--hold-out",))
@click.argument("logs", nargs=-1, type=FILE, metavar="LOG...")
@click.option("--model", metavar="NAME", help="Model; without it softid chooses and says why.")
@click.option(
    "--hold-out",
    multiple=True,
    type=FILE,
    metavar="LOG...",
    help="Logs to score but not to fit: all up to the next option.",
)
@click.option(
    "--fix", multiple=True, metavar="NAME=VALUE", help="Hold a parameter; may be repeated."
)
@click.option(
    "--bound",
    multiple=True,
    metavar="NAME=LO:HI",
    help="Bound a parameter; either end may be empty; may be repeated.",
)
@click.option(
    "--tie",
    multiple=True,
    metavar="NAME=EXPR",
    help="Compute a parameter from others, such as a2=0.1*c2; may be repeated.",
)
@log_options
@intersample_option
@shape_options
@click.option(
    "--profile",
    multiple=True,
    metavar="NAME",
    help="Interval of a parameter by refitting all others along it; may be repeated.",
)
@out_options
@click.option("--no-plots", is_flag=True, help="Write params.json only.")
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    metavar="N",
    help="Random seed.",
)
@json_option
@quiet_option
def fit(
    logs: tuple[Path, ...],
    model: str | None,
    hold_out: tuple[Path, ...],
    fix: tuple[str, ...],
    bound: tuple[str, ...],
    tie: tuple[str, ...],
    channel: tuple[str, ...],
    input: str | None,
    output: tuple[str, ...],
    intersample: str | None,
    damping: str | None,
    fixed_length: float | None,
    diameter: float | None,
    geometry: Path | None,
    option: tuple[str, ...],
    profile: tuple[str, ...],
    out: Path | None,
    force: bool,
    no_plots: bool,
    seed: int,
    as_json: bool,
    quiet: bool,
) -> None:
    """Identify a model from one or more LOGs of the same actuator.

    Prints parameters with errors, 95 % intervals and what the logs say about each, and how well the
    simulated response follows every log. Writes params.json and plots to softid-out/LOG, or to DIR.
    """
    identify(
        FitRequest(
            logs=logs,
            hold_out=hold_out,
            model=model,
            damping=damping,
            fixed_length=fixed_length,
            diameter=diameter,
            geometry=geometry,
            options=option,
            profile=profile,
            fix=fix,
            bound=bound,
            tie=tie,
            channel=channel,
            input=input,
            output=output,
            intersample=intersample,
            out=out,
            force=force,
            plots=not no_plots,
            seed=seed,
            as_json=as_json,
            quiet=quiet,
        )
    )


def identify(request: FitRequest) -> None:
    """Load, fit, print and write.

    Raises
    ------
    UsageError
        The options contradict each other.
    IdentificationError
        The optimum was not reached; nothing is written.
    """
    if not request.logs:
        raise UsageError(
            "no log was given to fit",
            remedy="name at least one log before --hold-out"
            if request.hold_out
            else "name at least one log",
        )
    refuse_old_results(request.out, PARAMS, force=request.force)
    model = chosen_model(
        request.model,
        damping=request.damping,
        fixed_length_mm=request.fixed_length,
        diameter_mm=request.diameter,
        geometry=request.geometry,
        other=request.options,
    )
    require_parameters(model, request.profile, option="--profile")
    preferred = () if model is not None else described_models(request.geometry)
    parameters = chosen_parameters(model, fix=request.fix, bound=request.bound, tie=request.tie)
    paths = (*request.logs, *request.hold_out)
    logs = load_logs(
        paths,
        request.channel,
        request.input,
        request.output,
        intersample=request.intersample,
    )

    from softid.identification import fit as fit_model

    fitted, held_out = logs[: len(request.logs)], logs[len(request.logs) :]
    with announce_compilation(quiet=request.quiet), progress(quiet=request.quiet) as report:
        result = fit_model(
            fitted,
            model=model,
            preferred=preferred,
            hold_out=held_out,
            parameters=parameters,
            seed=request.seed,
            progress=report,
        )
        if not result.success:
            raise IdentificationError(
                f"{result.status.value}, so no results were written",
                where=", ".join(map(str, request.logs)),
                remedy="fix or bound a parameter, choose a simpler --model, or add a log",
            )
        profiles = profiled(result, fitted, request.profile, progress=report)
    _deliver(request, result, profiles, fitted[0])


def _deliver(
    request: FitRequest, result: FitResult, profiles: Mapping[str, ProfileResult], first: Log
) -> None:
    """Write first, then print: what is printed stands, and an error means that nothing does."""
    from softid.records import (
        dump_json,
        fit_document,
        plot_fingerprints,
        recorded_plots,
        write_folder,
    )

    document = fit_document(result)
    if profiles:
        document |= {"profiles": profile_entries(profiles)}
    plots: dict[str, str | bytes] = {}
    if request.plots:
        from softid_cli.figures import drawn

        plots = drawn(result) | profile_figures(result, profiles)
        document |= {"plots": dict(plot_fingerprints(plots))}
    folder = request.out or free_folder(RESULTS / first.name.replace("/", "_"))
    written = write_folder(
        folder,
        {PARAMS: dump_json(document), **plots},
        overwrite=request.force,
        superseded=recorded_plots(folder / PARAMS),
    )
    if request.as_json:
        click.echo(dump_json(document | {"files": [str(p) for p in written]}), nl=False)
    else:
        from softid_cli.tables import print_files, print_fit

        print_fit(result)
        print_profiles(result, profiles)
        print_files(folder, [p.name for p in written])
