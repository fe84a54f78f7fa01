"""Outputs that move before their input does, which no actuator can do."""

from __future__ import annotations

import numpy as np

from softid.errors import Issue
from softid.log import Log
from softid.quality.lagged_correlation import (
    MOST_POINTS,
    common_grid,
    lagged_correlations,
    longest_lag_s,
)

LEADING_OUTPUT = "output-leads"
"""Code of the remark that an output leads the input."""

LEAST_CORRELATION = 0.7
"""Below this correlation with the input a lead means nothing: half of the variance is something
else. A judgement."""

LEAST_SAMPLES = 2
"""A lead of so many samples is more than where in a sampling interval each channel is read."""

LESS_LEFT = 0.85
"""An output leads where less than this share of what the best lag leaves is left at the lead: a
motion without any lag leaves as much at both."""


def lead_s(log: Log, output: str) -> float | None:
    """By how much an output clearly moves before the input, in s; None where it does not.

    Parameters
    ----------
    log
        The recording.
    output
        Name of the output channel.
    """
    grid = common_grid(log, log.input, output) if _may_lead(log, output) else None
    if grid is None:
        return None
    step_s, given, answered = grid
    least = max(int(np.ceil(LEAST_SAMPLES * log.period_s / step_s)), 1)
    lags = max(int(longest_lag_s(step_s, given) / step_s), least)
    behind, ahead = (
        np.abs(lagged_correlations(*pair, lags)) for pair in ((given, answered), (answered, given))
    )
    lead = int(ahead.argmax())
    if lead < least or ahead[lead] < LEAST_CORRELATION:
        return None
    left_behind, left_ahead = 1.0 - float(behind.max()) ** 2, 1.0 - float(ahead[lead]) ** 2
    return lead * step_s if left_ahead < LESS_LEFT * left_behind else None


def _may_lead(log: Log, output: str) -> bool:
    """Whether the samples are more alike with the output a little earlier than a little later.

    Most logs need no more than this.
    """
    given, answered = log.channels[log.input].values, log.channels[output].values
    known = np.isfinite(answered)
    if not known.all():
        given, answered = given[known], answered[known]
    shift = LEAST_SAMPLES * max(given.size // MOST_POINTS, 1)
    if given.size <= shift:
        return False
    x, y = given - given.mean(), answered - answered.mean()
    return abs(float(x[shift:] @ y[:-shift])) > abs(float(x[:-shift] @ y[shift:]))


def leading_outputs(log: Log) -> tuple[Issue, ...]:
    """What is to be said of outputs that move before the input.

    Parameters
    ----------
    log
        The recording.
    """
    found = []
    for name in log.outputs:
        ahead_s = lead_s(log, name)
        if ahead_s is not None:
            found.append(
                Issue(
                    LEADING_OUTPUT,
                    "warning",
                    f"{name} moves {ahead_s:.2g} s before {log.input} does, but an actuator "
                    "follows its input: the two channels may be exchanged, or their clocks differ",
                    "check which column is which, and name them with --channel",
                )
            )
    return tuple(found)
