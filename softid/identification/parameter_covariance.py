"""How well an optimum is known: covariance under coloured residuals, noise, criteria."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from softid.effects import ExtendedModel, belongs_to
from softid.excitation import find_quantisation, run_starts
from softid.fitters.blocks import Block
from softid.fitters.normal_equations import SUMMED_ENTRIES, linearise, means_of
from softid.fitters.output_error import Optimum
from softid.fitters.pieces import Piece
from softid.fitters.problem import Problem
from softid.identification.unknown_names import unknown_names
from softid.results import NoiseModel
from softid.uncertainty import (
    AutoRegression,
    Covariance,
    FactoredRows,
    ResidualBlock,
    Rounding,
    fit_ar,
    known_better,
    log_likelihood,
    noise_model,
    sandwich_covariance,
    to_linear,
)

Array = npt.NDArray[np.float64]
IndexArray = npt.NDArray[np.intp]

Group = tuple[str, set[int]]
"""An output channel, and the logs that share its noise model."""

OWN_NOISE_SAMPLES = 100
"""A log with at least this many samples gets a noise model of its own; shorter ones share one.

Logs whose residuals differ in size, pooled into one model, had intervals that covered 84 % in place
of 97 %."""

UNBLURRED = 0.25
"""Share of the power of the residual from which its rounding, q²/12, counts as long as a reading
stays; noise of half a step blurs it."""

SOME = 1000
"""Readings, about, whose values are counted before all of them are looked at for a grid."""

UNEVEN = 2.0
"""Times as many values as fit into their range that a grid may show: where its step was changed or
a reading lies beside it."""

SILENT = 0.25
"""Noise at the end of a sensor's range, as a share of that elsewhere, below which it is clipped."""

ROUNDING_SHARE = 1e-6
"""Share of the largest derivative by a limit that is rounding."""

EXACTLY = 100.0
"""Weight of the one reading at a clipped limit of the sensor, in times that of one elsewhere: it
tells the limit so much better."""

LEAST_THERE = 0.5
"""Least share of the samples of the fullest mean that a mean must hold to count."""


@dataclass(frozen=True, eq=False)
class Errors:
    """Uncertainty of an optimum.

    Attributes
    ----------
    covariance
        Over `determined`, in internal coordinates; None when nothing was free.
    determined
        Unknowns away from bounds, as indices into the problem's vector.
    noise
        Noise model of every output channel.
    aic, bic
        From the likelihood of the residuals under their autoregressions; None without noise.
    """

    covariance: Covariance | None
    determined: tuple[int, ...]
    noise: tuple[NoiseModel, ...]
    aic: float | None
    bic: float | None


def errors_of(problem: Problem, optimum: Optimum) -> Errors:
    """Covariance, noise models and information criteria at an optimum.

    Where derivatives at every sample are too many to be kept, and a kernel sums them, the
    covariance is that of averages over a few samples, each of which weighs as much as they do. What
    a parameter does within so short a time is missed, and made up for as if the noise were white.
    Noise models and criteria are of the samples all the same.
    """
    stuck = optimum.at_bound.copy()
    stuck[len(problem.free) :] = False
    columns = np.flatnonzero(~stuck)
    groups = [(name, logs) for name in problem.outputs for logs in _noise_groups(problem, name)]
    n = problem.n_samples
    there = columns.size > 0 and n > columns.size
    covariance = _covariance_of_means(problem, optimum, groups, columns) if there else None
    rows = _rows_at(problem, optimum, derivatives=there and covariance is None)
    limits = _limits_of(problem)
    rows = [_without_silence(part, limits) for part in rows] if limits else rows
    shared = [_of(problem, rows, *group) for group in groups]
    residuals = [[r.residual for r in own] for own in shared]
    models = [fit_ar(own) for own in residuals]
    if there and covariance is None:
        parts = zip(groups, shared, strict=True)
        blocks = [_block_of(own, *group, columns, optimum) for group, own in parts]
        roundings = [_rounding_of(problem, own) for own in shared]
        names = _names_of(problem, columns)
        covariance = sandwich_covariance(blocks, names, noise=models, roundings=roundings)
    likelihood = sum(log_likelihood(ar, own) for ar, own in zip(models, residuals, strict=True))
    finite = bool(np.isfinite(likelihood))
    return Errors(
        covariance,
        tuple(int(k) for k in columns),
        tuple(_noise(problem, groups, residuals, models, name) for name in problem.outputs),
        2.0 * problem.size - 2.0 * likelihood if finite else None,
        float(np.log(n)) * problem.size - 2.0 * likelihood if finite else None,
    )


