"""Rivals of an optimum: other forms of damping, and ringing motions where structure is left.

A perturbed restart explores the basin of an optimum and its neighbours. Damping of another form
lies beyond, and differs by so little that a false optimum may leave white noise behind. A motion
that rings at another frequency lies far away, behind many false minima, and is looked for by way of
the beginnings of the logs, by regression on the data and by multiple shooting. That takes a few
times as long as all before it, so it is left out where nothing but noise is left, and where neither
the optimum rings nor what it leaves behind swings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from softid.fitters.beginnings import informative_beginning, optima_by_beginnings
from softid.fitters.levenberg_marquardt import Minimum
from softid.fitters.multiple_shooting import PiecewiseProblem, cut_into
from softid.fitters.objective import SCOUT_EVALUATIONS, Objective
from softid.fitters.problem import Problem
from softid.fitters.residual_whiteness import (
    STRUCTURE_SDS,
    TESTED_LAGS,
    largest_sum,
    residuals_by_channel,
    squared_autocorrelation,
)
from softid.parallel import in_parallel

Array = npt.NDArray[np.float64]

_Ended = tuple[float, Mapping[str, float]]
"""The cost at the end of a run, and the parameters there."""

SAMPLES_TO_SEARCH = 20_000
"""Samples from which on ringing motions are looked for in the beginnings of the logs only: a false
frequency is as false there, and what is found is fitted to all samples."""

PIECE_COUNTS = (64, 32, 16, 8, 4, 2)
"""Pieces into which all segments are cut together, in turn. Over twice the time a motion that kept
step falls out of it by no more than twice as much."""

WORTH_PURSUING = 1.02
"""A rival is dropped when over the shortest pieces, where no simulation falls out of step, it costs
this many times what the optimum costs there."""

SAME_COST = 1e-3
"""Two starts whose costs over the same pieces differ by no more than this share have met."""

BETTER_COST = 0.999
"""Share of the optimum's cost below which a rival takes its place; within it they are alike."""

MOST_PURSUED = 6
"""Starts that go on from the shortest pieces at most. Each may take some 180 evaluations: those of
a scout over every longer cut, and over the whole."""

SORTING_EVALUATIONS = 20
"""Evaluations over the shortest pieces by which the starts are put in order."""

LEAST_COLOUR = 0.05
"""Sum of the squared autocorrelations over the first lags from which a residual has structure: an
autocorrelation of 0.22 at one lag, or half of it at four. From 1200 samples on it is more than
what `STRUCTURE_SDS` ask for."""

LEAST_SWING = 0.2
"""Rise of a residual's autocorrelation after a fall from which it swings: so it does when a tenth
of its power is ringing."""

SWING_ERRORS = 4.0
"""Rise of a residual's autocorrelation after a fall from which it swings, in standard errors of an
autocorrelation, 1/√n for n samples of white noise; it counts below 400 samples. Over a hundred lags
white noise often rises by as much: only a residual that has structure is asked."""

LAG_SHARE = 0.25
"""Largest lag that is looked at, as a share of a segment: what swings less than some three times in
it passes for drift."""

RETURN_SHARE = 0.5
"""Lags are looked at up to this share of that at which the input comes back. What it leaves behind
within half of that time of a step or a turn is then no swing, and a ringing of three quarters of
that time is seen."""

ACTIVITY_SHARE = 0.005
"""Share of a segment over which the change of the input is its activity."""

DAMPING_LEVELS = 20
"""Inputs at which the damping ratio of an optimum is looked at."""


def best_rival(
    problem: Problem, sigma: Mapping[str, float], best: Minimum, *, thorough: bool = True
) -> tuple[Array, int]:
    """Look for a better basin than that of an optimum.

    Parameters
    ----------
    problem, sigma
        What was fitted, and the weights of the channels.
    best
        The optimum.
    thorough
        Whether ringing motions are looked for, which takes the longest, and other forms of damping
        even where the residual is white.

    Returns
    -------
    unknowns, evaluations
        The unknowns of a rival with a cost below 99.9 %, or else those of the optimum, shape (U,),
        and the simulations of all logs that it took.
    """
    if not problem.free or not problem.model.start_states:
        return best.point, 0
    if not thorough and not has_structure(problem, best.point):
        return best.point, 0
    search = Objective(problem, sigma)
    found = search(best.point)
    values = problem.values(found.point)
    point, cost = best.point, BETTER_COST * found.cost
    starts = [other.values_dict() for other in problem.model.alternatives(values)]
    for ended, taken in in_parallel(partial(_scouted, problem, sigma), starts, small=True):
        search.evaluations += taken
        if ended.normal.cost < cost:
            point, cost = ended.point, ended.normal.cost
    if not thorough:
        return point, search.evaluations
    if not has_structure(problem, point):
        return point, search.evaluations
    if not (_rings(problem, point) or residual_oscillates(problem, point)):
        return point, search.evaluations
    part = informative_beginning(problem, SAMPLES_TO_SEARCH)
    if part is problem:
        rival, used = _ringing_rival(problem, sigma, point, cost)
        return rival, search.evaluations + used
    there = Objective(part, sigma).solve(part.unknowns(problem.values(point)), SCOUT_EVALUATIONS)
    rival, used = _ringing_rival(part, sigma, there.point, BETTER_COST * there.normal.cost)
    if rival is not there.point:
        ended = search.solve(problem.unknowns(part.values(rival)), SCOUT_EVALUATIONS)
        point = ended.point if ended.normal.cost < cost else point
    return point, search.evaluations + there.evaluations + used


