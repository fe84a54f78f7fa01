"""A noise model by which residuals of all candidates are made white alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.fitters.problem import Block, Problem
from softid.uncertainty.autoregression import fit_ar, run_slices

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

MAX_ORDER = 8
"""Orders of the autoregression are tried up to this one: a lag structure longer than that is a
misfit, which the whitening should leave for the causes."""

SIGMA_FLOOR = 1e-9
"""Noise is at least this share of the output's scale: a log without any would weigh infinitely."""


@dataclass(frozen=True, eq=False)
class Whitener:
    """Autoregressive noise, one for each log and channel.

    Attributes
    ----------
    phi
        (log, channel) → coefficients, each of shape (p,): e_t = Σ φ_k e_{t−k} + w_t.
    sigma
        (log, channel) → standard deviation of w.
    """

    phi: Mapping[tuple[int, str], Array]
    sigma: Mapping[tuple[int, str], float]

    def apply(self, rows: Array, used: BoolArray, *, log: int, channel: str) -> Array:
        """Innovations of residual and Jacobian columns in units of their standard deviation.

        Parameters
        ----------
        rows
            Values at the used samples of a segment, shape (m, C).
        used
            Which samples of the segment are used, shape (n,).
        log, channel
            Whose noise it is.
        """
        phi = self.phi[log, channel]
        position = 0
        white = []
        for run in run_slices(used):
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
        scaled: Array = joined / self.sigma[log, channel]
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
    parts: dict[tuple[int, str], list[Block]] = {}
    for block in problem.blocks(unknowns, derivatives=False):
        parts.setdefault((problem.owner[block.segment], block.channel), []).append(block)
    phi, sigma = {}, {}
    for key, blocks in parts.items():
        runs = []
        for block in blocks:
            segment = problem.segments[block.segment]
            used = segment.samples_of(segment.used[block.channel])
            position = 0
            for run in run_slices(used):
                length = run.stop - run.start
                runs.append(block.residual[position : position + length])
                position += length
        ar = fit_ar(runs, max_order=MAX_ORDER)
        phi[key] = np.asarray(ar.phi, np.float64)
        sigma[key] = max(ar.sigma_innovation, SIGMA_FLOOR * floor[key[1]])
    return Whitener(phi, sigma)
