"""The noise by which candidates are compared and refined, with the moments of jumps of the input.

Where a command is switched between two samples nobody knows when, what the motion leaves of that is
no misfit: a law that can follow it, and no other, would look better than what is there, and
parameters would follow it too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate, advance, begun
from softid.diagnosis.refit.whitening import Unknown, Whitener, whitener_for, whitener_of
from softid.diagnosis.residual.jump_timing import JumpResponses, OpenJumps, untimed_jumps
from softid.diagnosis.residual.motion import mean_square
from softid.diagnosis.residual.projection import Rows, rows_of

Array = npt.NDArray[np.float64]

REFIT_EVALUATIONS = 16
"""Evaluations from the optimum for white noise to that with the moments open, which is near."""


@dataclass(frozen=True, eq=False)
class Moments:
    """What the moments of jumps do to what a model leaves of its first output.

    Attributes
    ----------
    own, others
        What it leaves of the first output, for every segment, and of other ones.
    responses, found
        What moments do, and the likeliest ones.
    """

    own: tuple[Rows, ...]
    others: tuple[Rows, ...]
    responses: JumpResponses
    found: OpenJumps

    @property
    def gain(self) -> float:
        """By how much n ln(S) falls with the moments open, less ln n for each of their numbers."""
        n, numbers = self.responses.columns.shape
        left = [mean_square(parts) for parts in (self.responses.parts, self.found.parts)]
        before, after = np.log(np.maximum(left, np.finfo(float).tiny))
        return float(n * (before - after) - numbers * np.log(n))

    @property
    def residuals(self) -> list[Array]:
        """What is left behind them at the used samples of each segment."""
        return [part.residual[np.isfinite(part.residual)] for part in self.found.parts]

    def beside(self, noise: Whitener) -> Whitener:
        """A noise model of what is left behind the moments, with these as unknown numbers.

        Parameters
        ----------
        noise
            The noise model.
        """
        unknown = {
            (row.place.segment, row.channel): Unknown.of(noise.innovations(columns, row.place))
            for row, columns in zip(self.own, self.responses.by_part, strict=True)
            if columns.size
        }
        return replace(noise, unknown=unknown)


def moments_of(model: Candidate) -> Moments | None:
    """The moments of jumps of a model where it stands; None where none is open.

    None is where no input jumps, nor where all may come as they are drawn, nor where the likeliest
    do not lie in their intervals: the lack of a delay asks for those.

    Parameters
    ----------
    model
        The model.
    """
    if not any(len(untimed_jumps(segment)) for segment in model.problem.segments):
        return None
    rows, first = rows_of(model), model.problem.outputs[0]
    own = tuple(row for row in rows if row.channel == first)
    others = tuple(row for row in rows if row.channel != first)
    parts, slopes = [row.motion for row in own], [row.jacobian for row in own]
    responses = JumpResponses.of(model, parts, mean_square(parts), slopes)
    found = None if responses is None else responses.with_misfit()
    if responses is None or found is None or not found.lie_inside:
        return None
    moments = Moments(own, others, responses, found)
    return moments if moments.gain > 0.0 else None


def noise_model_of(best: Candidate, sigma: Mapping[str, float]) -> Whitener:
    """The noise that the best of several candidates leaves.

    The moments of jumps that fall between samples are a part of it, as normal numbers.

    Parameters
    ----------
    best
        The candidate.
    sigma
        Output channel → scale that its residual is divided by, which floors the noise.
    """
    moments = moments_of(best)
    if moments is None:
        return whitener_of(best.problem, best.minimum.point, sigma)
    others = [(row.place, row.residual) for row in moments.others]
    places = [row.place for row in moments.own]
    left = list(zip(places, moments.residuals, strict=True))
    return moments.beside(whitener_for([*left, *others], sigma))


def noise_with_moments(model: Candidate, sigma: Mapping[str, float]) -> Whitener | None:
    """White noise, and the moments of jumps as normal numbers; None where none may be open.

    Parameters
    ----------
    model, sigma
        As in `noise_model_of`.
    """
    moments = moments_of(model)
    if moments is None:
        return None
    left = float(np.sqrt(np.mean(np.concatenate(moments.residuals) ** 2)))
    spread = {(row.place.log, row.channel): sigma[row.channel] for row in moments.others}
    spread |= {(row.place.log, row.channel): left for row in moments.own}
    return moments.beside(Whitener(dict.fromkeys(spread, np.empty(0)), spread))


def refined_under(model: Candidate, noise: Whitener, sigma: Mapping[str, float]) -> Candidate:
    """The model at its optimum under a noise model, as one at an optimum for white noise.

    Parameters
    ----------
    model
        A model at its optimum for white noise, which takes all jumps to be where they are drawn.
    noise
        The noise.
    sigma
        As in `noise_model_of`.
    """
    begin = replace(model, minimum=replace(model.minimum, damping=None), whitener=noise)
    found = advance(begin, sigma, REFIT_EVALUATIONS)
    if not np.isfinite(found.squares):
        return model
    return advance(begun(model, model.effects, model.problem, found.minimum.point), sigma, 1)
