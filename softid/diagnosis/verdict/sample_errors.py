"""Errors at the samples that were recorded, where the search ran on averages of a few of them.

An average has less noise than its samples. Its errors would promise a gain that nobody finds who
compares the extended model with the log.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.logs.decimation import AveragedLog
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOut, HeldOutBlocks, HeldOutErrors, HeldOutLogs
from softid.diagnosis_results import Diagnosis
from softid.effects import model_of
from softid.identification.assembly import held_out as simulated
from softid.identification.estimates import scores
from softid.identification.workflow import Identification
from softid.log import Log
from softid.results import FitResult, FitStatistics

BoolArray = npt.NDArray[np.bool_]


def is_averaged(logs: Sequence[Log]) -> bool:
    """Whether any of the logs holds averages."""
    return any(isinstance(log, AveragedLog) for log in logs)


def logs_at_samples(logs: Sequence[Log]) -> tuple[Log, ...]:
    """The logs, recorded ones in place of averages."""
    return tuple(log.at_samples() if isinstance(log, AveragedLog) else log for log in logs)


def candidate_at_samples(candidate: Candidate) -> Candidate:
    """The candidate over the samples of its logs, with zeros and initial states of their own."""
    logs = candidate.problem.logs
    if not is_averaged(logs):
        return candidate
    return HeldOutLogs(logs_at_samples(logs)).standing(candidate)


def held_out_at_samples(held: HeldOut) -> HeldOut:
    """What is held out, as recorded; it judges candidates that were fitted to averages.

    Parameters
    ----------
    held
        What is held out.
    """
    if isinstance(held, HeldOutLogs) and is_averaged(held.logs):
        return replace(held, logs=logs_at_samples(held.logs))
    if isinstance(held, HeldOutBlocks) and is_averaged(held.whole):
        recorded = logs_at_samples(held.whole)
        return _RecordedBlocks(recorded, tuple(map(_block_samples, held.whole, held.blocks)))
    return held


def with_sample_statistics(found: FitResult, identified: Identification) -> FitResult:
    """The fit with the scores that its parameters reach at the recorded samples.

    Parameters
    ----------
    found
        A fit.
    identified
        The logs that it was fitted to and judged by.
    """
    if not is_averaged((*identified.logs, *identified.hold_out)):
        return found
    rows: list[FitStatistics] = []
    for logs, in_sample in ((identified.logs.logs, True), (identified.hold_out, False)):
        recorded = logs_at_samples(logs)
        shown = simulated(model_of(found.model), found.values, recorded)
        unknowns = {} if in_sample else shown.unknowns
        rows += scores(recorded, shown.simulations, in_sample=in_sample, unknowns=unknowns)
    return replace(found, statistics=tuple(rows))


def with_sample_remainder(answer: Diagnosis) -> Diagnosis:
    """The diagnosis whose remainder is that of the fitted samples in its gains.

    Parameters
    ----------
    answer
        A diagnosis of averages, with gains at the recorded samples.
    """
    first = answer.base.outputs[0]
    rows = [g for g in answer.gains if not g.held_out and g.channel == first]
    power = sum(g.n * g.rmse_after**2 for g in rows) / sum(g.n for g in rows)
    return replace(answer, remainder=replace(answer.remainder, rms=float(power) ** 0.5))


class _RecordedBlocks(HeldOutBlocks):
    """Blocks of recorded logs that were fitted as averages."""

    def errors(self, candidate: Candidate) -> list[HeldOutErrors]:
        """At the recorded samples; see `HeldOut.errors`."""
        return super().errors(candidate_at_samples(candidate))


def _block_samples(log: Log, block: BoolArray) -> BoolArray:
    """Which samples of the recording were held out with a block of averages."""
    return log.marks_of_samples(block, rest=False) if isinstance(log, AveragedLog) else block
