"""Fits over short pieces, each with an initial state of its own: multiple shooting.

A simulation that runs free over a whole log falls out of step with a ringing response, and its
error has a false minimum for every period that it may slip. Over a piece shorter than the ringing
it cannot. Fitted to pieces that grow longer, the parameters stay in the basin of the true ones
(Bock, in *Modelling of Chemical Reaction Systems*, Springer 1981; Ribeiro et al., Automatica 121,
2020, 109158).
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from softid.fitters.levenberg_marquardt import NormalEquations
from softid.fitters.problem import Problem

Array = npt.NDArray[np.float64]

LEAST_SAMPLES = 8
"""Samples of a piece at least, a judgement: each piece has an initial state of its own to be
estimated, and shorter ones would leave little beyond it for the parameters."""


class PiecewiseProblem(Problem):
    """A problem over pieces of segments, each with an initial state to be estimated."""

    @classmethod
    def over(cls, whole: Problem, cuts: Sequence[Sequence[tuple[int, int]]]) -> PiecewiseProblem:
        """The pieces of a problem that lie between some samples.

        Parameters
        ----------
        whole
            The problem to be cut.
        cuts
            For every segment, first sample and the one behind the last of each of its pieces.
        """
        every = zip(whole.plain_segments, cuts, strict=True)
        segments = [s.part(slice(start, stop)) for s, ranges in every for start, stop in ranges]
        parts = [(k, start == 0) for k, ranges in enumerate(cuts) for start, _ in ranges]
        return cls.with_segments(whole, segments, parts)

    def started(self, values: Mapping[str, float]) -> Array:
        """Unknowns at given parameter values, every piece starting at its first measured sample."""
        z = self.unknowns(values)
        name, theta = self.outputs[0], self.theta(z)
        if not np.isfinite(theta).all():
            return z  # a tie is broken there, and nothing can be simulated
        for k, segment in enumerate(self.segments):
            states, first = self.state_positions(k), np.flatnonzero(segment.used[name])
            if not states or not first.size or not self.has_equilibrium:
                continue
            zero = z[self.zero_position(self.owner[k], name)] if self.zeros else 0.0
            here = slice(first[0], first[0] + 1)
            rest = self.model.static_output(theta, segment.input[here], name)[0]
            slope = self._slope(theta, k, name)
            if np.isfinite(rest) and slope != 0.0:
                z[states[0]] = (segment.outputs[name][here][0] - zero - rest) / slope
        return z

    def with_best_states(self, at: NormalEquations) -> Array:
        """Unknowns with all zeros and initial states at their optimum for the same parameters.

        Both stand linearly in a linear motion, so that one solve finds them, however far they are;
        left to the optimiser they would hold back the first steps of all unknowns.

        Parameters
        ----------
        at
            Cost and normal equations at the unknowns.
        """
        moved = at.point.copy()
        linear = slice(len(self.free), None)
        if np.isfinite(at.cost):
            solved = np.linalg.lstsq(at.matrix[linear, linear], at.gradient[linear], rcond=None)
            moved[linear] += solved[0]
        return moved

    def _slope(self, theta: Array, segment: int, name: str) -> float:
        """∂(output)/∂(first state) at the start of a piece."""
        state = np.zeros(len(self.model.states))
        piece = self.segments[segment]
        short = piece.part(slice(2))
        response = self.model.response(
            theta, short, (name,), start=state, derivatives=True, relative=True
        )
        return 0.0 if response.by_state is None else float(response.by_state[name][0, 0])


def cut_into(whole: Problem, pieces: int) -> PiecewiseProblem:
    """A problem with every segment cut into pieces.

    Parameters
    ----------
    whole
        The problem to be cut.
    pieces
        About how many pieces all segments make together.
    """
    total_s = sum(float(s.time_s[-1] - s.time_s[0]) for s in whole.segments)
    cuts = []
    for segment in whole.plain_segments:
        n, length_s = segment.time_s.size, float(segment.time_s[-1] - segment.time_s[0])
        count = round(pieces * length_s / total_s) if total_s > 0.0 else 1
        edges = np.linspace(0, n, max(1, min(count, n // LEAST_SAMPLES)) + 1).astype(int)
        cuts.append(list(itertools.pairwise(edges.tolist())))
    return PiecewiseProblem.over(whole, cuts)
