"""What an input does between its samples, decided by what fits better."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from softid.channels import is_command
from softid.errors import Issue
from softid.fitters.objective import SCOUT_EVALUATIONS, Objective
from softid.fitters.output_error import Optimum, draft_fit
from softid.fitters.problem import Problem
from softid.identification.liveliest_part import LiveliestPart, promised
from softid.identification.log_beginning import beginning
from softid.intersample import HELD, Intersample, jumps, knots
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]

HELD_INPUT = "held-input"
"""Code of the remark that an input is taken as held."""

SMOOTH_INPUT = "smooth-input"
"""Code of the remark that an input is taken as smooth."""

BEHAVIOUR_WORDS: Mapping[Intersample, str] = {
    "straight": "going straight from sample to sample",
    "smooth": "going smoothly from sample to sample",
    "held": "held where it jumps",
    "zoh": "held at every sample",
}
"""What an input may do, as the texts say it."""

BETTER_BY = 10.0
"""n·ln(mean square) must fall by this much: both ways have the same number of unknowns."""

LONG = 100_000
"""Where the logs have more samples, beginnings of together so many are looked at: how an input is
recorded does not change."""

FIRST_EVALUATIONS = 2
"""Evaluations before the promise of the normal equations is asked."""


def held_choices(logs: Iterable[Log]) -> tuple[Intersample, ...]:
    """In which ways the input may have been held; none where that is settled or no matter.

    At its jumps, if it has any, and a command or an input that jumps at every sample.

    Parameters
    ----------
    logs
        Logs to fit.
    """
    open_ones = [log for log in logs if log.intersample is None]
    if any(jumps(log.channels[log.input].values).size for log in open_ones):
        return HELD
    return ("zoh",) if any(is_command(log.input) for log in open_ones) else ()


def is_smooth(logs: Iterable[Log]) -> bool:
    """Whether a measured input may be smooth where straight lines would cut it short.

    Parameters
    ----------
    logs
        Logs to fit.
    """
    open_ones = [log for log in logs if log.intersample is None and not is_command(log.input)]
    segments = (segment for log in open_ones for segment in log.segments())
    return any(knots(s.time_s, s.input, "smooth")[0].size for s in segments)


def choices_of(logs: Iterable[Log]) -> tuple[Intersample, ...]:
    """What the inputs may do between their samples, whatever was declared; what bends is smooth."""
    opened = [replace(log.as_recorded, intersample=None) for log in logs]
    plain: tuple[Intersample, ...] = ("straight", "smooth") if is_smooth(opened) else ("straight",)
    return (*plain, *held_choices(opened))


def choice_unless_held(logs: Iterable[Log]) -> Intersample:
    """What a measured input does as long as nothing tells otherwise."""
    return "smooth" if "smooth" in choices_of(logs) else "straight"


def as_smooth(logs: Sequence[Log]) -> tuple[Log, ...]:
    """The logs with an input that is smooth where it bends, if it does so anywhere.

    That is what a gauge reads of a pressure which nothing holds. Behind a valve that takes a few
    samples straight lines come early: each step by h²/12 of the change of its slope.

    Parameters
    ----------
    logs
        Logs to fit; the input of those that say what it does between samples stays as it is.
    """
    if not is_smooth(logs):
        return tuple(logs)
    return tuple(log.with_intersample("smooth") for log in logs)


def with_bends_told(logs: LogSet) -> LogSet:
    """Logs whose smooth input explains clearly more than straight lines, with the remark so.

    Parameters
    ----------
    logs
        Logs that are fitted with it.
    """
    first, *others = logs
    issue = Issue(
        SMOOTH_INPUT,
        "info",
        f"{first.input} swings within a few samples; smooth between them it explains the output "
        "better than as straight lines, and is taken so",
        "record it faster, or declare it with --intersample straight (with_intersample of the log "
        "in Python)",
    )
    return LogSet((replace(first, issues=(*first.issues, issue)), *others))


def as_held(logs: Sequence[Log], intersample: Intersample) -> tuple[Log, ...]:
    """The logs with an input that is held, and the remark that says so.

    Parameters
    ----------
    logs
        Logs to fit; the input of those that say what it does between samples stays as it is.
    intersample
        Where it is held.
    """
    first = logs[0]
    what = "is held at every sample" if intersample == "zoh" else "jumps within single samples"
    issue = Issue(
        HELD_INPUT,
        "info",
        f"{first.input} {what}; held until the next sample it explains the output better than as "
        "straight lines between samples, and is taken so",
        "if it is not a command, record it faster, or declare it with --intersample straight "
        "(with_intersample of the log in Python)",
    )
    changed = [log.with_intersample(intersample) for log in logs]
    return (replace(changed[0], issues=(*changed[0].issues, issue)), *changed[1:])


@dataclass(frozen=True, eq=False)
class Explained:
    """What a fit leaves over in as much of its logs as tells what an input does between samples.

    Attributes
    ----------
    problem, optimum
        The fit.
    """

    problem: Problem
    optimum: Optimum

    @cached_property
    def part(self) -> LiveliestPart | None:
        """The same of the part that is looked at first."""
        return LiveliestPart.of(self.problem, self.optimum.unknowns)

    @cached_property
    def enough(self) -> tuple[Problem, Array, float]:
        """Problem, unknowns and n·ln(mean square) there; of long logs, at the optimum over a part.

        Of shape (U,) each.
        """
        problem, optimum = self.problem, self.optimum
        cut = _long_enough(problem.logs)
        if cut == tuple(problem.logs):
            return problem, optimum.unknowns, _misfit(problem, optimum)
        part = Problem(problem.model, problem.parameters, cut)
        start = part.unknowns(problem.values(optimum.unknowns))
        there = Objective(part, optimum.sigma).solve(start, SCOUT_EVALUATIONS)
        return part, there.point, misfit_of(part, there.point)


def _long_enough(logs: Sequence[Log]) -> tuple[Log, ...]:
    return tuple(beginning(log, LONG // len(logs)) for log in logs)


def explains_better(own: Explained, other: LogSet, by: float = BETTER_BY) -> bool:
    """Whether a model explains other logs better than its own, of as many samples.

    A look at a part of long logs often settles it, or a step from the optimum of its own logs:
    where more than what the normal equations promise beyond would not do, no search is made.

    Parameters
    ----------
    own
        A fit; the search for the other one begins at its optimum.
    other
        The logs with another input.
    by
        n·ln(mean square) must fall by more than this.
    """
    if own.part is not None and own.part.rules_out(other):
        return False
    problem, unknowns, misfit = own.enough
    logs = [replace(log) for log in _long_enough(other.logs)]  # copies take their cuts along
    changed = Problem(problem.model, problem.parameters, logs)
    wanted = misfit - by
    if changed.at_rest == problem.at_rest and len(problem.outputs) == 1:
        looking = Objective(changed, dict.fromkeys(problem.outputs, 1.0))
        there = looking.solve(unknowns, FIRST_EVALUATIONS, accelerates=False).normal
        if np.isfinite(there.cost) and promised(there) > wanted:
            return False
    values = problem.values(unknowns)
    found = draft_fit(changed, [values], far=False)
    return bool(np.isfinite(found.cost)) and _misfit(changed, found) < wanted


def misfit_of(problem: Problem, unknowns: Array) -> float:
    """n·ln(mean square) of the residuals, summed over all channels.

    Parameters
    ----------
    problem
        Model and logs.
    unknowns
        Shape (U,).
    """
    blocks = problem.blocks(unknowns, derivatives=False)
    squares = [(b.channel, (float(b.residual @ b.residual), b.residual.size)) for b in blocks]
    return _summed(problem, squares)


def _misfit(problem: Problem, optimum: Optimum) -> float:
    """n·ln(mean square) over all channels, of the residuals that an optimum may hold."""
    known = optimum.linearised
    if known is None and len(problem.outputs) == 1:
        (name,) = problem.outputs
        squares = 2.0 * optimum.cost * optimum.sigma[name] ** 2
        return _summed(problem, [(name, (squares, problem.n_samples))])
    if known is None:
        return misfit_of(problem, optimum.unknowns)
    return _summed(problem, [(piece.channel, piece.squares) for piece in known.pieces])


def _summed(problem: Problem, sums: Sequence[tuple[str, tuple[float, int]]]) -> float:
    total = 0.0
    for name in problem.outputs:
        squares, n = np.sum([own for channel, own in sums if channel == name], axis=0).tolist()
        total += n * float(np.log(squares / n + np.finfo(float).tiny))
    return total
