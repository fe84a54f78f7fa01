"""Results as text for a terminal of 80 columns."""

from __future__ import annotations

import math
import os
import re
import shutil
import sys
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from softid.errors import Issue
from softid.interval_words import interval_in_words
from softid.results import (
    FitResult,
    FitStatistics,
    ModelSpec,
    ParameterEstimate,
    Validation,
)
from softid.sentences import listed

if TYPE_CHECKING:
    from rich.table import Table

WIDTH = 80
_MOST_DIGITS = 9

_DROWNED = 0.1
"""Share of its error below which a value would be rounded away to the error's digits."""

_MOST_PLACES = 4
"""Places of issues alike that are named on the terminal; the files have all of them."""

_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")

_OPTION_UNITS = {"_n_per_mm": "N/mm", "_kg_m3": "kg/m³", "_mm": "mm", "_pa": "Pa", "_m": "m"}
"""Ending of an option's name → its unit; the longest that fits comes first."""


def print_fit(result: FitResult) -> None:
    """Print parameters with errors, scores per log, the choice of the model, and issues."""
    _print(f"Model: {model_text(result.model)}, {_roles(result.input, result.outputs)}")
    if result.choice:
        _print(f"Why this model: {result.choice.removeprefix(result.model.name + ': ')}")
    own, by_effect = by_effects(result.parameters, result.model.effects)
    _print("", _parameter_table(own), "")
    for key, members in by_effect.items():
        _print(f"Effect {key}:", "", _parameter_table(members, key), "")
    told = {issue.parameter for issue in result.issues}
    for estimate in result.parameters:
        if estimate.reason and estimate.name not in told:
            _print(f"{estimate.name} is {estimate.verdict}: {estimate.reason}")
    for name, (value, unit) in result.derived.items():
        _print(f"{name.replace('_', ' ')}: {_derived_text(result, name, value, _unit(unit))}")
    if result.derived:
        _print("")
    _print(_score_table(result.statistics))
    print_issues(result.issues)


def _derived_text(result: FitResult, name: str, value: float, unit: str) -> str:
    """A computed quantity with its error; one that may as well be zero is no number to show."""
    if name not in result.derived_stderr:
        return f"{value:.4g} {unit}"
    error = result.derived_stderr[name]
    if error is None or not error < abs(value):
        return "not determined by these logs"
    return f"{with_error(value, error)} {unit}"


def print_validation(validation: Validation) -> None:
    """Print scores per log, the verdict against the bar, and issues."""
    roles = _roles(validation.input, validation.outputs)
    _print(f"Model: {model_text(validation.model)}, {roles}", "")
    _print(_score_table(validation.statistics))
    if validation.threshold_percent is not None:
        verdict = "Every fit reaches" if validation.passed else "Not every fit reaches"
        end = "."
        if not any(math.isfinite(row.fit_percent) for row in validation.statistics):
            verdict, end = "No log has a fit for", " to judge."
        _print("", f"{verdict} the bar of {validation.threshold_percent:g} %{end}")
    print_issues(validation.issues)


def print_issues(issues: Sequence[Issue]) -> None:
    """Print each issue with its remedy below."""
    if issues:
        _print("")
    for line in issue_lines(issues, terminal_width()):
        click.echo(line)


def issue_lines(issues: Iterable[Issue], width: int) -> list[str]:
    """Each issue folded to a width, below it of what else it is true, and its remedy.

    What differs from another issue in the log, and in one number at most, is not said again.
    """
    lines = []
    for first, *others in _alike(issues):
        lines.append(folded(f"{first.severity}: {first.message}", width, indent="  "))
        if others:
            lines.append(folded(f"  likewise {_places(first, others)}", width))
        if first.remedy:
            lines.append(folded(f"  → {first.remedy}", width))
    return lines


def _alike(issues: Iterable[Issue]) -> list[list[Issue]]:
    """Issues that are told together, in the order of the first of each."""
    groups: list[list[Issue]] = []
    of_kind: dict[object, list[list[Issue]]] = {}
    for issue in dict.fromkeys(issues):
        same = of_kind.setdefault(_kind(issue), [])
        for group in same:
            if len(_changed(group[0], issue)) <= 1:
                group.append(issue)
                break
        else:
            same.append([issue])
            groups.append(same[-1])
    return groups


