"""Units of logs that were not fitted, where another one would explain them.

A header that says psi over a column in kPa makes a log that nothing explains: a search for causes
in it would go on for minutes and end with none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from softid.errors import IdentificationError, Issue
from softid.identification.assembly import held_out
from softid.identification.estimates import scores
from softid.identification.slow_outputs import SlowOutputLog
from softid.log import Log
from softid.models.base import Model
from softid.units import CHANNEL_QUANTITY, Quantity, factor_to_canonical

UNIT_SLIP = "unit-slip"
"""Code of the remark that a log seems to have a channel in another unit."""

USUAL_UNITS: Mapping[Quantity, tuple[str, ...]] = {
    "pressure": ("kPa", "bar", "psi", "MPa", "mbar", "Pa"),
    "angle": ("deg", "rad"),
    "length": ("mm", "cm", "m", "in"),
    "torque": ("N·mm", "N·m"),
    "force": ("N", "kN"),
}
"""Units in which each quantity is usually recorded."""

MISSES = 0.3
"""A log is looked into when a model misses so much of it, as a share of its output's spread."""

FAR_LESS = 0.25
"""Another unit is right when with it the model misses less than this share of what it misses with
the recorded one, and no more than `FITS`."""

FITS = 0.15
"""Share of the output's spread that a model misses at most with the right unit, or twice as much as
of what was fitted."""


def unit_slips(
    model: Model,
    values: Mapping[str, float],
    logs: Sequence[Log],
    *,
    usual: float = 0.0,
) -> tuple[Issue, ...]:
    """Logs that a model explains once the unit of their input or output is another one.

    Parameters
    ----------
    model, values
        A fitted model and its parameters.
    logs
        Logs that were not fitted.
    usual
        ‖y − ŷ‖/‖y − mean y‖ of the first output of the fitted logs.
    """
    found = []
    for log in logs:
        missed = _missed(model, values, log)
        if not missed > MISSES:
            continue
        tried = [
            (_missed(model, values, _rescaled(log, name, factor)), name, unit)
            for name in (log.input, log.outputs[0])
            for unit, factor in _others(log, name)
        ]
        best, name, unit = min(tried, default=(np.inf, "", ""))
        if best <= min(FAR_LESS * missed, max(FITS, 2.0 * usual)):
            recorded = log.channels[name].display_unit
            now = f"misses {100.0 * missed:.2g} %" if np.isfinite(missed) else "runs away"
            found.append(
                Issue(
                    UNIT_SLIP,
                    "error",
                    f"{log.name}: {name} is given in {recorded}, but the model explains this log "
                    f"only if it is in {unit}: it then misses {100.0 * best:.2g} % of its spread, "
                    f"and {now} as it stands",
                    f"correct the header, or read it with --channel {name}=COLUMN:{unit} "
                    "(channels= of softid.load)",
                )
            )
    return tuple(found)


def _others(log: Log, name: str) -> Iterator[tuple[str, float]]:
    """Other units of a channel, and what its values are to be multiplied with for each."""
    quantity = CHANNEL_QUANTITY.get(name)
    if quantity is None or quantity not in USUAL_UNITS:
        return
    given = 1.0 / abs(log.channels[name].display_factor)  # whatever sign or scale was declared
    for unit in USUAL_UNITS[quantity]:
        factor = factor_to_canonical(unit, quantity) / given
        if not np.isclose(factor, 1.0):
            yield unit, factor


def _rescaled(log: Log, name: str, factor: float) -> Log:
    channel = log.channels[name]
    channels = {**log.channels, name: replace(channel, values=factor * channel.values)}
    if isinstance(log, SlowOutputLog):
        return replace(log, channels=channels, recorded=_rescaled(log.recorded, name, factor))
    return replace(log, channels=channels)


def _missed(model: Model, values: Mapping[str, float], log: Log) -> float:
    """‖y − ŷ‖/‖y − mean y‖ of the first output; infinite where the model runs away."""
    try:
        with np.errstate(all="ignore"):
            simulations = held_out(model, values, [log]).simulations
    except IdentificationError:
        return np.inf
    missed = scores([log], simulations, in_sample=False)[0].nrmse
    return missed if np.isfinite(missed) else np.inf
