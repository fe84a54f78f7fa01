"""That the record of the input ends where its gauge does, and nobody knows what it did beyond."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from softid.diagnosis.report.phrases import percent
from softid.diagnosis_results import Diagnosis, Verdict
from softid.errors import Issue
from softid.log import Log
from softid.quality import inspect

CLIPPED_INPUT = "clipped-input"
"""Code of the remark that the input is recorded at its largest value again and again."""

SETTLED = (Verdict.ADEQUATE, Verdict.NAMED)
"""Verdicts that leave nothing which an unknown input would have to explain."""


def with_clipped_input(answer: Diagnosis, logs: Iterable[Log]) -> Diagnosis:
    """The diagnosis with a remark for every log whose input saturates; the first says what to do.

    Parameters
    ----------
    answer
        The diagnosis.
    logs
        The logs as recorded.
    """
    if answer.verdict in SETTLED:
        return answer
    told = [issue for log in logs for issue in clipped_input_issues(log)]
    first = told[0].remedy if told and answer.verdict is Verdict.UNKNOWN else None
    return replace(
        answer,
        issues=(*answer.issues, *told),
        next_experiment=first or answer.next_experiment,
    )


def clipped_input_issues(log: Log) -> tuple[Issue, ...]:
    """A remark where noise stops at the largest value of the input, as at the end of a gauge.

    A gauge that ends at zero is none: a vented actuator rests there.

    Parameters
    ----------
    log
        The log as recorded.
    """
    found = inspect(log)
    return tuple(
        Issue(
            CLIPPED_INPUT,
            "warning",
            f"{log.name}: {channel.name} stands at exactly {flat.value:.4g} {channel.display_unit} "
            f"in {percent(flat.share)} of the samples, for the first time at {flat.first_s:.4g} s, "
            "without its noise: what it did beyond is not on record, and the actuator follows that",
            f"record {channel.name} with a gauge of a larger range, or diagnose a log that stays "
            "below it",
        )
        for channel in found.channels
        if channel.role == "input"
        for flat in channel.saturation
        if flat.side == "high"
    )