def _kind(issue: Issue) -> object:
    """The same for issues that differ in their place, which a message begins with, and numbers."""
    _place, colon, said = issue.message.partition(": ")
    if issue.parameter is not None or not colon:
        return issue
    return issue.code, issue.severity, issue.remedy, _NUMBER.sub("#", said)


def _changed(first: Issue, other: Issue) -> list[int]:
    """Which of the numbers of one kind of issue are others."""
    told = [_NUMBER.findall(issue.message.partition(": ")[2]) for issue in (first, other)]
    return [k for k, (one, another) in enumerate(zip(*told, strict=True)) if one != another]


def _places(first: Issue, others: Sequence[Issue]) -> str:
    """Where else, with the number that is another one there; of many places the first ones."""
    places = []
    for issue in others:
        place, _, said = issue.message.partition(": ")
        numbers = [_NUMBER.findall(said)[k] for k in _changed(first, issue)]
        places.append(" ".join((place.replace(", ", " "), *(f"({n})" for n in numbers))))
    more = len(places) - _MOST_PLACES
    if more > 1:
        places[_MOST_PLACES:] = [f"{more} more"]
    return listed(dict.fromkeys(places))


def print_rows(columns: Sequence[tuple[str, str]], rows: Iterable[Sequence[str]]) -> None:
    """Print a table; a column is a heading and ``"left"`` or ``"right"``."""
    _print(table_of(columns, rows))


def print_files(folder: Path, names: Sequence[str]) -> None:
    """Print where results were written, file names folded to the width."""
    click.echo(f"\nWritten to {folder}{os.sep}:")
    click.echo(folded("  " + "  ".join(names), terminal_width(), indent="  "))


def print_text(text: str) -> None:
    """Print text wrapped to the width of the terminal."""
    _print(text)


def model_text(spec: ModelSpec) -> str:
    """Model, the options that were set, and its effects, for people."""
    options = [
        _option(name, value)
        for name, value in spec.options.items()
        if value not in (None, False, "") and not name.endswith("_unit")
    ]
    base = f"{spec.name} ({', '.join(options)})" if options else spec.name
    return " + ".join((base, *spec.effects))


def _option(name: str, value: str | float | bool) -> str:
    """An option that was set; a switch is by its name alone."""
    if isinstance(value, bool):
        return name.replace("_", " ")
    if isinstance(value, float | int):
        return _sized_option(name, value)
    return f"{_worded(value)} {name.replace('_', ' ')}"


def _sized_option(name: str, value: float) -> str:
    """Name and value of an option, the unit behind the value."""
    stem, unit = _stem_and_unit(name)
    return f"{stem} {value:g} {unit}".rstrip()


def _worded(value: str) -> str:
    """The value of an option that is a text; a list of names without their units."""
    if value == "none":
        return "no"
    names = [name.strip() for name in value.split(",")]
    stems = [_stem_and_unit(name)[0] if "_" in name else name for name in names]
    return listed(stems)


def _stem_and_unit(name: str) -> tuple[str, str]:
    for ending, unit in _OPTION_UNITS.items():
        if name.endswith(ending):
            return name.removesuffix(ending).replace("_", " "), unit
    return name.replace("_", " "), ""


def with_error(value: float, stderr: float | None) -> str:
    """Value and standard error to the error's second significant digit.

    A value that the error drowns keeps two digits of its own: it is what the fit stands at.

    Examples
    --------
    >>> with_error(1.23456, 0.0123), with_error(1.2e-7, 3.4e-9), with_error(5.0, None)
    ('1.235 ± 0.012', '(1.200 ± 0.034)e-07', '5')
    >>> with_error(0.2901, 52.1)
    '0.29 ± 52'
    """
    if stderr is None or not math.isfinite(stderr) or stderr <= 0:
        return f"{value:.6g}"
    if abs(value) < _DROWNED * stderr:
        return f"{value:.2g} ± {stderr:.2g}"
    largest = max(abs(value), stderr)
    exponent = math.floor(math.log10(largest))
    scaled = not -3 <= exponent < 5
    scale = 10.0**exponent if scaled else 1.0
    decimals = 1 - math.floor(math.log10(stderr / scale))
    decimals = min(max(decimals, 0), _MOST_DIGITS)
    text = f"{value / scale:.{decimals}f} ± {stderr / scale:.{decimals}f}"
    return f"({text})e{exponent:+03d}" if scaled else text


