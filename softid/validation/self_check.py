"""Refit of every bundled synthetic log, compared with the truth that made it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from softid.identification import fit
from softid.models import MODELS, Model
from softid.readers import load
from softid.results import FitResult
from softid.synthesis import KnownLog, bundled_datasets, read_manifest

FAR = 2.0
"""A truth this many half-widths of the 95 % interval away (about four standard errors) fails."""

INSIDE_SHARE = 0.8
"""At least this share of the truths must lie inside their 95 % intervals."""


@dataclass(frozen=True)
class SelfCheckRow:
    """One parameter of one group of logs.

    Attributes
    ----------
    group, parameter, unit
        What was estimated.
    truth, estimate
        The value that made the logs and the value found.
    ci95
        95 % interval, or None.
    inside
        Whether the truth lies in it.
    distance
        Distance of the truth in half-widths of the interval; None without one.
    """

    group: str
    parameter: str
    unit: str
    truth: float
    estimate: float
    ci95: tuple[float, float] | None
    inside: bool
    distance: float | None


@dataclass(frozen=True)
class SelfCheck:
    """All rows and the verdict.

    Attributes
    ----------
    rows
        One per parameter that was estimated.
    passed
        No truth is further away than two half-widths and at least 80 % lie inside.
    """

    rows: tuple[SelfCheckRow, ...]
    passed: bool


def self_check(*, progress: Callable[[str, float], None] | None = None) -> SelfCheck:
    """Refit every group of bundled logs from its data alone and compare with its truth.

    Parameters
    ----------
    progress
        Called with a sentence and the fraction done.

    Returns
    -------
    SelfCheck

    Raises
    ------
    InputError
        The bundled logs are missing or damaged.
    """
    folder = bundled_datasets()
    groups: dict[str, list[KnownLog]] = {}
    for known in read_manifest(folder):
        if known.role == "fit":
            groups.setdefault(known.group, []).append(known)
    rows: list[SelfCheckRow] = []
    for k, (group, members) in enumerate(groups.items()):
        if progress is not None:
            progress(f"refitting {group}", k / len(groups))
        rows += _check_group(group, members)
    near = all(row.distance is not None and row.distance <= FAR for row in rows)
    inside = sum(row.inside for row in rows) >= INSIDE_SHARE * len(rows)
    return SelfCheck(tuple(rows), bool(rows) and near and inside)


def _check_group(group: str, members: Sequence[KnownLog]) -> list[SelfCheckRow]:
    first = members[0]
    per_output = first.model == "polynomial"
    rows = []
    for output in first.outputs if per_output else first.outputs[:1]:
        logs = [load(known.file, outputs=(output,)) for known in members]
        result = fit(logs, model=_model(first, output))
        prefix = f"{output}." if per_output else ""
        rows += _compare(f"{group} {output}" if per_output else group, result, first, prefix)
    return rows


def _model(known: KnownLog, output: str) -> Model | str:
    needs_geometry = known.model == "muscle" and output != "contraction"
    if needs_geometry and known.fixed_length_mm is not None and known.diameter_mm is not None:
        options = {"fixed_length_mm": known.fixed_length_mm, "diameter_mm": known.diameter_mm}
        return MODELS[known.model](**options)
    if known.truth.get("drift"):
        drifting: dict[str, Any] = {"drift": "linear"}
        model: Model = MODELS[known.model](**drifting)
        return model
    return known.model


def _compare(group: str, result: FitResult, known: KnownLog, prefix: str) -> list[SelfCheckRow]:
    rows = []
    for estimate in result.parameters:
        truth = known.truth.get(prefix + estimate.name)
        if truth is None or (estimate.fixed and estimate.value == truth):
            continue
        inside, distance = False, None
        if estimate.ci95 is not None:
            low, high = estimate.ci95
            inside = low <= truth <= high
            distance = _distance(truth, estimate.value, low, high, log=estimate.scale == "log")
        rows.append(
            SelfCheckRow(
                group,
                estimate.name,
                estimate.unit,
                truth,
                estimate.value,
                estimate.ci95,
                inside,
                distance,
            )
        )
    return rows


def _distance(truth: float, value: float, low: float, high: float, *, log: bool) -> float:
    if log:
        truth, value, low, high = (float(np.log(v)) for v in (truth, value, low, high))
    half = 0.5 * (high - low)
    return abs(truth - value) / half if half > 0 else float("inf")
