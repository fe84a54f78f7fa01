"""`softid validate`: score a model on other logs, or check softid against known truths."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from softid.errors import InputError, UsageError
from softid_cli.console import announce_compilation, progress, say
from softid_cli.options import (
    FILE,
    channel_option,
    json_option,
    load_logs,
    named_if,
    out_options,
    quiet_option,
)

if TYPE_CHECKING:
    from softid.validation import SelfCheck, SelfCheckGroup

MOST_PERCENT = 100.0
RECORD = "validation.json"
CHECKED = ("truth", "estimate", "95 % interval", "off")


@click.command()
@click.argument("params", required=False, type=FILE)
@click.argument("logs", nargs=-1, type=FILE, metavar="[LOG]...")
@click.option(
    "--threshold",
    type=float,
    metavar="PERCENT",
    help="Lowest acceptable fit %; exit with code 1 if any fit is below it, or none is defined.",
)
@channel_option
@out_options("Folder for validation.json and plots; without it nothing is written.")
@json_option
@quiet_option
@click.pass_context
def validate(
    ctx: click.Context,
    params: Path | None,
    logs: tuple[Path, ...],
    threshold: float | None,
    channel: tuple[str, ...],
    out: Path | None,
    force: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Score the model in PARAMS (a params.json) on logs that it did not see.

    Without arguments softid checks itself: it refits every bundled synthetic log and compares the
    parameters with the truth.
    """
    if threshold is not None and not -math.inf < threshold <= MOST_PERCENT:
        raise UsageError(
            "no fit can be judged by this bar",
            where="--threshold",
            value=threshold,
            remedy="give a fit in per cent, of which 100 is perfect",
        )
    given = named_if(
        {
            "--threshold": threshold is not None,
            "--channel": channel,
            "--out": out is not None,
            "--force": force,
        }
    )
    if params is None and given:
        raise UsageError(
            "this belongs to a model and logs, and the self-check has none",
            where=", ".join(given),
            remedy="name PARAMS and a LOG, or leave it out",
        )
    if params is None:
        passed = check_self(as_json=as_json, quiet=quiet)
    elif not logs:
        raise UsageError(
            "no log was given to score the model on",
            where=str(params),
            remedy="name at least one log after it",
        )
    else:
        passed = score(
            params,
            logs,
            threshold=threshold,
            channel=channel,
            out=out,
            force=force,
            as_json=as_json,
            quiet=quiet,
        )
    if not passed:
        ctx.exit(1)


def score(
    params: Path,
    paths: tuple[Path, ...],
    *,
    threshold: float | None,
    channel: tuple[str, ...],
    out: Path | None,
    force: bool,
    as_json: bool,
    quiet: bool,
) -> bool:
    """Score a saved model; returns whether it reached the bar."""
    from softid.records import (
        dump_json,
        load_params,
        plot_fingerprints,
        recorded_plots,
        validation_document,
        write_folder,
    )
    from softid.records.reading import NoRecordError
    from softid.validation import validate as validate_model
    from softid_cli.tables import print_validation

    try:
        saved = load_params(params)
    except NoRecordError as error:
        raise InputError(
            error.what,
            where=error.where,
            value=error.value,
            remedy="name the params.json first, then the logs",
        ) from error
    logs = load_logs(paths, channel, saved.input, saved.outputs, roles_of=params)
    with announce_compilation(quiet=quiet):
        result = validate_model(saved, logs, threshold_percent=threshold)
    noticed = [issue for issue in saved.issues if issue not in result.issues]
    result = replace(result, issues=(*noticed, *result.issues))
    document = validation_document(result, params=params)
    if out is not None:
        from softid.plots import png_files

        plots: dict[str, str | bytes] = {**png_files(result)}
        document |= {"plots": dict(plot_fingerprints(plots))}
        files = {RECORD: dump_json(document), **plots}
        write_folder(out, files, overwrite=force, superseded=recorded_plots(out / RECORD))
        if not quiet:
            say(f"written to {out}: {', '.join(files)}")
    if as_json:
        click.echo(dump_json(document), nl=False)
    else:
        print_validation(result)
    return result.passed


def check_self(*, as_json: bool, quiet: bool) -> bool:
    """Refit the bundled logs; returns whether every truth lies where it should."""
    from softid.interval_words import interval_in_words
    from softid.records import dump_json
    from softid.validation import self_check
    from softid_cli.tables import print_rows, print_text

    with announce_compilation(quiet=quiet), progress(quiet=quiet) as report:
        found = self_check(progress=report)
    if as_json:
        click.echo(dump_json(found), nl=False)
        return found.passed
    for group in dict.fromkeys(row.group for row in found.rows):
        print_rows(
            [(group, "left"), *((heading, "right") for heading in CHECKED), ("", "left")],
            [
                (
                    row.parameter,
                    f"{row.truth:.5g}",
                    f"{row.estimate:.5g}",
                    interval_in_words(row.ci95),
                    "" if row.distance is None else f"{row.distance:.2f}",
                    "inside" if row.inside else "OUTSIDE",
                )
                for row in found.rows
                if row.group == group
            ],
        )
        for fit in found.groups:
            if fit.name == group:
                click.echo(_together(fit))
        click.echo()
    print_text(_conclusion(found))
    return found.passed


def _together(fit: SelfCheckGroup) -> str:
    if fit.distance is None or fit.chance is None:
        return "together: without a covariance they cannot be judged"
    return (
        f"together: χ² = {fit.distance:.3g} for {fit.parameters} parameters; "
        f"chance puts {100 * fit.chance:.2g} % of fits farther off"
    )


def _conclusion(found: SelfCheck) -> str:
    """What the counts mean; a user must not take 1 in 20 outside for a fault."""
    count = len(found.rows)
    inside = sum(row.inside for row in found.rows)
    text = (
        f"off: distance of the truth in half-widths of the interval. {inside} of {count} truths "
        f"lie inside their 95 % interval; {round(0.95 * count)} are to be expected, for 1 in 20 "
        "lies outside by definition, and the parameters of one fit leave theirs together."
    )
    if found.chance is None:
        return text
    return f"{text} All fits together: chance puts {100 * found.chance:.2g} % of runs farther off."
