"""Whether the size of a cause is the same throughout: its law against others that look like it.

A law that is not the right one takes away most of a misfit where its size may settle between what
the log asks for here and there. So the size is let vary, smoothly with the time, the position, the
speed or the input, and the score test of that, a Lagrange multiplier, tells whether the residual
asks for it: nothing is refitted. The idea is that of Lin and Teräsvirta (J. Econometrics 62, 1994).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from softid.chi_square import chi_square_tail
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.whitening import whitener_of
from softid.diagnosis.residual.jump_timing import part_of_jumps
from softid.diagnosis.residual.projection import (
    LEAST_DISTINCT,
    Rows,
    added_basis,
    basis_of,
    project_out,
    rows_of,
)
from softid.diagnosis_results import Variation
from softid.effects import belongs_to, extended_name
from softid.effects.base import Effect

Array = npt.NDArray[np.float64]

SIZE_KNOTS = 6
"""The size varies linearly between so many values of a variable, which part the log into pieces
that weigh alike."""

FALSE_ALARM_RATE = 1e-4
"""A size that is the same throughout seems to vary so by chance in one of so many logs."""

NOTABLE_VARIATION = 0.005
"""No material follows a law to the last digit: what a size that varies would take away is not told
while it is less than this share of what the cause takes away."""

VARIED_WITH = ("t", "x", "v", "p")
"""What a size may vary with: time, position, speed and input."""


def variations(
    final: Candidate,
    effects: Sequence[Effect],
    sigma: Mapping[str, float],
    *,
    with_open_jumps: bool = False,
    unsure: Array | None = None,
) -> tuple[Variation | None, ...]:
    """How the size of each effect varies, in the variable in which chance explains it least.

    With W whitening the residual r, J its Jacobian, g = Σ Aᵢ ∂y/∂Aᵢ the response's derivative along
    the logarithm of all sizes A of the effect, and h the hat functions of a variable, the score
    test regresses W r on W (g h) beside W J. What that takes away of the variance s² of W r, q, is
    χ² with as many degrees of freedom ν as columns stand beside W J where the size is constant.
    Else (q − ν) s²/‖W g‖² is the variance of the size over its square, and the share is the same
    with W g beside the unknowns of the model without the effect, which is what the cause itself
    takes away. What is not known of the input is no noise that is alike throughout: draws of it,
    regressed likewise, add their mean square u to ν, and to the scale of the χ².

    Parameters
    ----------
    final
        The model with all causes, at its optimum.
    effects
        The causes that are asked about.
    sigma
        Output channel → scale that its residual is divided by, which floors the noise.
    with_open_jumps
        Whether the moments of jumps of the input are left open, as unknowns beside the model's.
    unsure
        Draws of what is not known of the input, in the first output, one in each row.

    Returns
    -------
    tuple
        One for each effect; None where nothing shows that its size varies, or that it varies more
        than any material's.
    """
    look = _ScoreTest(final, sigma, unsure, with_open_jumps=with_open_jumps)
    return tuple(look.variation_of(effect) for effect in effects)


class _ScoreTest:
    """What the model with all causes leaves and how it bends, made white."""

    def __init__(
        self,
        final: Candidate,
        sigma: Mapping[str, float],
        unsure: Array | None,
        *,
        with_open_jumps: bool,
    ) -> None:
        self.final = final
        self.rows = rows_of(final)
        self.whitener = whitener_of(final.problem, final.minimum.point, sigma)
        self.jacobian = np.concatenate([row.jacobian for row in self.rows])
        self.white_jacobian = self.white(self.jacobian)
        unknown = [self.white_jacobian]
        if with_open_jumps:
            unknown.append(self.white(_of_jumps(final, self.rows)))
        self.basis = basis_of(np.column_stack(unknown))
        residual = np.concatenate([row.residual for row in self.rows])
        self.left = project_out(self.basis, self.white(residual[:, None])[:, 0])
        freedom = max(self.left.size - self.basis.shape[1], 1)
        self.variance = float(self.left @ self.left) / freedom
        driven = np.zeros((self.left.size, 0))
        if unsure is not None:
            driven = project_out(self.basis, self.white(_in_all_rows(final, self.rows, unsure.T)))
        self.driven = driven

    def white(self, columns: Array) -> Array:
        """Columns at the used samples of all rows, made white."""
        edges = np.cumsum([0, *(row.residual.size for row in self.rows)])
        parts = [
            self.whitener.innovations(columns[begin:end], row.place)
            for row, (begin, end) in zip(self.rows, pairwise(edges.tolist()), strict=True)
        ]
        return np.concatenate(parts)

    def variation_of(self, effect: Effect) -> Variation | None:
        """How the size of one effect varies, in the variable that chance explains least."""
        free = self.final.problem.free
        own = [k for k, name in enumerate(free) if belongs_to(effect, name)]
        others = basis_of(np.delete(self.white_jacobian, own, axis=1))
        growth = self.jacobian @ _direction(self.final, effect)
        whole = self.white(growth[:, None])
        weight = float(np.sum(whole**2))
        taken = float(np.sum(project_out(others, whole) ** 2))
        if taken <= LEAST_DISTINCT**2 * weight:
            return None  # the model without the effect can do all that it does
        found = []
        for name in VARIED_WITH:
            columns = self.white(growth[:, None] * _piecewise_linear(name, self.rows, growth**2))
            asked = added_basis(self.basis, columns)
            further = float(np.sum((asked.T @ self.left) ** 2))
            by_input = float(np.sum((asked.T @ self.driven) ** 2)) / max(self.driven.shape[1], 1)
            ratios = further / self.variance, by_input / self.variance
            variation = _judged(name, asked.shape[1], ratios, self.variance, weight, taken)
            found += [variation] if variation is not None else []
        return min(found, key=lambda variation: variation.chance, default=None)


def _judged(
    name: str,
    freedom: int,
    ratios: tuple[float, float],
    variance: float,
    weight: float,
    taken: float,
) -> Variation | None:
    """The variation with a variable, if chance does not explain it and it is worth a word.

    ``ratios`` are q and u over the variance. ``weight`` is ‖W g‖², of which the model without the
    effect cannot do ``taken``.
    """
    if freedom == 0:
        return None
    further, by_input = ratios
    chance = chi_square_tail(further / (1.0 + by_input / freedom), freedom)
    beyond = max(further - freedom - by_input, 0.0) * variance
    if chance > FALSE_ALARM_RATE or beyond < NOTABLE_VARIATION * taken:
        return None
    return Variation(name, (beyond / weight) ** 0.5, beyond / taken, chance)


def _in_all_rows(final: Candidate, rows: Sequence[Rows], columns: Array) -> Array:
    """Columns at the used samples of the first output among those of all outputs, shape (m, D)."""
    first = final.problem.outputs[0]
    is_first = [np.full(row.residual.size, row.channel == first) for row in rows]
    places = np.concatenate(is_first)
    whole = np.zeros((places.size, columns.shape[1]))
    whole[places] = columns
    return whole


def _of_jumps(final: Candidate, rows: Sequence[Rows]) -> Array:
    """What the moments of all jumps do at the used samples of all rows, shape (m, 2 J)."""
    first = final.problem.outputs[0]
    spread = [float(row.residual.std()) for row in rows if row.channel == first]
    parts = [part_of_jumps(final, k, noise=noise) for k, noise in enumerate(spread)]
    whole = np.zeros((sum(row.residual.size for row in rows), sum(p.shape[1] for p in parts)))
    at, along = 0, 0
    for row in rows:
        if row.channel == first:
            part, parts = parts[0], parts[1:]
            whole[at : at + row.residual.size, along : along + part.shape[1]] = part[row.used]
            along += part.shape[1]
        at += row.residual.size
    return whole


def _direction(final: Candidate, effect: Effect) -> Array:
    """Change of the unknowns when all sizes of an effect grow in proportion, shape (U,).

    An effect without a size grows with all of its parameters.
    """
    problem, values = final.problem, final.parameters
    names = [extended_name(effect, name) for name in effect.amplitudes]
    names = names or [n for n in problem.free if belongs_to(effect, n)]
    direction = np.zeros(problem.size)
    for k, name in enumerate(problem.free):
        if name in names:
            direction[k] = 1.0 if problem.parameters[name].scale == "log" else values[name]
    return direction


def _piecewise_linear(name: str, rows: Sequence[Rows], weight: Array) -> Array:
    """Hat functions of a variable over all rows, shape (m, H); those of the time for each log."""
    values = np.concatenate([_variable(name, row)[row.used] for row in rows])
    if name != "t":
        return _piecewise_linear_over(values, weight)
    owner = np.concatenate([np.full(row.residual.size, row.place.log) for row in rows])
    parts = []
    for log in np.unique(owner):
        mine = owner == log
        hats = _piecewise_linear_over(values[mine], weight[mine])
        whole = np.zeros((owner.size, hats.shape[1]))
        whole[mine] = hats
        parts.append(whole)
    return np.concatenate(parts, axis=1)


def _variable(name: str, row: Rows) -> Array:
    motion = row.motion
    return {"t": motion.time_s, "x": motion.x, "v": motion.v, "p": motion.u}[name]


def _piecewise_linear_over(values: Array, weight: Array) -> Array:
    """Hat functions whose knots part the weight evenly, shape (m, H)."""
    order = np.argsort(values)
    sums = np.cumsum(weight[order])
    if not sums[-1] > 0.0:
        return np.zeros((values.size, 0))
    knots = np.unique(np.interp(np.linspace(0.0, sums[-1], SIZE_KNOTS), sums, values[order]))
    return np.column_stack([np.interp(values, knots, row) for row in np.eye(knots.size)])
