"""What the rounding of the recorded channels makes of what is left.

While a slow input stays between two steps of its converter, what is recorded of it is off by as
much as half a step, and the actuator follows what was not recorded: no law explains that.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.coarse_sampling import COARSE_SAMPLING
from softid.diagnosis.report.phrases import percent
from softid.diagnosis.residual.motion import simulated
from softid.diagnosis_results import Diagnosis, Remainder, Verdict
from softid.errors import Issue
from softid.excitation import find_quantisation
from softid.identification.gauge_errors import NO_ERRORS, GaugeErrors
from softid.log import Log
from softid.results import FitResult

Array = npt.NDArray[np.float64]

TOLD_SHARE = 0.25
"""Share of the power of what is left from which on a rounding is told."""

MET_AGAIN = 3.0
"""Samples at the usual level of an input that is rounded, at least. A ramp, up and down, passes its
values once each, as evenly apart as its slope is constant."""

COARSE_INPUT = "coarse-input"
"""Code of the remark that the input is rounded coarsely."""

OF_RECORDED_INPUT = (COARSE_INPUT, COARSE_SAMPLING)
"""Codes of the remarks that the record of the input is too coarse for what is left."""

SEED = 0
"""Seed of the draws of what the rounding took away, which nobody knows."""


def with_rounding(
    answer: Diagnosis, logs: Iterable[Log], base: Candidate, gauges: Mapping[str, GaugeErrors]
) -> Diagnosis:
    """The diagnosis with remarks on the rounding of both, the input's before any other experiment.

    Parameters
    ----------
    answer
        The diagnosis.
    logs
        The logs as recorded.
    base
        The base fit to them.
    gauges
        Log → errors of its input: the levels of a command lie as far apart as they were set, and
        nothing is rounded.
    """
    told = input_rounding_issues(base, answer.remainder, gauges)
    rest = answer.remainder.rms
    issues = (*answer.issues, *told, *rounding_issues(logs, answer.base, rest))
    first = told[0].remedy if told and answer.verdict is Verdict.UNKNOWN else None
    return replace(answer, issues=issues, next_experiment=first or answer.next_experiment)


def rounding_issues(logs: Iterable[Log], base: FitResult, rms: float) -> tuple[Issue, ...]:
    """A remark for every log whose first output is rounded so coarsely that it makes what is left.

    Parameters
    ----------
    logs
        The logs as recorded.
    base
        The fit that knows in which unit people know the output.
    rms
        What the last model leaves, in the unit of the channel.
    """
    first = base.outputs[0]
    row = next((r for r in base.statistics if r.channel == first), None)
    unit, factor = (row.display_unit, row.display_factor) if row else ("", 1.0)
    found = []
    for log in logs:
        grid = find_quantisation(log.channels[first].values) if first in log.channels else None
        share = grid.step**2 / 12.0 / rms**2 if grid is not None and rms > 0.0 else 0.0
        if grid is not None and share > TOLD_SHARE:
            found.append(
                Issue(
                    "coarse-quantisation",
                    "info",
                    f"{log.name}: {first} is recorded in steps of {grid.step * factor:.3g} {unit}, "
                    f"whose rounding is {percent(min(share, 1.0))} of the power of what is left",
                    "record it with more digits, or with a finer converter",
                )
            )
    return tuple(found)


def input_rounding_issues(
    final: Candidate, remainder: Remainder, gauges: Mapping[str, GaugeErrors]
) -> tuple[Issue, ...]:
    """A remark where the rounding of the input makes a fair part of what is left.

    Between two changes of the recorded input all that was rounded is taken as one number, anywhere
    within half a step; a simulation tells what that does to the first output.

    Parameters
    ----------
    final
        The last model.
    remainder
        What it leaves.
    gauges
        As in `with_rounding`.
    """
    problem = final.problem
    name, first = problem.logs[0].input, problem.outputs[0]
    channel = problem.logs[0].channels[name]
    values = np.concatenate([log.channels[name].values for log in problem.logs])
    step = max(gauges.get(log.name, NO_ERRORS).step for log in problem.logs)
    if not (step > 0.0 and remainder.leaves_something and remainder.rms > 0.0):
        return ()
    if np.median(np.unique(values, return_counts=True)[1]) < MET_AGAIN:
        return ()
    moved = [_moved_by_rounding(final, k, step) for k in range(len(problem.segments))]
    rms = float(np.sqrt(np.mean(np.concatenate(moved) ** 2)))
    share = rms**2 / remainder.rms**2
    if share < TOLD_SHARE:
        return ()
    output = problem.logs[0].channels[first]
    return (
        Issue(
            COARSE_INPUT,
            "warning",
            f"{name} is recorded in steps of {step * channel.display_factor:.3g} "
            f"{channel.display_unit}; that rounding by itself moves the simulated {first} by "
            f"{rms * output.display_factor:.3g} {output.display_unit} rms, "
            f"{percent(min(share, 1.0))} of the power of what is left",
            f"record {name} with a finer converter, or in more digits, before looking for a cause",
        ),
    )


def _moved_by_rounding(final: Candidate, k: int, step: float) -> Array:
    """Change of the first output of one segment with a draw of what was rounded."""
    segment = final.problem.segments[k]
    stay = np.cumsum(np.diff(segment.input, prepend=segment.input[0]) != 0.0)
    lost = np.random.default_rng((SEED, k)).uniform(-0.5 * step, 0.5 * step, int(stay[-1]) + 1)
    moved = replace(segment, input=segment.input + lost[stay])
    return simulated(final, k, moved) - simulated(final, k, segment)