def _noise(
    problem: Problem,
    groups: Sequence[Group],
    residuals: Sequence[Sequence[Array]],
    models: Sequence[AutoRegression],
    name: str,
) -> NoiseModel:
    """What one channel leaves over, in all logs together."""
    own = [k for k, (channel, _) in enumerate(groups) if channel == name]
    return noise_model(
        name,
        [r for k in own for r in residuals[k]],
        fitted_parameters=problem.size,
        ar=models[own[0]] if len(own) == 1 else None,
    )


def _noise_groups(problem: Problem, channel: str) -> list[set[int]]:
    """Logs that share a noise model, as indices; every log that is long enough stands alone.

    Others that are too short together, too, share that of the shortest which is not: their own
    zeros and initial states could follow all of their samples.
    """
    counts = np.zeros(len(problem.logs), int)
    for segment, owner in zip(problem.segments, problem.owner, strict=True):
        counts[owner] += int(segment.used[channel].sum())
    alone = [{k} for k in range(counts.size) if counts[k] >= OWN_NOISE_SAMPLES]
    rest = {k for k in range(counts.size) if 0 < counts[k] < OWN_NOISE_SAMPLES}
    if not rest:
        return alone
    if alone and counts[[*rest]].sum() < OWN_NOISE_SAMPLES:
        shortest = min(alone, key=lambda group: min(counts[[*group]]))
        return [group | rest if group is shortest else group for group in alone]
    return [*alone, rest]


@dataclass(frozen=True, eq=False)
class _Rows:
    """Residuals and derivatives of one channel over all samples of one segment; NaN where unused.

    The derivatives are by all unknowns: an array of shape (n, U), or columns of shape (C, n), their
    products and their weights, of shapes (C, C) and (C, U). None where they are not asked for.
    """

    channel: str
    segment: int
    residual: Array
    jacobian: Array | tuple[Array, Array, Array] | None

    def by(self, columns: IndexArray) -> Array | FactoredRows:
        """Derivatives by some of the unknowns, with zeros where a sample is not used."""
        assert self.jacobian is not None
        if not isinstance(self.jacobian, tuple):
            whole = len(columns) == self.jacobian.shape[1]
            return self.jacobian if whole else self.jacobian[:, columns]
        values, products, weights = self.jacobian
        weights = weights[:, columns]
        return FactoredRows(values, weights, weights.T @ products @ weights)

    def weighted(self, factor: Array) -> _Rows:
        """Rows whose derivatives are multiplied, and without those that are by zero."""
        assert self.jacobian is not None
        residual = np.where(factor > 0.0, self.residual, np.nan)
        if not isinstance(self.jacobian, tuple):
            return replace(self, residual=residual, jacobian=factor[:, None] * self.jacobian)
        values, _, weights = self.jacobian
        values = factor * values
        return replace(self, residual=residual, jacobian=(values, values @ values.T, weights))


Part = TypeVar("Part", _Rows, Piece)


