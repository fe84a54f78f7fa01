"""One output before and after the extension: measured, both simulations, both residuals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softid.plots.canvas import (
    FAINT,
    INK,
    SIMULATED,
    Display,
    add_note,
    finish,
    new_figure,
    shortened,
)
from softid.plots.response import (
    RUNAWAY_SPANS,
    add_response_panels,
    percent,
    residual_reach,
    spikes,
)
from softid.plots.traces import broken_trace, decimate, padded_limits
from softid.results import FitStatistics, Simulation

Array = npt.NDArray[np.float64]

EDGES = (0.775, 0.755, 0.40, 0.355)
"""As those of `softid.plots.response`; the residuals of two models have more to show."""

BEFORE = "#c8641e"
AFTER = SIMULATED
"""Colour of the extended model; in grey the residual of the base is the pale one."""
BEFORE_DASHES = (0, (4, 1.5))


@dataclass(frozen=True, eq=False)
class Scored:
    """A simulation of one log with its score.

    Attributes
    ----------
    label
        What was simulated, for the legend.
    simulation, statistics
        The response, and the score of the channel that is drawn.
    """

    label: str
    simulation: Simulation
    statistics: FitStatistics


def draw_before_after(before: Scored, after: Scored | None, *, title: str | None = None) -> Figure:
    """Draw input, measured output with both simulations, and both residuals below.

    Parameters
    ----------
    before
        The base model.
    after
        The extended model on the same log and channel; None when there is none.
    title
        Heading; None for one that names the log.

    Returns
    -------
    Figure
    """
    statistics, simulation = before.statistics, before.simulation
    shown = Display(statistics.channel, statistics.display_unit, statistics.display_factor)
    figure = new_figure()
    top, main, below = add_response_panels(figure, simulation, shown, EDGES)
    top.plot(*_trace(simulation, simulation.input), color=INK, lw=1.2)
    handles = _draw_outputs(main, before, after, shown)
    _draw_residuals(below, before, after, shown)
    role = "fitted" if statistics.in_sample else "held out"
    heading = "Before and after" if after is not None else "Base model"
    finish(figure, title or f"{heading}: {shortened(statistics.log)}, {role}", handles)
    return figure


def _trace(simulation: Simulation, values: Array) -> tuple[Array, Array]:
    return decimate(*broken_trace(simulation.time_s, values, simulation.segment_starts))


def _draw_outputs(axes: Axes, before: Scored, after: Scored | None, shown: Display) -> list[Artist]:
    name, factor = shown.name, shown.factor
    measured = before.simulation.measured[name] * factor
    handles: list[Artist] = list(
        axes.plot(*_trace(before.simulation, measured), color=FAINT, lw=4.0, label="measured")
    )
    pairs = ((before, BEFORE, BEFORE_DASHES, 1.6), (after, AFTER, "-", 1.4))
    for one, colour, dashes, width in pairs:
        if one is None:
            continue
        handles += axes.plot(
            *_trace(one.simulation, one.simulation.outputs[name] * factor),
            color=colour,
            ls=dashes,
            lw=width,
            label=f"{one.label}, fit {percent(one.statistics)}",
        )
    simulated = [s.simulation.outputs[name] * factor for s in (before, after) if s is not None]
    own, whole = padded_limits(measured), padded_limits(measured, *simulated)
    if own and whole:
        room = RUNAWAY_SPANS * (own[1] - own[0])
        axes.set_ylim(max(whole[0], own[0] - room), min(whole[1], own[1] + room))
        if axes.get_ylim() != whole:
            add_note(axes, "a simulation runs out of the plot")
    return handles


def _draw_residuals(axes: Axes, before: Scored, after: Scored | None, shown: Display) -> None:
    first = before.simulation.residual(shown.name) * shown.factor
    axes.plot(*_trace(before.simulation, first), color=BEFORE, lw=1.0, zorder=2)
    if after is not None:
        second = after.simulation.residual(shown.name) * shown.factor
        axes.plot(*_trace(after.simulation, second), color=AFTER, lw=1.0, zorder=3)
    axes.axhline(0.0, color=INK, lw=0.8, zorder=4)
    half, beyond = residual_reach(first)
    axes.set_ylim(-half, half)
    if beyond:
        add_note(axes, spikes(beyond, half, shown))
