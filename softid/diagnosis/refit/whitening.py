"""A noise model by which residuals of all candidates are made white alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from softid.fitters.blocks import Block
from softid.fitters.problem import Problem
from softid.uncertainty.autoregression import fit_ar, run_slices

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

MAX_ORDER = 8
"""Orders of the autoregression are tried up to this one: a lag structure longer than that is a
misfit, which the whitening should leave for the causes."""

SIGMA_FLOOR = 1e-9
"""Noise is at least this share of the output's scale: a log without any would weigh infinitely."""


class Place(NamedTuple):
    """A segment and a channel of a problem, which of its samples are used, and the log it is of."""

    segment: int
    log: int
    channel: str
    used: BoolArray

    @classmethod
    def of(cls, block: Block, problem: Problem) -> Place:
        """The place of a block of a problem."""
        segment = problem.segments[block.segment]
        used = segment.samples_of(segment.used[block.channel])
        return cls(block.segment, problem.owner[block.segment], block.channel, used)


@dataclass(frozen=True, eq=False)
class Unknown:
    """Normal numbers that move white noise: W = (I + G Gᵀ)^(−1/2) makes both white together.

    Attributes
    ----------
    axes, share
        Left singular vectors of G, shape (m, J), and 1 − 1/√(1 + s²) with its singular values s.
    """

    axes: Array
    share: Array

    @classmethod
    def of(cls, columns: Array) -> Unknown:
        """From what each number does per standard deviation, G of shape (m, J)."""
        axes, sizes, _ = np.linalg.svd(columns, full_matrices=False)
        return cls(axes, 1.0 - 1.0 / np.sqrt(1.0 + sizes**2))

    def shrunk(self, white: Array) -> Array:
        """W applied to columns, of shape (m, C)."""
        return white - (self.axes * self.share) @ (self.axes.T @ white)


@dataclass(frozen=True, eq=False)
class Whitener:
    """Autoregressive noise, one for each log and channel, and what is not known of the input.

    Attributes
    ----------
    phi
        (log, channel) → coefficients, each of shape (p,): e_t = Σ φ_k e_{t−k} + w_t.
    sigma
        (log, channel) → standard deviation of w.
    unknown
        (segment, channel) → what else moves the output there, with a standard deviation of one.
    """

    phi: Mapping[tuple[int, str], Array]
    sigma: Mapping[tuple[int, str], float]
    unknown: Mapping[tuple[int, str], Unknown] = field(default_factory=dict)

    def whiten(self, rows: Array, place: Place) -> Array:
        """Innovations with what the unknown moves shrunk.

        Parameters
        ----------
        rows, place
            As in `innovations`.
        """
        return self.shrunk(self.innovations(rows, place), place)

    def shrunk(self, white: Array, place: Place) -> Array:
        """What is white but for the unknown, with what that moves shrunk.

        Parameters
        ----------
        white
            Innovations, shape (m, C).
        place
            As in `innovations`.
        """
        unknown = self.unknown.get((place.segment, place.channel))
        return white if unknown is None else unknown.shrunk(white)

    def innovations(self, rows: Array, place: Place) -> Array:
        """Innovations of residual and Jacobian columns in units of their standard deviation.

        Parameters
        ----------
        rows
            Values at the used samples of a segment, shape (m, C).
        place
            Where they are.
        """
        key = place.log, place.channel
        phi = self.phi[key]
        position = 0
        white = []
        for run in run_slices(place.used):
            length = run.stop - run.start
            part = rows[position : position + length]
            position += length
            if length <= phi.size:
                continue
            innovations = part[phi.size :].copy()
            for k, coefficient in enumerate(phi, start=1):
                innovations -= coefficient * part[phi.size - k : length - k]
            white.append(innovations)
        joined = np.concatenate(white) if white else np.empty((0, rows.shape[1]))
        scaled: Array = joined / self.sigma[key]
        return scaled


def whitener_of(problem: Problem, unknowns: Array, floor: Mapping[str, float]) -> Whitener:
    """Fit the noise to what a candidate leaves.

    Parameters
    ----------
    problem
        The candidate.
    unknowns
        Where it stands, shape (U,).
    floor
        Output channel → scale that its residual is divided by; the noise is taken to be at least a
        billionth of it.
    """
    blocks = problem.blocks(unknowns, derivatives=False)
    return whitener_for([(Place.of(block, problem), block.residual) for block in blocks], floor)


def whitener_for(residuals: Sequence[tuple[Place, Array]], floor: Mapping[str, float]) -> Whitener:
    """Fit the noise to residuals.

    Parameters
    ----------
    residuals
        Residuals at the used samples of segments, each of shape (m,).
    floor
        As in `whitener_of`.
    """
    runs: dict[tuple[int, str], list[Array]] = {}
    for place, residual in residuals:
        position = 0
        for run in run_slices(place.used):
            length = run.stop - run.start
            own = residual[position : position + length]
            runs.setdefault((place.log, place.channel), []).append(own)
            position += length
    phi, sigma = {}, {}
    for key, own_runs in runs.items():
        ar = fit_ar(own_runs, max_order=MAX_ORDER)
        phi[key] = np.asarray(ar.phi, np.float64)
        sigma[key] = max(ar.sigma_innovation, SIGMA_FLOOR * floor[key[1]])
    return Whitener(phi, sigma)