def _covariance_of_means(
    problem: Problem, optimum: Optimum, groups: Sequence[Group], columns: IndexArray
) -> Covariance | None:
    """That of averages over a few samples, which take no more memory than the logs do.

    None where the columns are there, or few enough at every sample, or no kernel sums them.
    """
    known, few = optimum.linearised, problem.n_samples * problem.size <= SUMMED_ENTRIES
    if few or (known is not None and known.kept):
        return None
    if known is not None and known.has_means:
        found = known.weighted(optimum.sigma)  # without a prior
    else:
        keep = means_of(problem)
        found = linearise(problem, optimum.unknowns, optimum.sigma, plans=None, keep=keep)
    if not found.affine:
        return None
    blocks = [
        _means_of(_of(problem, found.pieces, *group), *group, columns, optimum) for group in groups
    ]
    averaged = sandwich_covariance(blocks, _names_of(problem, columns))
    return known_better(averaged, found.matrix[np.ix_(columns, columns)])


def _names_of(problem: Problem, columns: IndexArray) -> list[str]:
    every = unknown_names(problem)
    return [every[k] for k in columns]


def _rows_at(problem: Problem, optimum: Optimum, *, derivatives: bool) -> list[_Rows]:
    """Residuals used spread over all samples of their segments, so that gaps stay gaps."""
    known = optimum.linearised
    if known is None or not (known.kept if derivatives else known.has_residuals):
        blocks = problem.blocks(optimum.unknowns, derivatives=derivatives)
        return [_spread(problem, block) for block in blocks]
    found = []
    for piece in known.pieces:
        segment = problem.segments[piece.segment]
        used = segment.samples_of(segment.used[piece.channel])
        residual = np.where(used, segment.samples_of(piece.residuals), np.nan)
        jacobian = None
        if derivatives:
            assert piece.columns is not None
            columns = segment.samples_of(piece.columns.T).T
            jacobian = columns, piece.gram, piece.by(np.arange(problem.size))
        found.append(_Rows(piece.channel, piece.segment, residual, jacobian))
    return found


def _limits_of(problem: Problem) -> list[int]:
    """Unknowns at which a sensor ends that may show no noise there."""
    model = problem.model
    if not isinstance(model, ExtendedModel):
        return []
    muting = [effect for effect in model.effects if effect.mutes]
    return [k for k, name in enumerate(problem.free) if any(belongs_to(e, name) for e in muting)]


def _without_silence(rows: _Rows, limits: Sequence[int]) -> _Rows:
    """Rows without what stands at an end of a sensor that clips its noise, but for one row there.

    Readings that show no noise say exactly where the sensor ends, and nothing of how noisy the
    others are: counted with them they made every interval too short.

    Parameters
    ----------
    rows
        Rows of one channel.
    limits
        Unknowns by which a reading is derived that stands at the end that they say.
    """
    if rows.jacobian is None:
        return rows
    used = np.isfinite(rows.residual)
    derivatives = rows.by(np.array(limits))
    by_limit = np.abs(derivatives @ np.eye(len(limits)))
    stands = (by_limit > ROUNDING_SHARE * by_limit.max(axis=0, initial=0.0)) & used[:, None]
    others = rows.residual[used & ~stands.any(axis=1)]
    heard, factor = used.copy(), np.ones(used.size)
    for at in (np.flatnonzero(there) for there in stands.T):
        if not at.size or not others.size:
            continue
        if np.mean(rows.residual[at] ** 2) < SILENT**2 * np.mean(others**2):
            heard[at[1:]], factor[at[0]] = False, EXACTLY
    if heard.sum() == used.sum():
        return rows
    return rows.weighted(np.where(heard, factor, 0.0))


def _spread(problem: Problem, block: Block) -> _Rows:
    segment = problem.segments[block.segment]
    used = segment.samples_of(segment.used[block.channel])
    residual = np.full(used.size, np.nan)
    residual[used] = block.residual
    jacobian = None
    if block.jacobian is not None:
        jacobian = np.zeros((used.size, problem.size))
        jacobian[used] = block.jacobian
    return _Rows(block.channel, block.segment, residual, jacobian)


def _of(problem: Problem, parts: Iterable[Part], channel: str, logs: set[int]) -> list[Part]:
    """What belongs to one channel of some logs."""
    return [p for p in parts if p.channel == channel and problem.owner[p.segment] in logs]


