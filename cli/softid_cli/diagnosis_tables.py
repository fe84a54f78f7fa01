"""A diagnosis as text for a terminal of 80 columns."""

from __future__ import annotations

import math
from collections.abc import Sequence

from softid.diagnosis_results import Cause, Diagnosis, cause_before
from softid.interval_words import value_in_words
from softid.results import ParameterEstimate
from softid_cli.tables import name_in_effect, print_issues, print_rows, print_text

COLUMNS = [
    ("cause", "left"),
    ("parameter", "left"),
    ("ΔBIC", "right"),
    ("held-out error", "left"),
]


def print_diagnosis(diagnosis: Diagnosis) -> None:
    """Print the paragraph, the causes, what cannot be split, and issues."""
    print_text(diagnosis.summary)
    _print_causes("", diagnosis.causes, diagnosis)
    _print_causes(_of_descriptions(diagnosis), diagnosis.descriptive, diagnosis)
    for alternative in diagnosis.alternatives:
        print_text("")
        print_text(f"Cannot be split: {_listed(alternative.keys)}. {alternative.why}".rstrip())
    print_issues(diagnosis.issues)


def _listed(keys: Sequence[str]) -> str:
    """Keys of effects, and what laws are that `softid effects` does not list."""
    from softid.diagnosis.verdict.unlisted_names import UNLISTED

    if not set(keys) & set(UNLISTED):
        return ", ".join(keys)
    return "; ".join(UNLISTED.get(key, key) for key in keys)


def _of_descriptions(diagnosis: Diagnosis) -> str:
    """The heading of descriptions; a law or an event that is told stands before them."""
    from softid.diagnosis.report.remarks import WHAT_IT_IS

    if any(issue.code in WHAT_IT_IS for issue in diagnosis.issues):
        return "A description, which explains less than what is told above:"
    return "Description, not a cause:"


def _print_causes(heading: str, causes: Sequence[Cause], diagnosis: Diagnosis) -> None:
    if not causes:
        return
    print_text("")
    if heading:
        print_text(heading)
    unit, factor = _display(diagnosis)
    chain = (*diagnosis.causes, *diagnosis.descriptive)
    rows = []
    for above, cause in zip((None, *causes), causes, strict=False):
        earlier = cause_before(cause, chain)
        rows.append(_row(cause, unit, factor, earlier if earlier is not above else None))
    print_rows(COLUMNS, rows)


def _row(cause: Cause, unit: str, factor: float, earlier: Cause | None) -> tuple[str, ...]:
    """One cause, and the one of the other table that it was added to."""
    from softid.diagnosis.report.phrases import percent_range

    before, after = cause.holdout_rmse_before, cause.holdout_rmse_after
    error = ""
    if math.isfinite(before) or math.isfinite(after):
        error = f"{_error(before, factor)} → {_error(after, factor, unit)}"
        error += f"\nafter {earlier.key}" if earlier else ""
    if cause.gain_ci95 is not None:
        error += f"\ngain {percent_range(cause.gain_ci95)}"
    if cause.holdout_rmse_without is not None:
        error += f"\nwithout it {_error(cause.holdout_rmse_without, factor, unit)}"
    values = "\n".join(_value(cause.key, p) for p in cause.parameters)
    return cause.key, values, f"{cause.delta_bic:.0f}", error


def _error(value: float, factor: float, unit: str = "") -> str:
    """An error in its unit; a model whose response runs away has none."""
    return f"{value * factor:.3g} {unit}".rstrip() if math.isfinite(value) else "no response"


def _value(key: str, p: ParameterEstimate) -> str:
    bound = ", at bound" if p.at_bound else ""
    return f"{name_in_effect(p.name, key)} = {value_in_words(p)}{bound}"


def _display(diagnosis: Diagnosis) -> tuple[str, float]:
    """Unit of the first output as people know it, and the factor to it."""
    first = diagnosis.base.outputs[0]
    for row in diagnosis.base.statistics:
        if row.channel == first:
            return "" if row.display_unit == "1" else row.display_unit, row.display_factor
    return "", 1.0
