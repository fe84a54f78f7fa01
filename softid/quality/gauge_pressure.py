"""Whether an input that should be a gauge pressure looks like an absolute one, or is a vacuum."""

from __future__ import annotations

import shlex

import numpy as np

from softid.errors import Issue
from softid.log import Log

ABSOLUTE = "absolute-pressure"
"""Code of the issue that a pressure may be absolute, and not counted from that of the air."""

VACUUM = "vacuum"
"""Code of the issue that a pressure lies below that of the air."""

AMBIENT_KPA = (85.0, 106.0)
"""Pressure of the air from 1400 m up to the deepest places and highest readings."""

LEAST_SPAN_KPA = 15.0
"""Range of an input that moves an actuator, rather than holding it at one bar. A judgement."""

AT_REST = 0.05
"""Share of the range within which a log begins or ends at its lowest pressure, and above the air's
that is as good as that: noise of the gauge, or its zero."""

NEARLY_ALWAYS = 0.98
"""Share of the samples that lie no higher than the air where an actuator works by vacuum: it may be
vented with a puff."""


def absolute_pressures(log: Log) -> tuple[Issue, ...]:
    """What is to be said of a pressure that begins or ends at an atmosphere and never goes below.

    Parameters
    ----------
    log
        The recording.
    """
    channel = log.channels[log.input]
    values = channel.values[np.isfinite(channel.values)]
    if channel.unit != "kPa" or not values.size:
        return ()
    low, span = float(values.min()), float(np.ptp(values))
    vented = min(values[0], values[-1]) - low <= AT_REST * span
    if not (vented and span >= LEAST_SPAN_KPA and AMBIENT_KPA[0] <= low <= AMBIENT_KPA[1]):
        return ()
    return (
        Issue(
            ABSOLUTE,
            "info",
            f"{log.input} rests at {low:.4g} kPa and never goes below, which is one atmosphere: "
            "it may be an absolute pressure, but models and effects count from that of the air",
            "subtract the pressure of the air from the column; if the actuator is kept inflated, "
            "there is nothing to do",
        ),
    )


def is_vacuum(log: Log) -> bool:
    """Whether the input is a pressure that lies below that of the air nearly always.

    Parameters
    ----------
    log
        The recording.
    """
    channel = log.channels[log.input]
    values = channel.values[np.isfinite(channel.values)]
    if channel.unit != "kPa" or not values.size:
        return False
    low, usual, high = np.quantile(values, (0.0, NEARLY_ALWAYS, 1.0))
    return bool(high - low >= LEAST_SPAN_KPA and usual <= AT_REST * (high - low))


def vacuums(log: Log) -> tuple[Issue, ...]:
    """What is to be said of a pressure that lies below that of the air.

    Parameters
    ----------
    log
        The recording.
    """
    if not is_vacuum(log):
        return ()
    channel = log.channels[log.input]
    column = channel.column or log.input
    flag = shlex.quote(f"{log.input}={column}:-{channel.display_unit}")
    return (
        Issue(
            VACUUM,
            "warning",
            f"{log.input} lies below that of the air, down to {np.nanmin(channel.values):.4g} kPa; "
            "models count upward from it, so what they say of a vacuum is another law",
            f"give it as a vacuum, with --channel {flag} or its values negated in Python",
        ),
    )