def _block_of(
    rows: Sequence[_Rows], channel: str, logs: set[int], columns: IndexArray, optimum: Optimum
) -> ResidualBlock:
    """What shares a noise model, by the unknowns that are not stuck."""
    weight = 1.0 / optimum.sigma[channel]
    jacobians, residuals = tuple(r.by(columns) for r in rows), tuple(r.residual for r in rows)
    return ResidualBlock(channel, jacobians, residuals, weight, min(logs))


def _rounding_of(problem: Problem, rows: Sequence[_Rows]) -> Rounding | None:
    """How the readings of what shares a noise model are rounded, where noise hardly blurs that."""
    readings = [_readings_of(problem, part) for part in rows]
    known = np.concatenate([values[np.isfinite(values)] for values in readings])
    residual = np.concatenate([part.residual for part in rows])
    if not known.size:
        return None
    least = float(np.sqrt(12.0 * UNBLURRED * np.nanmean(residual**2)))
    grid = find_quantisation(known) if _may_be_as_coarse(known, least) else None
    if grid is None or grid.step < least:
        return None
    return Rounding(grid.step, tuple(run_starts(values) for values in readings))


def _may_be_as_coarse(readings: Array, step: float) -> bool:
    """Whether readings show so few values that they may lie on a grid of this step.

    Some of them soon tell: no two values of a grid are closer than its step.
    """
    some = np.unique(readings[:: max(1, readings.size // SOME)])
    return bool((some.size - 1) * step <= UNEVEN * (some[-1] - some[0]))


def _readings_of(problem: Problem, rows: _Rows) -> Array:
    segment = problem.segments[rows.segment]
    readings: Array = segment.samples_of(segment.outputs[rows.channel])
    return np.where(np.isfinite(rows.residual), readings, np.nan)


def _means_of(
    pieces: Sequence[Piece], channel: str, logs: set[int], columns: IndexArray, optimum: Optimum
) -> ResidualBlock:
    """The same of means over stretches, each with the weight of its samples."""
    rows, residuals, counts = zip(*(_means(piece, columns) for piece in pieces), strict=True)
    used = np.concatenate(counts)
    weight = float(np.sqrt(used[used > 0.0].mean())) / optimum.sigma[channel]
    return ResidualBlock(channel, rows, residuals, weight, min(logs))


def _means(piece: Piece, columns: IndexArray) -> tuple[FactoredRows, Array, Array]:
    """Means of derivatives and residual, NaN where many samples are missing, and sample counts."""
    values, counts = piece.columns, piece.counts
    assert values is not None
    assert counts is not None
    residual = piece.residual @ values
    missing = counts < max(1.0, LEAST_THERE * counts.max(initial=0.0))
    if missing.any():
        residual[missing] = np.nan
        values = np.where(missing, 0.0, values)
    weights = piece.by(columns)
    return (
        FactoredRows(values, weights, weights.T @ (values @ values.T) @ weights),
        residual,
        counts,
    )


def free_covariance(
    problem: Problem, optimum: Optimum, errors: Errors
) -> tuple[tuple[str, ...], Array | None, Array | None]:
    """Names, covariance and correlation of the free parameters that have standard errors."""
    if errors.covariance is None:
        return (), None, None
    keep = [
        r
        for r, k in enumerate(errors.determined)
        if k < len(problem.free) and errors.covariance.sd[r] is not None
    ]
    names = tuple(errors.covariance.names[r] for r in keep)
    if not keep:
        return (), None, None
    theta = dict(zip(problem.parameters.names, problem.theta(optimum.unknowns), strict=True))
    every = errors.covariance.names
    values = [theta.get(n, 1.0) for n in every]
    scales = [problem.parameters[n].scale if n in theta else "linear" for n in every]
    linear = to_linear(errors.covariance, values, scales)[np.ix_(keep, keep)]
    sd = np.sqrt(np.diag(linear))
    return names, linear, linear / np.outer(sd, sd)