def _parameter_table(parameters: Sequence[ParameterEstimate], key: str = "") -> Table:
    table = table_of(
        [
            ("parameter", "left"),
            ("value ± std. error", "right"),
            ("95 % interval", "right"),
            ("unit", "left"),
            ("verdict", "left"),
        ]
    )
    for p in parameters:
        verdict = f"= {p.tie}" if p.tie else p.verdict + (", at bound" if p.at_bound else "")
        table.add_row(
            name_in_effect(p.name, key),
            with_error(p.value, p.stderr),
            interval_in_words(p.ci95, lower=p.lower, upper=p.upper, value=p.value),
            _unit(p.unit),
            verdict,
        )
    return table


def by_effects(
    parameters: Sequence[ParameterEstimate], keys: Sequence[str]
) -> tuple[list[ParameterEstimate], dict[str, list[ParameterEstimate]]]:
    """The model's own parameters, and those of each effect under its key."""
    groups: dict[str, list[ParameterEstimate]] = {key: [] for key in keys}
    own = []
    for p in parameters:
        owners = [key for key in keys if name_in_effect(p.name, key) != p.name]
        if owners:
            groups[max(owners, key=len)].append(p)
        else:
            own.append(p)
    return own, groups


def name_in_effect(name: str, key: str) -> str:
    """The name of a parameter within its effect; the whole name if it is not the effect's.

    Examples
    --------
    >>> name_in_effect("coulomb_friction_Fc", "coulomb_friction.stribeck"), name_in_effect("M", "x")
    ('Fc', 'M')
    """
    return name.removeprefix(key.split(".")[0] + "_") if key else name


def _score_table(statistics: Sequence[FitStatistics]) -> Table:
    table = table_of(
        [
            ("log", "left"),
            ("channel", "left"),
            ("samples", "right"),
            ("rmse", "right"),
            ("unit", "left"),
            ("fit %", "right"),
            ("", "left"),
        ]
    )
    for s in statistics:
        table.add_row(
            s.log,
            s.channel,
            str(s.n),
            f"{s.rmse * s.display_factor:.4g}",
            _unit(s.display_unit),
            f"{s.fit_percent:z.1f}" if math.isfinite(s.fit_percent) else "–",
            "in sample" if s.in_sample else "held out",
        )
    return table


def table_of(columns: Sequence[tuple[str, str]], rows: Iterable[Sequence[str]] = ()) -> Table:
    """A table; a column is a heading and ``"left"`` or ``"right"``."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    for heading, side in columns:
        # On a narrow terminal words are broken, never cut.
        table.add_column(
            heading,
            justify="right" if side == "right" else "left",
            no_wrap=side == "right",
            overflow="fold",
        )
    for row in rows:
        table.add_row(*row)
    return table


def _print(*blocks: str | Table) -> None:
    from rich.console import Console

    width = None if sys.stdout.isatty() else WIDTH
    console = Console(file=sys.stdout, width=width, highlight=False, markup=False, emoji=False)
    ample = console.options.update(max_width=10 * console.width)
    for block in blocks:
        if not isinstance(block, str):
            wanted = console.measure(block, options=ample).maximum
            if wanted > console.width:
                block.padding = 0  # before any word is broken
        with console.capture() as text:
            console.print(block)
        click.echo("\n".join(line.rstrip() for line in text.get().split("\n")), nl=False)


def terminal_width() -> int:
    """Columns of the terminal, or `WIDTH` where results go elsewhere."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else WIDTH


def folded(text: str, width: int, *, indent: str = "    ") -> str:
    """Text folded to a width, all lines but the first behind an indent."""
    return textwrap.fill(
        text, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )


def _roles(input_name: str, outputs: Sequence[str]) -> str:
    return f"{input_name} → {', '.join(outputs)}"


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit
