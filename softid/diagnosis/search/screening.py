"""Which effects could explain what the fit leaves: signatures against the residual."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import COARSE_STEPS, FINE_STEPS, Candidate, limited_plans
from softid.diagnosis.refit.extension import extend, named_values, start_unknowns
from softid.diagnosis.refit.rough_copy import rough_copy
from softid.diagnosis.refit.state_sizes import reach_of
from softid.diagnosis.residual.projection import Span, project_out, span_of
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.fitters.problem import Problem
from softid.parallel import in_parallel

Array = npt.NDArray[np.float64]

LEAST_FOLLOWED = 1e-6
"""Directions of the Jacobian that are weaker than this share of the strongest are not followed: the
unknowns would have to go so far along them that no linear model holds."""

FORGOTTEN = 0.01
"""Share of a residual up to which an initial state that moves as far as the actuator ever does
shows nothing."""

SMALLEST_AMPLITUDE = 0.05
"""Smallest factor by which a start's amplitude is scaled to what the residual asks for."""

LARGEST_AMPLITUDE = 5.0
"""Largest factor by which a start's amplitude is scaled to what the residual asks for: a signature
is linear, and says little so far out."""


@dataclass(frozen=True, eq=False)
class Signature:
    """What one start of one effect would change, seen against the residual.

    Attributes
    ----------
    effect
        The effect.
    values
        Parameter → value from which a refit starts, its amplitude scaled to the residual.
    drop
        (r·s)²/(s·s), the drop of the sum of squares that it promises.
    shift
        By how much the unknowns of what is extended move to make room for it, shape (U,).
    """

    effect: Effect
    values: Mapping[str, float]
    drop: float
    shift: Array


@dataclass(frozen=True, eq=False)
class Residual:
    """Residual and Jacobian of a fit, with what the Jacobian spans taken out.

    Attributes
    ----------
    rows
        Residual in units of the channels' weights, shape (n,).
    span
        What the Jacobian spans, as far as the unknowns can follow.
    simulated
        Simulated outputs in the same units and order, with the steps of the signatures, shape (n,).
    """

    rows: Array
    span: Span
    simulated: Array


def residual_of(problem: Problem, unknowns: Array, sigma: Mapping[str, float]) -> Residual:
    """Linearise a fit where it stands.

    An initial state that is forgotten before the first sample that counts stays where it is: to
    explain anything it would have to go out of this world, and what remembers it would follow.

    Parameters
    ----------
    problem, unknowns
        The fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    fine, coarse = (limited_plans(problem, unknowns, most) for most in (FINE_STEPS, COARSE_STEPS))
    blocks = list(problem.blocks(unknowns, derivatives=True, plans=fine))
    rough = problem.blocks(unknowns, derivatives=False, plans=coarse)
    rows = np.concatenate([b.residual / sigma[b.channel] for b in blocks])
    jacobian = np.concatenate(
        [b.jacobian / sigma[b.channel] for b in blocks if b.jacobian is not None]
    )
    roughly = np.concatenate([b.residual / sigma[b.channel] for b in rough])
    least = FORGOTTEN * float(np.linalg.norm(rows))
    reach = reach_of(problem)
    for at in (at for k in range(len(problem.segments)) for at in problem.state_positions(k)):
        if reach[at] * np.linalg.norm(jacobian[:, at]) < least:
            jacobian[:, at] = 0.0
    return Residual(rows, span_of(jacobian, LEAST_FOLLOWED), _measured(problem, sigma) - roughly)


def _measured(problem: Problem, sigma: Mapping[str, float]) -> Array:
    return np.concatenate(
        [
            segment.outputs[name][segment.used[name]] / sigma[name]
            for segment in problem.segments
            for name in problem.outputs
        ]
    )


def screen(
    fitted: Candidate,
    effects: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> list[Signature]:
    """Signatures of every start of every effect, seen on a `rough_copy`, the most promising first.

    Parameters
    ----------
    fitted
        The base, or a candidate that already has effects.
    effects
        Effects that it does not have.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    fitted, sigma = rough_copy(fitted, scale, sigma)
    residual = residual_of(fitted.problem, fitted.minimum.point, sigma)
    measured = _measured(fitted.problem, sigma)
    reach = 0.5 * reach_of(fitted.problem)
    starts = [(effect, values) for effect in effects for values in effect.starts(scale)]

    def look(start: tuple[Effect, Mapping[str, float]]) -> Signature | None:
        effect, values = start
        problem = extend(fitted.problem, (effect,), scale)
        named = named_values(effect, values)
        z = start_unknowns(problem, fitted.problem, fitted.minimum.point, named)
        with np.errstate(all="ignore"):
            plans = limited_plans(problem, z, COARSE_STEPS)
            blocks = problem.blocks(z, derivatives=False, plans=plans)
            rows = [b.residual / sigma[b.channel] for b in blocks]
            whole = measured - np.concatenate(rows) - residual.simulated
            change = project_out(residual.span.basis, whole)
            power = float(change @ change)
        if not np.isfinite(power) or power <= 0.0:
            return None
        along = float(residual.rows @ change)
        share, drop = along / power, along**2 / power
        if not effect.changes_sign and share < 0.0:
            share, drop = SMALLEST_AMPLITUDE, 0.0
        scaled, factor = _scaled(effect, values, share)
        shift = -factor * (residual.span.combinations @ (residual.span.basis.T @ whole))
        return Signature(effect, scaled, drop, np.clip(shift, -reach, reach))

    return sorted(filter(None, in_parallel(look, starts)), key=lambda s: -s.drop)


def _scaled(
    effect: Effect, values: Mapping[str, float], share: float
) -> tuple[dict[str, float], float]:
    """Start values with the amplitude as large as the residual asks for, and by what factor."""
    size = np.clip(abs(share), SMALLEST_AMPLITUDE, LARGEST_AMPLITUDE)
    factor = float(np.copysign(size, share))
    scaled = dict(values)
    for name in effect.amplitudes:
        scaled[name] = factor * scaled[name]
    return scaled, factor if effect.amplitudes else 1.0
