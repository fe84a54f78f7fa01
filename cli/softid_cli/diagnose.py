"""`softid diagnose`: what the simulation gets wrong, the named cause, and what mending it gains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from softid.errors import InputError, UsageError
from softid_cli.console import ProgressCallback, announce_compilation, progress, say
from softid_cli.model_options import (
    chosen_effects,
    described_models,
    model_option,
    shape_options,
    warn_of_assumptions,
)
from softid_cli.options import (
    FILE,
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
from softid_cli.requests import Request, takes
from softid_cli.results_folder import RESULTS, free_folder, require_place_for_results
from softid_cli.unfinished import unfinished_file

if TYPE_CHECKING:
    from softid.diagnosis_results import Diagnosis
    from softid.log import Log
    from softid.models.base import Model
    from softid.parameters import ParameterSet
    from softid.records import SavedModel

SUFFIX = "-diagnosis"


@dataclass(frozen=True)
class DiagnoseRequest(Request):
    """What the user asked of `softid diagnose`; the fields are its options."""

    params: Path | None = None
    effects: tuple[str, ...] = ()


def _names(ctx: click.Context, param: click.Parameter, text: str | None) -> tuple[str, ...]:
    del ctx, param
    names = tuple(dict.fromkeys(filter(None, map(str.strip, (text or "").split(",")))))
    if text is not None and not names:
        raise UsageError(
            "no effect is named",
            where="--effects",
            value=text,
            remedy="name at least one, or leave the option out for the whole catalogue",
        )
    return names


@click.command(cls=GreedyCommand, greedy=("--hold-out",))
@logs_argument
@model_option("Base model; without it softid chooses.")
@click.option(
    "--params",
    type=FILE,
    metavar="FILE",
    help="Take base model, roles and start values from a params.json.",
)
@hold_out_option("Logs that test the causes and are not fitted")
@click.option(
    "--effects",
    callback=_names,
    metavar="NAME[,NAME...]",
    help="Effects to consider; without it the whole catalogue.",
)
@log_options
@intersample_option
@shape_options
@out_options()
@no_plots_option("JSON files")
@seed_option
@json_option
@quiet_option
@takes(DiagnoseRequest)
def diagnose(request: DiagnoseRequest) -> None:
    """Name what a model of LOGs gets wrong, and measure what a correction gains.

    Prints a paragraph and a table of causes. Writes diagnosis.json, params.json of the base model,
    extended_params.json of the model with the causes, and plots to softid-out/LOG-diagnosis, or to
    DIR. Without --hold-out, blocks of the logs are held out. After an interruption the same command
    goes on from where it was.
    """
    examine(request)


def examine(request: DiagnoseRequest) -> None:
    """Load, diagnose, write and print.

    Raises
    ------
    UsageError
        The options contradict each other, or an effect is unknown.
    IdentificationError
        The base model could not be fitted; nothing is written.
    """
    request.require_logs("diagnose")
    from softid.records.diagnosis import RECORD

    require_place_for_results(request.out, RECORD, force=request.force)
    unfinished = unfinished_file(request)
    if request.effects:  # said before the work
        chosen_effects(request.effects, where="--effects")
    try:
        found, plots = _found(request, unfinished)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_how_to_go_on(request, unfinished)) from None
    _deliver(request, found, plots)


def _how_to_go_on(request: DiagnoseRequest, unfinished: Path) -> str:
    """What an interrupted user may do, without what this run had already."""
    sooner = []
    if request.model is None and request.params is None:
        sooner.append("--model NAME")
    if not request.effects:
        sooner.append("--effects NAME[,NAME...]")
    elif len(request.effects) > 1:
        sooner.append("fewer --effects")
    again = "no result was written; run the same command again"
    if unfinished.exists():
        size = unfinished.stat().st_size / 1e6
        again += f" to go on from here ({unfinished} has what was found, {size:.0f} MB)"
    return f"{again}, or be done sooner with {' or '.join(sooner)}" if sooner else again


def _found(request: DiagnoseRequest, unfinished: Path) -> tuple[Diagnosis, dict[str, bytes]]:
    """The diagnosis and its plots."""
    model, parameters, saved = _base(request)
    logs = load_logs(
        (*request.logs, *request.hold_out),
        request.channel,
        request.input or (saved.input if saved else None),
        request.output or (saved.outputs if saved else ()),
        roles_of=request.params if saved and not (request.input or request.output) else None,
        intersample=request.intersample or (saved.intersample if saved else None),
    )

    if saved is None:
        warn_of_assumptions(model, request.geometry, quiet=request.quiet)
    if not request.quiet:
        _warn_early(logs)

    from softid.diagnosis import diagnose as diagnose_logs

    with announce_compilation(quiet=request.quiet), progress(quiet=request.quiet) as report:
        found = diagnose_logs(
            logs[: len(request.logs)],
            hold_out=logs[len(request.logs) :],
            model=model,
            parameters=parameters,
            preferred=described_models(request.geometry) if model is None else (),
            effects=request.effects,
            seed=request.seed,
            progress=_with_news(report),
            checkpoint=unfinished,
        )
        if request.no_plots:
            return found, {}
        if report is not None:
            report("drawing", 1.0)
        from softid.plots import png_files

        return found, png_files(found)


def _with_news(report: ProgressCallback | None) -> ProgressCallback | None:
    """The progress, with a line of its own for a run that goes on."""
    if report is None:
        return None
    from softid.records.checkpoint import GOES_ON

    def told(stage: str, fraction: float) -> None:
        if stage == GOES_ON:
            say(f"info: {stage}")
        else:
            report(stage, fraction)

    return told


def _warn_early(logs: Sequence[Log]) -> None:
    """Say what makes a search of minutes pointless while it can still be stopped."""
    from softid.quality.causality import leading_outputs
    from softid.quality.gauge_pressure import vacuums
    from softid.quality.second_inputs import independent_inputs, second_input_issues

    for log in logs:
        apart = second_input_issues(independent_inputs(log), log.input)
        for issue in (*leading_outputs(log), *vacuums(log), *apart):
            say(f"{issue.severity}: {log.name}: {issue.message}")


def _base(
    request: DiagnoseRequest,
) -> tuple[Model | None, ParameterSet | None, SavedModel | None]:
    """The base model, its start values and the record that they come from."""
    chosen = request.chosen_model()
    if request.params is None:
        return chosen, None, None
    again = request.options_of_model
    if again:
        raise UsageError(
            "the base model is given twice",
            where=", ".join(("--params", *again)),
            remedy="give either --params or --model with its options",
        )
    from softid.records import load_params

    saved = load_params(request.params)
    if saved.model.effects:
        raise InputError(
            "this model has effects already",
            where=str(request.params),
            value=", ".join(saved.model.effects),
            remedy="name the params.json of the model without effects; they are found anew",
        )
    model = saved.build_model()
    return model, model.parameters().with_values(saved.values), saved


def _deliver(request: DiagnoseRequest, found: Diagnosis, plots: Mapping[str, str | bytes]) -> None:
    """Write first, then print: what is printed stands, and an error means that nothing does."""
    from softid.records import diagnosis_files, dump_json, plot_fingerprints, write_folder
    from softid.records.diagnosis import RECORD, superseded

    documents: dict[str, Any] = dict(diagnosis_files(found))
    if plots:
        documents[RECORD] |= {"plots": dict(plot_fingerprints(plots))}
    name = next(iter(found.base.fingerprints)).replace("/", "_")
    folder = request.out or free_folder(RESULTS / f"{name}{SUFFIX}")
    written = write_folder(
        folder,
        {name: dump_json(document) for name, document in documents.items()} | dict(plots),
        overwrite=request.force,
        superseded=superseded(folder),
    )
    if request.as_json:
        files = [str(path) for path in written]
        click.echo(dump_json(documents[RECORD] | {"files": files}), nl=False)
        return
    from softid_cli.diagnosis_tables import print_diagnosis
    from softid_cli.tables import print_files

    print_diagnosis(found)
    print_files(folder, [path.name for path in written])
