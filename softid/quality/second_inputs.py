"""Channels that move like a second input, which a model of one input cannot know."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.excitation import segment_excitation
from softid.log import Log
from softid.quality.lagged_correlation import common_grid, lagged_correlations, longest_lag_s
from softid.quality.wording import first_names

Array = npt.NDArray[np.float64]

OF_RANGE = 0.25
"""Travel of another channel, in units of the input's range, from which it moves like an input; a
judgement between a leak from the input and a second drive."""

LEAST_TRAVEL = 1e-12
"""Least travel of another channel that moves like an input, in its unit, where the input itself
does not move."""

OF_ITS_OWN = 0.5
"""Share of a channel's variance that no lag makes follow the input, from which it moves on its
own. A judgement: chambers that are driven alike follow each other far closer, and the pressures of
different chambers that take turns not at all."""

SECOND_INPUT = "second-input"
"""Code of the remark that another channel moves like a second input."""


def other_inputs(log: Log, output: str) -> tuple[str, ...]:
    """Channels of the input's unit that move like an input and neither repeat it nor its command.

    Parameters
    ----------
    log
        The recording.
    output
        A channel to leave out.
    """
    given = log.channels[log.input]
    if given.unit == "1":
        return ()  # raw counts and duty cycles share it with sensors
    known = [given, *(log.channels[n] for n in ("pressure_command",) if n in log.channels)]
    least = OF_RANGE * float(np.ptp(given.values))
    found = []
    for name, channel in log.channels.items():
        copied = any(np.array_equal(channel.values, k.values, equal_nan=True) for k in known)
        if copied or name == output or channel.unit != given.unit:
            continue
        finite = channel.values[np.isfinite(channel.values)]
        if finite.size and float(np.ptp(finite)) >= max(least, LEAST_TRAVEL):
            found.append(name)
    return tuple(found)


def independent_inputs(log: Log) -> tuple[str, ...]:
    """Those of `other_inputs` of which the input does not account for half, whichever lags.

    Parameters
    ----------
    log
        The recording.
    """
    others = other_inputs(log, log.outputs[0])
    return tuple(n for n in others if n not in log.outputs and _moves_on_its_own(log, n))


def _moves_on_its_own(log: Log, name: str) -> bool:
    grid = common_grid(log, log.input, name) if _moves(log, name) else None
    if grid is None:
        return False
    step_s, given, other = grid
    lags = max(int(longest_lag_s(step_s, given) / step_s), 1)
    alike = max(
        float(np.abs(lagged_correlations(*pair, lags)).max())
        for pair in ((given, other), (other, given))
    )
    return 1.0 - alike**2 > OF_ITS_OWN


def _moves(log: Log, name: str) -> bool:
    """Whether anything of it is no rest."""
    values = log.channels[name].values
    finite = np.isfinite(values)
    stretches = segment_excitation(log.time_s[finite], values[finite])
    return any(stretch.kind != "rest" for stretch in stretches)


def second_input_issues(names: Sequence[str], driving: str) -> tuple[Issue, ...]:
    """What is to be said of channels that may drive the actuator beside the input.

    Parameters
    ----------
    names
        The channels.
    driving
        The input.
    """
    if not names:
        return ()
    return (
        Issue(
            SECOND_INPUT,
            "warning",
            f"{first_names(names)} {'moves' if len(names) == 1 else 'move'} as an input does, and "
            f"not with {driving}: a model of one input takes what that does for something else",
            "if the actuator is driven by that, too, use only logs in which it is held or moves "
            f"with {driving}",
        ),
    )
