"""A least-squares estimate as a linear function of the noise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.uncertainty.factored_rows import FactoredRows

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
Rows = Array | FactoredRows

RANK_TOLERANCE = 1e-8
"""Singular values of the column-scaled Jacobian below this share of the largest count as zero:
exact sensitivities carry errors of some 1e-12, and a direction that weak is unknown anyway."""

SAFE_FOR_PRODUCTS = 1e-3
"""Smallest singular value as a share of the largest down to which the products JᵀJ tell it to 1e-9;
their rounding is that of the squares. Below, J itself is decomposed."""

MIN_LOADING = 0.01
"""A parameter takes part in an undetermined direction when its share of the unit vector, in
column-scaled coordinates, is at least this."""


@dataclass(frozen=True, eq=False)
class ResidualBlock:
    """Residuals that share one noise model, with their derivatives.

    Give one block per log and output channel where the logs can afford it (some 100 samples
    each): residuals of real logs differ in size, and a pooled model takes the average for all of
    them, so that the intervals of a shared parameter cover 84 % in place of 97 %
    (tests/benchmarks/coverage_of_intervals.py).

    Attributes
    ----------
    channel
        Output channel, or any name for messages: ``"step_1 angle"``.
    jacobians
        ∂(simulated)/∂(internal coordinate), one per segment, shape (n_s, K) with the same K in all
        blocks; the internal coordinate of a parameter on a logarithmic scale is its logarithm. As
        arrays, or as the factors that make them up.
    residuals
        Measured minus simulated, one per segment, shape (n_s,); NaN where a sample is not used.
    weight
        Weight of this channel in the fit, 1/σ: the cost is Σ (weight · residual)².
    recording
        Number of the recording: channels with the same one have the same segments and samples and
        may err together. None for a block that errs alone.

    Raises
    ------
    InputError
        Shapes do not match, no sample is used, or a derivative in use is not finite.
    """

    channel: str
    jacobians: tuple[Rows, ...]
    residuals: tuple[Array, ...]
    weight: float = 1.0
    recording: int | None = None

    def __post_init__(self) -> None:
        jacobian_shapes = [j.shape for j in self.jacobians]
        wanted = [(r.size, self.width) for r in self.residuals]
        if jacobian_shapes != wanted:
            raise InputError(
                "Jacobian and residual do not match",
                where=self.channel,
                value=(jacobian_shapes, wanted),
                remedy="give one row per sample and one column per parameter",
            )
        if self.n == 0:
            raise InputError("no residual is used", where=self.channel, remedy="mask fewer samples")
        if not all(_is_finite(j, u) for j, u in zip(self.jacobians, self.used, strict=True)):
            raise InputError(
                "a derivative is not finite",
                where=self.channel,
                remedy="mask the sample, or check the model at the optimum",
            )

    @property
    def width(self) -> int:
        """Number of parameters K."""
        return int(self.jacobians[0].shape[1]) if self.jacobians else 0

    @cached_property
    def used(self) -> tuple[BoolArray, ...]:
        """Which samples of each segment are used."""
        return tuple(np.isfinite(r) for r in self.residuals)

    @cached_property
    def factors(self) -> tuple[Rows, ...]:
        """The derivatives with zeros where a sample is not used, as they were given."""
        pairs = zip(self.jacobians, self.used, strict=True)
        return tuple(
            j if isinstance(j, FactoredRows) or u.all() else np.where(u[:, None], j, 0.0)
            for j, u in pairs
        )

    @property
    def rows(self) -> tuple[Array, ...]:
        """The same as arrays."""
        return tuple(_dense(rows) for rows in self.factors)

    @property
    def n(self) -> int:
        """Samples used."""
        return int(sum(u.sum() for u in self.used))

    @property
    def stacked(self) -> Array:
        """Rows in use, shape (n, K), without the weight."""
        pairs = zip(self.jacobians, self.used, strict=True)
        parts = [_dense(j) if u.all() else _dense(j)[u] for j, u in pairs]
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    @cached_property
    def gram(self) -> Array:
        """JᵀJ over the samples in use, without the weight, shape (K, K)."""
        own = [r.gram if isinstance(r, FactoredRows) else r.T @ r for r in self.factors]
        return np.asarray(np.sum(own, axis=0), np.float64)

    @property
    def cross(self) -> Array:
        """Jᵀr over the samples in use, without the weight, shape (K,)."""
        total = np.zeros(self.width)
        for rows, residual, used in zip(self.factors, self.residuals, self.used, strict=True):
            r = residual if used.all() else np.where(used, residual, 0.0)
            total += rows.along(r) if isinstance(rows, FactoredRows) else r @ rows
        return total

    @cached_property
    def decomposed(self) -> tuple[Array, Array, Array]:
        """Column lengths of `stacked`, its singular values and right vectors."""
        return _scaled_svd(self.gram, lambda: self.stacked)

    def averaged(self, length: int) -> ResidualBlock:
        """Means over stretches of ``length`` samples; see `Stretches.averaged`."""
        return self if length == 1 else Stretches.of(self).coarser(length).averaged(self)


def _dense(rows: Rows) -> Array:
    return rows.dense if isinstance(rows, FactoredRows) else rows


def _is_finite(rows: Rows, used: BoolArray) -> bool:
    """A sum is finite only where all of its terms are, and takes no second array."""
    if isinstance(rows, FactoredRows):
        return bool(np.isfinite(rows.gram).all())
    return bool(np.isfinite(rows.sum()) or np.isfinite(rows[used]).all())


@dataclass(frozen=True, eq=False)
class Stretches:
    """Sums of a block over consecutive stretches of samples.

    Attributes
    ----------
    rows, residuals, counts
        Sums of the derivatives and residuals in use, and how many they are, one per segment, of
        shapes (m_s, K), (m_s,) and (m_s,).
    """

    rows: tuple[Rows, ...]
    residuals: tuple[Array, ...]
    counts: tuple[Array, ...]

    @classmethod
    def of(cls, block: ResidualBlock) -> Stretches:
        """Every sample as a stretch of its own."""
        pairs = zip(block.residuals, block.used, strict=True)
        residuals = tuple(r if u.all() else np.where(u, r, 0.0) for r, u in pairs)
        return cls(block.factors, residuals, tuple(u.astype(np.float64) for u in block.used))

    def coarser(self, step: int) -> Stretches:
        """So many stretches taken together; the last may be short."""
        rows = tuple(
            r.sums(step) if isinstance(r, FactoredRows) else stretch_sums(r, step)
            for r in self.rows
        )
        residuals, counts = (
            tuple(stretch_sums(values, step) for values in parts)
            for parts in (self.residuals, self.counts)
        )
        return Stretches(rows, residuals, counts)

    def averaged(self, block: ResidualBlock) -> ResidualBlock:
        """Means over the stretches of a block, unused where many samples are missing.

        Many is more than half of those that the fullest stretch of the segment has: a channel with
        a slower clock than the log is missing most samples everywhere, and is used all the same.
        """
        jacobians, residuals = [], []
        for rows, sums, counts in zip(self.rows, self.residuals, self.counts, strict=True):
            divisor = np.maximum(counts, 1.0)
            enough = counts >= max(1.0, counts.max(initial=0.0) / 2.0)
            jacobians.append(_dense(rows) / divisor[:, None])
            residuals.append(np.where(enough, sums / divisor, np.nan))
        return ResidualBlock(
            block.channel, tuple(jacobians), tuple(residuals), block.weight, block.recording
        )


def stretch_sums(values: Array, length: int) -> Array:
    """Sums over consecutive stretches of ``length`` along the first axis; the last may be short."""
    if length == 1:
        return values
    count = values.shape[0] // length
    stretches = values[: count * length].reshape(count, length, *values.shape[1:])
    sums: Array = np.einsum("sl...->s...", stretches)  # faster than np.add.reduceat
    if count * length == values.shape[0]:
        return sums
    return np.concatenate((sums, values[count * length :].sum(axis=0, keepdims=True)))


@dataclass(frozen=True, eq=False)
class Linearisation:
    """Singular value decomposition of the weighted Jacobian of a fit.

    Attributes
    ----------
    inverse
        H⁻¹ with H = Σ w² JᵀJ, over the directions that are determined, shape (K, K).
    singular_values
        Of the Jacobian with columns scaled to unit length, largest first, shape (K,).
    undetermined
        Directions that do not change the response: for each the positions of the parameters in it.
    """

    inverse: Array
    singular_values: Array
    undetermined: tuple[tuple[int, ...], ...]

    @property
    def condition_number(self) -> float:
        """Largest over smallest singular value; infinite when a direction is undetermined."""
        smallest = float(self.singular_values[-1])
        return float(self.singular_values[0]) / smallest if smallest > 0.0 else float("inf")

    @property
    def determined(self) -> BoolArray:
        """Which parameters take part in no undetermined direction, shape (K,)."""
        out = np.ones(self.inverse.shape[0], bool)
        out[[k for direction in self.undetermined for k in direction]] = False
        return out


def linearise(blocks: Sequence[ResidualBlock]) -> Linearisation:
    """Decompose the Jacobian of a fit and find what it cannot see.

    Parameters
    ----------
    blocks
        All residuals of the fit.

    Returns
    -------
    Linearisation

    Examples
    --------
    >>> x = np.arange(4.0)
    >>> block = ResidualBlock("angle", (np.column_stack((x, 2 * x, x**2)),), (np.ones(4),))
    >>> linearise([block]).undetermined
    ((0, 1),)
    """
    if len(blocks) == 1:
        norm, singular, right = blocks[0].decomposed
        norm = norm * blocks[0].weight
    else:
        gram = np.sum([block.weight**2 * block.gram for block in blocks], axis=0)
        norm, singular, right = _scaled_svd(
            gram, lambda: np.concatenate([block.weight * block.stacked for block in blocks])
        )
    kept = singular > RANK_TOLERANCE * singular[0]
    inverse = (right[kept].T / singular[kept] ** 2) @ right[kept] / np.outer(norm, norm)
    singular = np.where(kept, singular, 0.0)
    null = tuple(tuple(np.flatnonzero(np.abs(v) >= MIN_LOADING).tolist()) for v in right[~kept])
    return Linearisation(inverse, singular, null)


def _scaled_svd(gram: Array, stacked: Callable[[], Array]) -> tuple[Array, Array, Array]:
    """Column lengths (1 for a zero column), singular values (K,) and right vectors (K, K).

    From the products JᵀJ where those of the columns that are not zero are clear enough, else from
    J, which is then asked for.
    """
    norm = np.sqrt(np.maximum(np.diag(gram), 0.0))
    felt = norm > 0.0
    count = int(felt.sum())
    norm = np.where(felt, norm, 1.0)
    scaled = gram / np.outer(norm, norm)
    singular = np.zeros(norm.size)
    if count and np.isfinite(scaled).all():
        values, vectors = np.linalg.eigh(scaled[np.ix_(felt, felt)])
        if values[0] > SAFE_FOR_PRODUCTS**2 * values[-1]:
            singular[:count] = np.sqrt(values[::-1])
            right = np.zeros(gram.shape)
            right[:count, felt] = vectors.T[::-1]
            right[count:, ~felt] = np.eye(norm.size - count)
            return norm, singular, right
    rows = stacked()
    triangle = np.linalg.qr(rows / norm, mode="r")
    _, found, right = np.linalg.svd(triangle, full_matrices=True)
    singular[: found.size] = found
    return norm, singular, right


def is_clear(block: ResidualBlock) -> bool:
    """Whether the products of a block's derivatives tell all that the derivatives do.

    The zero of another log, which its columns do not hold, says nothing against it.
    """
    singular = block.decomposed[1]
    felt = int(np.count_nonzero(np.diag(block.gram) > 0.0))
    return felt > 0 and bool(singular[felt - 1] > SAFE_FOR_PRODUCTS * singular[0])


def projection(block: ResidualBlock) -> Array:
    """What makes the derivatives of a block orthonormal where they are independent, (K, m)."""
    norm, singular, right = block.decomposed
    kept = singular > RANK_TOLERANCE * max(singular[0], np.finfo(float).tiny)
    project: Array = right[kept].T / singular[kept] / norm[:, None]
    return project


def reachable(block: ResidualBlock) -> list[Array]:
    """Orthonormal basis, per segment, of what the parameters can do to one block's response."""
    project = projection(block)
    return [rows @ project for rows in block.rows]
