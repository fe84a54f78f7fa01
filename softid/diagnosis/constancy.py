"""Whether the size of a cause is the same throughout: its law against others that look like it.

A law that is not the right one takes away most of a misfit where its size may settle between what
the log asks for here and there. So the size is let vary, smoothly with the time, the position, the
speed or the input, and the score test of that, a Lagrange multiplier, tells whether the residual
asks for it: nothing is refitted. The idea is that of Lin and Teräsvirta (J. Econometrics 62, 1994).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from softid.chi_square import chi_square_tail
from softid.diagnoses import Variation
from softid.diagnosis.assessment import surroundings
from softid.diagnosis.candidates import FINE, Candidate, limited_plans
from softid.diagnosis.remainder import Surroundings
from softid.diagnosis.whitening import whitener_of
from softid.effects import extended_name
from softid.effects.base import Effect
from softid.fitters.problem import Block

Array = npt.NDArray[np.float64]

KNOTS = 6
"""The size varies linearly between so many values of a variable, which part the log into pieces
that weigh alike."""

CHANCE = 1e-4
"""A size that is the same throughout seems to vary so by chance in one of so many logs."""

NOTABLE_VARIATION = 0.005
"""No material follows a law to the last digit: what a size that varies would take away is not told
while it is less than this share of what the cause takes away."""

SEEN, DISTINCT = 1e-10, 1e-6
"""Directions that are weaker than this share of the strongest, or of what they are without what
others explain of them, are rounding."""

VARIABLES = ("t", "x", "v", "p")


@dataclass(frozen=True, eq=False)
class _Rows:
    """One output channel over one segment.

    Attributes
    ----------
    block
        Residual and Jacobian at the used samples.
    used
        Which samples are used, shape (n,).
    log
        Index of the log.
    motion
        Motion and input at all samples.
    """

    block: Block
    used: npt.NDArray[np.bool_]
    log: int
    motion: Surroundings

    @property
    def channel(self) -> str:
        """The output channel."""
        return self.block.channel


def variations(
    final: Candidate, effects: Sequence[Effect], sigma: Mapping[str, float]
) -> tuple[Variation | None, ...]:
    """How the size of each effect varies, in the variable in which chance explains it least.

    With W whitening the residual r, J its Jacobian, g = Σ Aᵢ ∂y/∂Aᵢ the response's derivative along
    the logarithm of all sizes A of the effect, and h the hat functions of a variable, the score
    test regresses W r on W (g h) beside W J. What it takes away, q, is χ² with as many degrees of
    freedom as columns stand beside J; q/‖W g‖² beside the unknowns of the model without the effect
    is the variance of the size as a share of its square.

    Parameters
    ----------
    final
        The model with all causes, at its optimum.
    effects
        The causes that are asked about.
    sigma
        Weight of each output channel, which floors the noise.

    Returns
    -------
    tuple
        One for each effect; None where nothing shows that its size varies, or that it varies more
        than any material's.
    """
    look = _Look(final, sigma)
    return tuple(look.variation_of(effect) for effect in effects)


class _Look:
    """What the model with all causes leaves and how it bends, made white."""

    def __init__(self, final: Candidate, sigma: Mapping[str, float]) -> None:
        self.final = final
        self.rows = _rows_of(final)
        self.whitener = whitener_of(final.problem, final.minimum.point, sigma)
        self.jacobian = np.concatenate([_jacobian(row.block) for row in self.rows])
        self.white_jacobian = self.white(self.jacobian)
        self.basis = _basis(self.white_jacobian)
        residual = np.concatenate([row.block.residual for row in self.rows])
        self.left = _beside(self.basis, self.white(residual[:, None])[:, 0])

    def white(self, columns: Array) -> Array:
        """Columns at the used samples of all rows, made white."""
        edges = np.cumsum([0, *(row.block.residual.size for row in self.rows)])
        parts = [
            self.whitener.apply(columns[begin:end], row.used, log=row.log, channel=row.channel)
            for row, (begin, end) in zip(self.rows, pairwise(edges.tolist()), strict=True)
        ]
        return np.concatenate(parts)

    def variation_of(self, effect: Effect) -> Variation | None:
        """How the size of one effect varies, in the variable that chance explains least."""
        free = self.final.problem.free
        own = [k for k, name in enumerate(free) if name.startswith(f"{effect.name}_")]
        others = _basis(np.delete(self.white_jacobian, own, axis=1))
        growth = self.jacobian @ _direction(self.final, effect)
        whole = self.white(growth[:, None])
        weight = float(np.sum(whole**2))
        taken = float(np.sum(_beside(others, whole) ** 2))
        if taken <= DISTINCT**2 * weight:
            return None  # the model without the effect can do all that it does
        found = []
        for name in VARIABLES:
            columns = self.white(growth[:, None] * _hats(name, self.rows, growth**2))
            variation = _judged(name, _asked(self.basis, columns), self.left, weight, taken)
            found += [variation] if variation is not None else []
        return min(found, key=lambda variation: variation.chance, default=None)


def _asked(basis: Array, columns: Array) -> Array:
    """What columns add to a basis: orthonormal and beside it."""
    beside = _beside(basis, columns)
    adds = np.linalg.norm(beside, axis=0) > DISTINCT * np.linalg.norm(columns, axis=0)
    return _basis(beside[:, adds], DISTINCT)


def _judged(name: str, asked: Array, left: Array, weight: float, taken: float) -> Variation | None:
    """The variation with a variable, if chance does not explain it and it is worth a word.

    ``weight`` is ‖W g‖², of which the model without the effect cannot do ``taken``.
    """
    freedom = asked.shape[1]
    if freedom == 0:
        return None
    variance = float(left @ left) / left.size
    further = float(np.sum((asked.T @ left) ** 2)) / variance
    chance = chi_square_tail(further, freedom)
    beyond = max(further - freedom, 0.0)
    if chance > CHANCE or beyond < NOTABLE_VARIATION * taken:
        return None
    return Variation(name, (beyond / weight) ** 0.5, beyond / taken, chance)


def _rows_of(final: Candidate) -> list[_Rows]:
    problem, z = final.problem, final.minimum.point
    motions = surroundings(final)
    plans = limited_plans(problem, z, FINE)
    found = []
    for block in problem.blocks(z, derivatives=True, plans=plans):
        segment = problem.segments[block.segment]
        used = segment.samples_of(segment.used[block.channel])
        owner, motion = problem.owner[block.segment], motions[block.segment]
        found.append(_Rows(block, used, owner, motion))
    return found


def _jacobian(block: Block) -> Array:
    assert block.jacobian is not None
    return block.jacobian


def _direction(final: Candidate, effect: Effect) -> Array:
    """Change of the unknowns when all sizes of an effect grow in proportion, shape (U,).

    An effect without a size grows with all of its parameters.
    """
    problem, values = final.problem, final.parameters
    names = [extended_name(effect, name) for name in effect.amplitudes]
    names = names or [n for n in problem.free if n.startswith(f"{effect.name}_")]
    direction = np.zeros(problem.size)
    for k, name in enumerate(problem.free):
        if name in names:
            direction[k] = 1.0 if problem.parameters[name].scale == "log" else values[name]
    return direction


def _hats(name: str, rows: Sequence[_Rows], weight: Array) -> Array:
    """Hat functions of a variable over all rows, shape (m, H); those of the time for each log."""
    values = np.concatenate([_variable(name, row)[row.used] for row in rows])
    if name != "t":
        return _hats_over(values, weight)
    owner = np.concatenate([np.full(row.block.residual.size, row.log) for row in rows])
    parts = []
    for log in np.unique(owner):
        mine = owner == log
        hats = _hats_over(values[mine], weight[mine])
        whole = np.zeros((owner.size, hats.shape[1]))
        whole[mine] = hats
        parts.append(whole)
    return np.concatenate(parts, axis=1)


def _variable(name: str, row: _Rows) -> Array:
    motion = row.motion
    return {"t": motion.time_s, "x": motion.x, "v": motion.v, "p": motion.u}[name]


def _hats_over(values: Array, weight: Array) -> Array:
    """Hat functions whose knots part the weight evenly, shape (m, H)."""
    order = np.argsort(values)
    sums = np.cumsum(weight[order])
    if not sums[-1] > 0.0:
        return np.zeros((values.size, 0))
    knots = np.unique(np.interp(np.linspace(0.0, sums[-1], KNOTS), sums, values[order]))
    return np.column_stack([np.interp(values, knots, row) for row in np.eye(knots.size)])


def _basis(columns: Array, smallest: float = SEEN) -> Array:
    """Orthonormal columns that span the given ones."""
    size = np.linalg.norm(columns, axis=0)
    scaled: Array = columns[:, size > 0.0] / size[size > 0.0]
    if scaled.shape[1] == 0:
        return scaled
    left, singular, _ = np.linalg.svd(scaled, full_matrices=False)
    basis: Array = left[:, singular > smallest * singular[0]]
    return basis


def _beside(basis: Array, columns: Array) -> Array:
    """Columns with what a basis spans taken out."""
    projected: Array = columns - basis @ (basis.T @ columns)
    return projected
