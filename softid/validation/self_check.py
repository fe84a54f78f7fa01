"""Refit of every bundled synthetic log, compared with the truth that made it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from softid.chi_square import chi_square_tail
from softid.identification import fit
from softid.models import MODELS, Model
from softid.readers import load
from softid.results import FitResult, ParameterEstimate
from softid.synthesis import KnownLog, bundled_datasets, read_manifest

FAR_OFF_TRUTH = 2.0
"""A truth this many half-widths of the 95 % interval away (about four standard errors) fails."""

LEAST_CHANCE = 1e-3
"""The check fails when a fit, or all together, lies farther from the truth than this share of
honest ones would, or when all together lie so near that the errors must be stated too large."""


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
class SelfCheckGroup:
    """The parameters of one fit, judged together, for they err together.

    Attributes
    ----------
    name
        The group of logs.
    parameters
        How many parameters were estimated.
    distance
        zᵀ C⁻¹ z, z being the distances of the truths in standard errors and C the correlation of
        the estimates; None without a correlation. Its mean over honest fits is ``parameters``.
    chance
        Share of honest fits that lie farther from their truth, by χ²; None without a distance.
    """

    name: str
    parameters: int
    distance: float | None
    chance: float | None


@dataclass(frozen=True)
class SelfCheck:
    """All rows and the verdict.

    Attributes
    ----------
    rows
        One per parameter that was estimated.
    groups
        One per fit.
    chance
        Share of honest runs of the whole check that lie farther from the truths; None where a
        group has no distance.
    passed
        No truth is further away than two half-widths, and the distance of every fit and of all
        together is one that honest intervals have.
    """

    rows: tuple[SelfCheckRow, ...]
    groups: tuple[SelfCheckGroup, ...]
    chance: float | None
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

    Examples
    --------
    >>> self_check().passed
    True
    """
    folder = bundled_datasets()
    groups: dict[str, list[KnownLog]] = {}
    for known in read_manifest(folder):
        if known.role == "fit":
            groups.setdefault(known.group, []).append(known)
    rows: list[SelfCheckRow] = []
    fits: list[SelfCheckGroup] = []
    for k, (group, members) in enumerate(groups.items()):
        if progress is not None:
            progress(f"refitting {group}", k / len(groups))
        for name, result, compared in _check_group(group, members):
            rows += compared
            fits.append(together(name, result, compared))
    return judged(rows, fits)


def judged(rows: Sequence[SelfCheckRow], groups: Sequence[SelfCheckGroup]) -> SelfCheck:
    """The verdict over all rows and fits; fits of different logs are independent, so χ² adds up.

    Parameters
    ----------
    rows, groups
        What was compared.
    """
    near = all(row.distance is not None and row.distance <= FAR_OFF_TRUTH for row in rows)
    distances = [group.distance for group in groups if group.distance is not None]
    chances = [group.chance for group in groups if group.chance is not None]
    chance = None
    if groups and len(distances) == len(groups):
        chance = chi_square_tail(sum(distances), sum(group.parameters for group in groups))
    honest = chance is not None and LEAST_CHANCE <= chance <= 1.0 - LEAST_CHANCE
    honest = honest and min(chances) >= LEAST_CHANCE
    return SelfCheck(tuple(rows), tuple(groups), chance, bool(rows) and near and honest)


def together(name: str, result: FitResult, rows: Sequence[SelfCheckRow]) -> SelfCheckGroup:
    """Distance of all truths of one fit from its estimates, in the metric of its covariance.

    Parameters
    ----------
    name
        The group of logs.
    result
        Their fit.
    rows
        Its parameters whose truth is known.

    Notes
    -----
    Parameters that make up for each other leave their intervals together.
    """
    offs = [_standard_errors(row.truth, result.parameter(row.parameter)) for row in rows]
    known = [off for off in offs if off is not None]
    if result.correlation is None or len(known) < len(rows) or not rows:
        return SelfCheckGroup(name, len(rows), None, None)
    at = [result.free.index(row.parameter) for row in rows]
    z = np.array(known)
    distance = float(z @ np.linalg.solve(result.correlation[np.ix_(at, at)], z))
    return SelfCheckGroup(name, len(rows), distance, chi_square_tail(distance, len(rows)))


def _standard_errors(truth: float, estimate: ParameterEstimate) -> float | None:
    """How many standard errors a truth lies above its estimate, on the scale of its interval."""
    if not estimate.stderr:
        return None
    if estimate.scale == "log":
        return float(np.log(truth / estimate.value)) * abs(estimate.value) / estimate.stderr
    return (truth - estimate.value) / estimate.stderr


def _check_group(
    group: str, members: Sequence[KnownLog]
) -> Iterator[tuple[str, FitResult, list[SelfCheckRow]]]:
    first = members[0]
    per_output = first.model == "polynomial"
    for output in first.outputs if per_output else first.outputs[:1]:
        logs = [load(known.file, outputs=(output,)) for known in members]
        result = fit(logs, model=_model(first, output))
        prefix = f"{output}." if per_output else ""
        name = f"{group} {output}" if per_output else group
        yield name, result, _compare(name, result, first, prefix)


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
                group=group,
                parameter=estimate.name,
                unit=estimate.unit,
                truth=truth,
                estimate=estimate.value,
                ci95=estimate.ci95,
                inside=inside,
                distance=distance,
            )
        )
    return rows


def _distance(truth: float, value: float, low: float, high: float, *, log: bool) -> float:
    if log:
        truth, value, low, high = (float(np.log(v)) for v in (truth, value, low, high))
    half = 0.5 * (high - low)
    return abs(truth - value) / half if half > 0 else float("inf")
