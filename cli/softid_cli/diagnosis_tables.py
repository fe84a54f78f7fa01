"""A diagnosis as text for a terminal of 80 columns."""

from __future__ import annotations

import math
from collections.abc import Sequence

from softid.diagnoses import Cause, Diagnosis
from softid.results import ParameterEstimate
from softid_cli.tables import interval, name_in_effect, print_issues, print_rows, print_text

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
    _print_causes("Description, not a cause:", diagnosis.descriptive, diagnosis)
    for alternative in diagnosis.alternatives:
        print_text("")
        print_text(f"Cannot be split: {', '.join(alternative.effects)}. {alternative.why}".rstrip())
    print_issues(diagnosis.issues)


def _print_causes(heading: str, causes: Sequence[Cause], diagnosis: Diagnosis) -> None:
    if not causes:
        return
    print_text("")
    if heading:
        print_text(heading)
    unit, factor = _display(diagnosis)
    print_rows(COLUMNS, [_row(cause, unit, factor) for cause in causes])


def _row(cause: Cause, unit: str, factor: float) -> tuple[str, ...]:
    before, after = (v * factor for v in (cause.holdout_rmse_before, cause.holdout_rmse_after))
    error = ""
    if math.isfinite(before) and math.isfinite(after):
        error = f"{before:.3g} → {after:.3g} {unit}".rstrip()
    if cause.gain_ci95 is not None:
        low, high = (100.0 * end for end in cause.gain_ci95)
        error += f"\ngain {low:z.0f} to {high:z.0f} %"
    if cause.holdout_rmse_without is not None:
        error += f"\nwithout it {cause.holdout_rmse_without * factor:.3g} {unit}".rstrip()
    values = "\n".join(_value(cause.key, p) for p in cause.parameters)
    return cause.key, values, f"{cause.delta_bic:.0f}", error


def _value(key: str, p: ParameterEstimate) -> str:
    ends = interval(p.ci95, lower=p.lower, upper=p.upper)
    unit = "" if p.unit == "1" else p.unit
    told = f"{name_in_effect(p.name, key)} = {p.value:.4g} {ends} {unit}"
    return " ".join(told.split()) + (", at bound" if p.at_bound else "")


def _display(diagnosis: Diagnosis) -> tuple[str, float]:
    """Unit of the first output as people know it, and the factor to it."""
    first = diagnosis.base.outputs[0]
    for row in diagnosis.base.statistics:
        if row.channel == first:
            return "" if row.display_unit == "1" else row.display_unit, row.display_factor
    return "", 1.0