def _scouted(
    problem: Problem, sigma: Mapping[str, float], start: Mapping[str, float]
) -> tuple[Minimum, int]:
    """The end of a short run, and its evaluations."""
    search = Objective(problem, sigma)
    return search.solve(problem.unknowns(start), SCOUT_EVALUATIONS), search.evaluations


def _ringing_rival(
    problem: Problem, sigma: Mapping[str, float], point: Array, cost: float
) -> tuple[Array, int]:
    """A point that costs less, by way of beginnings and pieces, or the same one; evaluations."""
    used = 0
    for ended, taken in optima_by_beginnings(problem, sigma):
        used += taken
        if ended.normal.cost < cost:
            point, cost = ended.point, ended.normal.cost
            if not has_structure(problem, point):
                return point, used
    rungs = _Ladder(problem, sigma)
    point = rungs.climbed(point, cost)
    return point, used + rungs.evaluations


class _Ladder:
    """Starts that ring, continued over pieces that grow longer."""

    def __init__(self, problem: Problem, sigma: Mapping[str, float]) -> None:
        self.problem = problem
        self.sigma = sigma
        self.evaluations = 0

    def climbed(self, point: Array, cost: float) -> Array:
        """The first rival that costs less than ``cost`` and leaves no structure, or the cheapest.

        The optimum goes through the pieces too, which may lead it out of its false minimum. Of the
        other starts only those go on that explain the shortest pieces about as well, best first.
        """
        problem = self.problem
        rings = problem.model.ringing(problem.plain_segments, problem.outputs[0])
        if not rings:
            return point
        incumbent = problem.values(point)
        cut, *longer = (cut_into(problem, count) for count in PIECE_COUNTS)
        starts = [(incumbent, SCOUT_EVALUATIONS)]
        starts += [(start.values_dict(), SORTING_EVALUATIONS) for start in rings]
        own, *others = self._each_fitted(cut, starts)
        limit = WORTH_PURSUING * own[0]
        ranked = sorted([own, *others], key=lambda row: row[0])
        reached: list[list[float]] = [[] for _ in longer]
        for short, values in ranked[:MOST_PURSUED]:
            if short > limit:
                break
            values_there = self._continued(longer, values, reached)
            if values_there is None:
                continue
            ended = self._solved(problem, problem.unknowns(values_there), SCOUT_EVALUATIONS)
            if ended.normal.cost < cost:
                point, cost = ended.point, ended.normal.cost
                if not has_structure(problem, point):
                    break
        return point

    def _each_fitted(
        self, pieces: PiecewiseProblem, starts: Sequence[tuple[Mapping[str, float], int]]
    ) -> list[_Ended]:
        """The fit to the pieces from each of the starts, side by side."""

        def fitted(start: tuple[Mapping[str, float], int]) -> tuple[_Ended, int]:
            alone = _Ladder(self.problem, self.sigma)
            return alone._fitted(pieces, *start), alone.evaluations

        found = in_parallel(fitted, starts)
        self.evaluations += sum(taken for _, taken in found)
        return [row for row, _ in found]

    def _continued(
        self,
        longer: Sequence[PiecewiseProblem],
        values: Mapping[str, float],
        reached: Sequence[list[float]],
    ) -> Mapping[str, float] | None:
        """The fit to ever longer pieces; None where another start has come by the same point."""
        for pieces, costs in zip(longer, reached, strict=True):
            cost, values = self._fitted(pieces, values, SCOUT_EVALUATIONS)
            if any(abs(cost - other) <= SAME_COST * other for other in costs):
                return None
            costs.append(cost)
        return values

    def _fitted(
        self,
        pieces: PiecewiseProblem,
        values: Mapping[str, float],
        evaluations: int,
    ) -> _Ended:
        at_first_samples = Objective(pieces, self.sigma)(pieces.started(values))
        self.evaluations += 1
        ended = self._solved(pieces, pieces.with_best_states(at_first_samples), evaluations)
        return ended.normal.cost, pieces.values(ended.point)

    def _solved(self, problem: Problem, z: Array, evaluations: int) -> Minimum:
        search = Objective(problem, self.sigma)
        ended = search.solve(z, evaluations)
        self.evaluations += search.evaluations
        return ended


