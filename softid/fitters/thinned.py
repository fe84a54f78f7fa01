"""The same problem over fewer samples: a cheap way to the right basin.

A long log tells where the optimum is no better than two thousand block averages do, as long as the
motion is slow against a block. Where it is fast, averages hide it and take as many steps as all
samples; then windows of the log lead the way, each with an initial state of its own. The optimum
itself is always taken over all samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.fitters.multiple_shooting import PiecewiseProblem
from softid.fitters.noise_level import at_noise_level
from softid.fitters.normal_equations import Linearised
from softid.fitters.objective import Objective
from softid.fitters.problem import Problem
from softid.parallel import in_parallel
from softid.segment import Segment

Array = npt.NDArray[np.float64]

KEPT_RESIDUALS = 2000
"""Residuals that are left, about, or more where the blocks would become too long."""

LONGEST_BLOCK = 8
"""Most samples in a block. A log of 100,000 samples in blocks of 50, longer than its motion takes,
led beside the basin, and the fit took twice as long as without."""

WORTHWHILE = 0.5
"""Largest share of the steps of all samples that block averages may take."""

LEAST_WHOLE_BLOCKS = 0.5
"""Least share of the residuals that lie in blocks of which no sample is missing: an output that is
read once in three rows has no such block."""

WINDOWED = 2500
"""Samples in all windows together."""

MOST_PER_LOG = 2
"""One window in the middle of a log is half the work around the same samples; where it does not
show the motion, two, which begin and end with the log."""

MOST_WINDOWED = 4
"""Of several segments so many at most have a window each, in their middle: those whose input has
the widest range. Where such windows are too short, fewer and longer ones may do."""

COVERED = 0.8
"""Share of the range of the input that windows must hold."""

LASTING = 10.0
"""Time constants that a window must last."""

TIME_LEVELS = 5
"""Inputs at which the time constant of a start is looked at."""

LEAST_SAVING = 4
"""Times the samples of all windows together that a problem must hold for windows to be worth their
own initial states."""

ROUGH_TOLERANCE = 0.1
"""`attainable_offset` at which a run over fewer samples ends: their optimum is another one."""

AT_A_TIME = 2
"""Starts that go through the windows at a time."""

LEAST_BLOCKS = 20
"""Fewest blocks of a segment; the averages of shorter ones would lose their transients."""


@dataclass(frozen=True, eq=False)
class WarmStart:
    """Where a run over all samples begins, after one over fewer of them from a start.

    Attributes
    ----------
    start
        The start, unknowns of the whole problem, shape (U,).
    point
        The optimum over fewer samples, the start itself without one, shape (U,).
    damping
        With which a run over all samples goes on; None where it begins anew.
    cost
        That of the rough problem there; infinite without one.
    is_white
        Whether the rough problem is explained down to white noise there, as in `at_noise_level`.
    """

    start: Array
    point: Array
    damping: float | None = None
    cost: float = np.inf
    is_white: bool = False


def averaged(whole: Problem, length: int) -> Problem:
    """A problem over means of so many consecutive samples each, with the same unknowns.

    Parameters
    ----------
    whole
        The problem to be thinned.
    length
        Samples in a block.
    """
    segments = [_averaged(segment, length) for segment in whole.plain_segments]
    return Problem.with_segments(whole, segments)


def windows_of(whole: Problem, windows: int = MOST_PER_LOG) -> PiecewiseProblem:
    """A problem over windows of its segments, each with an initial state to be estimated.

    Parameters
    ----------
    whole
        The problem.
    windows
        How many of them: in a single segment side by side, else one in each of so many segments.
    """
    segments = whole.plain_segments
    widest = sorted(range(len(segments)), key=lambda k: -float(np.ptp(segments[k].input)))
    kept = set(widest[:windows])
    total = sum(segments[k].time_s.size for k in kept)
    count = windows if len(segments) == 1 else 1
    cuts: list[list[tuple[int, int]]] = [[] for _ in segments]
    for k in kept:
        n = segments[k].time_s.size
        size = min(n, max(1, WINDOWED * n // total // count))
        begins = np.linspace(0, n - size, count).astype(int).tolist()
        if count == 1:
            begins = [(n - size) // 2]
        cuts[k] = [(begin, begin + size) for begin in begins]
    return PiecewiseProblem.over(whole, cuts)


def _numbers_of_windows(segments: int) -> range:
    """How many windows are tried, in turn: one first in a single segment, else one in each."""
    if segments == 1:
        return range(1, MOST_PER_LOG + 1)
    return range(min(segments, MOST_WINDOWED), 0, -1)


def rough_problem(problem: Problem, z: Array) -> Problem | None:
    """A cheaper problem that leads near the optimum; None where there is none.

    Parameters
    ----------
    problem
        The problem.
    z
        Unknowns at a start, whose motion is looked at, shape (U,).
    """
    if problem.model.start_states and problem.n_samples >= LEAST_SAVING * WINDOWED:
        for count in _numbers_of_windows(len(problem.segments)):
            windows = windows_of(problem, count)
            if _show_the_motion(windows, problem, z):
                return windows
    length = thinning(problem)
    if length > 1:
        blocks = averaged(problem, length)
        holds_most = blocks.n_samples >= LEAST_WHOLE_BLOCKS * problem.n_samples / length
        if holds_most and _steps(blocks, z) <= WORTHWHILE * _steps(problem, z):
            return blocks
    return None


def _show_the_motion(windows: Problem, whole: Problem, z: Array) -> bool:
    """Whether windows hold the range of the input, and last long against the motion at a start."""
    ranges = [
        (
            min(float(s.input.min()) for s in p.segments),
            max(float(s.input.max()) for s in p.segments),
        )
        for p in (windows, whole)
    ]
    (low, high), (lowest, highest) = ranges
    if high - low < COVERED * (highest - lowest):
        return False
    values = whole.values(z)
    shortest_s = min(float(s.time_s[-1] - s.time_s[0]) for s in windows.segments)
    levels = np.linspace(low, high, TIME_LEVELS).tolist()
    settling = (whole.model.speeds(values, level).time_constant_s for level in levels)
    times_s = [time_s for time_s in settling if time_s is not None]
    return bool(times_s) and LASTING * max(times_s) <= shortest_s


def warm_start(objective: Objective, start: Array, problem: Problem, evaluations: int) -> WarmStart:
    """The warm start that a rough problem gives from a start.

    Parameters
    ----------
    objective
        That of the whole problem.
    start
        Its unknowns.
    problem
        From `rough_problem`.
    evaluations
        Limit of evaluations.
    """
    whole, rough = objective.problem, Objective(problem, objective.sigma)
    begin = start
    if isinstance(problem, PiecewiseProblem):
        values = whole.values(start)
        look = rough(problem.free_unknowns(values))
        if not (isinstance(look, Linearised) and look.affine):
            look = rough(problem.started(values))
        begin = problem.with_best_states(look)
    found = rough.solve(begin, evaluations, tolerance=ROUGH_TOLERANCE)
    objective.evaluations += rough.evaluations
    if not np.isfinite(found.normal.cost):
        return WarmStart(start, start)
    damping = found.damping
    if damping is not None:
        damping *= whole.n_samples / max(problem.n_samples, 1)
    if not isinstance(problem, PiecewiseProblem):
        return WarmStart(start, found.point, damping, found.normal.cost)
    point = whole.unknowns(problem.values(found.point), with_zeros=False)
    is_white = at_noise_level(problem, found)
    return WarmStart(start, point, damping, found.normal.cost, is_white)


def warm_starts(
    objective: Objective, starts: Sequence[Array], problem: Problem, evaluations: int
) -> list[WarmStart]:
    """Warm starts from the first starts by windows, the best first; none without windows.

    All but those that follow one which explains its windows down to white noise. Over all samples,
    the way from a false optimum of the first would be long.

    Parameters
    ----------
    objective, problem, evaluations
        As in `warm_start`.
    starts
        Unknowns of the whole problem.
    """
    if not isinstance(problem, PiecewiseProblem):
        return []

    def run(start: Array) -> tuple[WarmStart, int]:
        own = Objective(objective.problem, objective.sigma)
        return warm_start(own, start, problem, evaluations), own.evaluations

    rows = [run(starts[0])]
    while len(rows) < len(starts) and not any(warm.is_white for warm, _ in rows):
        rows += in_parallel(run, starts[len(rows) :][:AT_A_TIME], small=True)
    objective.evaluations += sum(spent for _, spent in rows)
    found = [warm for warm, _ in rows]
    return sorted(found, key=lambda warm: warm.cost)


def _steps(problem: Problem, z: Array) -> int:
    plans = zip(problem.plans(z), problem.segments, strict=True)
    return sum(s.time_s.size if plan is None else int(plan.counts.sum()) for plan, s in plans)


def thinning(problem: Problem) -> int:
    """Samples in a block of averages; 1 where the problem is small or its segments are short."""
    shortest = min((s.time_s.size for s in problem.segments), default=0)
    return max(1, min(problem.n_samples // KEPT_RESIDUALS, shortest // LEAST_BLOCKS, LONGEST_BLOCK))


def _averaged(segment: Segment, length: int) -> Segment:
    """Block means; a block counts when all of its samples do."""
    count = segment.time_s.size // length

    def means(values: Array) -> Array:
        averages: Array = values[: count * length].reshape(count, length).mean(axis=1)
        return averages

    def whole(used: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
        every = np.all(used[: count * length].reshape(count, length), axis=1)
        return np.asarray(every, np.bool_)

    return replace(
        segment,
        time_s=means(segment.time_s),
        input=means(segment.input),
        outputs={name: means(y) for name, y in segment.outputs.items()},
        used={name: whole(used) for name, used in segment.used.items()},
    )
