"""`softid fit`: from logs to parameters, tables, plots and params.json."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from softid.errors import IdentificationError
from softid_cli.console import announce_compilation, progress
from softid_cli.model_options import (
    chosen_parameters,
    described_models,
    model_option,
    require_parameters,
    shape_options,
    warn_of_assumptions,
)
from softid_cli.options import (
    GreedyCommand,
    hold_out_option,
    intersample_option,
    json_option,
    load_logs,
    log_options,
    logs_argument,
    no_plots_option,
    out_options,
    quiet_option,
    seed_option,
)
from softid_cli.profiles import print_profiles, profile_entries, profile_figures, profiled
from softid_cli.requests import Request, takes
from softid_cli.results_folder import RESULTS, free_folder, require_place_for_results

if TYPE_CHECKING:
    from softid.log import Log
    from softid.results import FitResult
    from softid.uncertainty.profile import ProfileResult

PARAMS = "params.json"


@dataclass(frozen=True)
class FitRequest(Request):
    """What the user asked of `softid fit`; the fields are its options."""

    profile: tuple[str, ...] = ()
    fix: tuple[str, ...] = ()
    bound: tuple[str, ...] = ()
    tie: tuple[str, ...] = ()


@click.command(cls=GreedyCommand, greedy=("--hold-out",))
@logs_argument
@model_option("Model; without it softid chooses and says why.")
@hold_out_option("Logs that are scored but not fitted")
@click.option(
    "--fix",
    multiple=True,
    metavar="NAME=VALUE",
    help="Fix a parameter at a value; may be repeated.",
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
    help="Profile-likelihood interval of a parameter: it is stepped and all others are refitted; "
    "may be repeated.",
)
@out_options()
@no_plots_option("params.json")
@seed_option
@json_option
@quiet_option
@takes(FitRequest)
def fit(request: FitRequest) -> None:
    """Identify a model from one or more LOGs of the same actuator.

    Prints parameters with errors, 95 % intervals and what the logs say about each, and how well the
    simulated response follows every log. Writes params.json and plots to softid-out/LOG, or to DIR.
    """
    identify(request)


def identify(request: FitRequest) -> None:
    """Load, fit, write, then print.

    Raises
    ------
    UsageError
        The options contradict each other.
    IdentificationError
        The optimum was not reached; nothing is written.
    """
    request.require_logs("fit")
    require_place_for_results(request.out, PARAMS, force=request.force)
    model = request.chosen_model()
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

    warn_of_assumptions(model, request.geometry, quiet=request.quiet)

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
    if not request.no_plots:
        from softid.plots import png_files  # matplotlib, 0.4 s

        plots = {**png_files(result), **profile_figures(result, profiles)}
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