def has_structure(problem: Problem, z: Array) -> bool:
    """Whether the residual is clearly not white, by its squared autocorrelations summed over lags.

    Parameters
    ----------
    problem
        What was fitted.
    z
        Unknowns, shape (U,).
    """
    for residuals in residuals_by_channel(problem, z):
        n = sum(r.size for r in residuals)
        if n <= TESTED_LAGS:
            continue
        limit = max(LEAST_COLOUR, largest_sum(STRUCTURE_SDS) / n)
        if squared_autocorrelation(residuals, TESTED_LAGS) > limit:
            return True
    return False


def _rings(problem: Problem, z: Array) -> bool:
    """Whether the damping ratio is below one at some input of the fitted range.

    A motion that rings may ring at a wrong frequency, and its residual need not swing for that.
    """
    values = problem.values(z)
    low = min(float(s.input.min()) for s in problem.segments)
    high = max(float(s.input.max()) for s in problem.segments)
    levels = np.linspace(low, high, DAMPING_LEVELS).tolist()
    ratios = (problem.model.speeds(values, level).damping_ratio for level in levels)
    return any(ratio is not None and ratio < 1.0 for ratio in ratios)


def residual_oscillates(problem: Problem, z: Array) -> bool:
    """Whether the autocorrelation of the residual falls and rises again, as that of ringing does.

    What a static curve or a decay leaves behind drifts, and its autocorrelation only falls. What
    a step of the input leaves behind comes back with the next step, so that only lags short against
    the way to there are looked at.

    Parameters
    ----------
    problem
        What was fitted.
    z
        Unknowns, shape (U,).
    """
    blocks = list(problem.blocks(z, derivatives=False))
    for name in problem.outputs:
        of_channel = [b for b in blocks if b.channel == name and b.residual.size > TESTED_LAGS]
        residuals = [b.residual - b.residual.mean() for b in of_channel]
        segments = (problem.segments[b.segment] for b in of_channel)
        reaches = [_own_lags(segment.input[segment.used[name]]) for segment in segments]
        for reach in sorted(set(reaches)):
            alike = [r for r, own in zip(residuals, reaches, strict=True) if own >= reach]
            least = max(LEAST_SWING, SWING_ERRORS / np.sqrt(sum(r.size for r in alike)))
            if _rises_at(alike, reach, least) is not None:
                return True
    return False


def _own_lags(values: Array) -> int:
    """Lags, in samples, up to which a swing of the residual is no return of the input.

    The input has come back where its autocorrelation, or that of its activity, has risen again:
    after the way from step to step, or half a period of a sine.
    """
    most = int(LAG_SHARE * values.size)
    apart = max(1, int(ACTIVITY_SHARE * values.size))
    activity = np.abs(values[apart:] - values[:-apart])
    returns = [
        _rises_at([looked_at - looked_at.mean()], most, LEAST_SWING)
        for looked_at in (values, activity)
    ]
    return int(min([most, *(RETURN_SHARE * lag for lag in returns if lag is not None)]))


def _rises_at(series: Sequence[Array], lags: int, least: float) -> int | None:
    """The first lag at which the joint autocorrelation has risen again by ``least``, if any does.

    Parameters
    ----------
    series
        Stretches without their means, each of shape (n,).
    lags
        Largest lag that is looked at, in samples.
    least
        Smallest rise after a fall.
    """
    power = sum(float(r @ r) for r in series)
    longest = max((r.size for r in series), default=0)
    if power <= 0.0 or lags < 1:
        return None
    size = 2 ** int(np.ceil(np.log2(2 * longest)))
    spectrum = sum(np.abs(np.fft.rfft(r, size)) ** 2 for r in series)
    correlation = np.fft.irfft(spectrum, size)[: lags + 1] / power
    risen = correlation - np.minimum.accumulate(correlation) >= least
    return int(np.argmax(risen)) if risen.any() else None
