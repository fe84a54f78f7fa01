"""Measured against simulated over time, with the input above and the residual below."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from softid.plots.canvas import (
    ACCENT,
    BOTTOM,
    FAINT,
    INK,
    LEFT,
    MEASURED,
    PALE,
    RIGHT,
    SIMULATED,
    TOP,
    Display,
    add_note,
    add_panel,
    finish,
    new_figure,
    shortened,
)
from softid.plots.traces import broken_trace, decimate, padded_limits
from softid.results import FitStatistics, Simulation

Array = npt.NDArray[np.float64]

RUNAWAY_SPANS = 1.0
"""A simulation may widen the plot by this many spans of the measurement to either side."""

EDGES = (0.755, 0.735, 0.345, 0.31)
"""Lower edge of the input, upper and lower edge of the output, upper edge of the residual."""

HELD_OUT_DASHES = (0, (9, 2))

SPIKE_RATIO, SPIKE_QUANTILE = 5.0, 0.99
"""A residual this far beyond its quantile is a spike, which may not flatten the rest."""


def draw_response(
    simulation: Simulation,
    statistics: FitStatistics,
    *,
    fitted_range: tuple[float, float] | None = None,
) -> Figure:
    """Draw one output of one log: input, measured and simulated, residual.

    Lines break at stalls, which are hatched. The simulation of a held-out log is dashed. A
    simulation that runs away is cut where it would flatten the measurement, and the legend says so.

    Parameters
    ----------
    simulation
        The response with its measured counterpart.
    statistics
        Score of the same log and channel; names the channel and its display unit.
    fitted_range
        Smallest and largest input of the fitted logs, in the input's unit; shaded behind the
        input of a held-out log.

    Returns
    -------
    Figure
    """
    shown = Display(statistics.channel, statistics.display_unit, statistics.display_factor)
    figure = new_figure()
    top, main, below = add_response_panels(figure, simulation, shown, EDGES)
    handles: list[Artist] = []
    handles += _draw_input(top, simulation, None if statistics.in_sample else fitted_range)
    handles[:0] = _draw_outputs(main, simulation, statistics, shown)
    _draw_residual(below, simulation, shown)
    handles += _mark_stalls((top, main, below), simulation)
    finish(figure, response_title(statistics), handles)
    return figure


def add_response_panels(
    figure: Figure, simulation: Simulation, shown: Display, edges: tuple[float, float, float, float]
) -> tuple[Axes, Axes, Axes]:
    """Empty panels for the input, the output and its residual, over the time of one log.

    Parameters
    ----------
    figure
        The figure to draw on.
    simulation
        Gives the input and the times.
    shown
        The output.
    edges
        As `EDGES`, shares of the figure.
    """
    below_input, above_output, below_output, above_residual = edges
    top = add_panel(
        figure,
        (LEFT, below_input, RIGHT, TOP),
        y_label=Display(simulation.input_name, simulation.input_unit).two_lines,
        y_ticks=3,
    )
    output = (LEFT, below_output, RIGHT, above_output)
    main = add_panel(figure, output, y_label=shown.label, share_x=top)
    below = add_panel(
        figure,
        (LEFT, BOTTOM, RIGHT, above_residual),
        x_label="time (s)",
        y_label=shown.named("residual"),
        share_x=top,
        y_ticks=4,
    )
    first_s, last_s = float(simulation.time_s[0]), float(simulation.time_s[-1])
    beside_s = 0.01 * (last_s - first_s)
    top.set_xlim(first_s - beside_s, last_s + beside_s)
    return top, main, below


def response_title(statistics: FitStatistics) -> str:
    """Log, whether it was fitted, and how well the simulation follows it."""
    role = "fitted" if statistics.in_sample else "held out"
    rmse = statistics.rmse * statistics.display_factor
    unit = "" if statistics.display_unit in ("", "1") else f" {statistics.display_unit}"
    return f"{shortened(statistics.log)}, {role}: fit {percent(statistics)}, rmse {rmse:.3g}{unit}"


def percent(statistics: FitStatistics) -> str:
    """The fit as text; a constant measurement has none."""
    if not np.isfinite(statistics.fit_percent):
        return "undefined (constant output)"
    return f"{statistics.fit_percent:.1f} %"


def _draw_input(
    axes: Axes, simulation: Simulation, fitted_range: tuple[float, float] | None
) -> list[Artist]:
    x, y = broken_trace(simulation.time_s, simulation.input, simulation.segment_starts)
    axes.plot(*decimate(x, y), color=INK, lw=1.2)
    if fitted_range is None:
        return []
    axes.axhspan(*fitted_range, color=PALE, lw=0, zorder=0)
    limits = padded_limits(simulation.input, np.array(fitted_range))
    if limits:
        axes.set_ylim(*limits)
    return [Patch(facecolor=PALE, edgecolor=FAINT, label="range of the fitted input")]


def _draw_outputs(
    axes: Axes, simulation: Simulation, statistics: FitStatistics, shown: Display
) -> list[Artist]:
    time_s, starts = simulation.time_s, simulation.segment_starts
    measured = simulation.measured[shown.name] * shown.factor
    simulated = simulation.outputs[shown.name] * shown.factor
    used = simulation.used[shown.name]
    handles: list[Artist] = []
    x, y = decimate(*broken_trace(time_s, measured, starts))
    handles += axes.plot(x, y, color=MEASURED, lw=3.0, solid_joinstyle="round", label="measured")
    left_out = ~used & np.isfinite(measured)
    if left_out.any():
        handles += axes.plot(
            *decimate(time_s[left_out], measured[left_out]),
            ls="none",
            marker="x",
            ms=5,
            color=ACCENT,
            label="left out of the fit",
        )
    x, y = decimate(*broken_trace(time_s, simulated, starts))
    (line,) = axes.plot(
        x,
        y,
        color=SIMULATED,
        lw=1.5,
        ls="-" if statistics.in_sample else HELD_OUT_DASHES,
        label=f"simulated, fit {percent(statistics)}",
    )
    if _limit_outputs(axes, measured, simulated):
        line.set_label(f"simulated, fit {percent(statistics)} (runs out of the plot)")
    return [*handles, line]


def _limit_outputs(axes: Axes, measured: Array, simulated: Array) -> bool:
    """Set the limits; returns whether the simulation leaves them."""
    own = padded_limits(measured)
    both = padded_limits(measured, simulated)
    if own is None or both is None:
        return False
    room = RUNAWAY_SPANS * (own[1] - own[0])
    low, high = max(both[0], own[0] - room), min(both[1], own[1] + room)
    axes.set_ylim(low, high)
    return low > both[0] or high < both[1]


def _draw_residual(axes: Axes, simulation: Simulation, shown: Display) -> None:
    residual = simulation.residual(shown.name) * shown.factor
    x, y = broken_trace(simulation.time_s, residual, simulation.segment_starts)
    axes.axhline(0.0, color=MEASURED, lw=1.0, zorder=1)
    axes.plot(*decimate(x, y), color=INK, lw=1.0)
    half, beyond = residual_reach(residual)
    axes.set_ylim(-half, half)
    if beyond:
        add_note(axes, spikes(beyond, half, shown))


def residual_reach(residual: Array) -> tuple[float, int]:
    """Half the height of a residual plot, and how many samples leave it because they are spikes."""
    size = np.abs(residual[np.isfinite(residual)])
    if size.size == 0 or size.max() == 0.0:
        return 1.0, 0
    usual = float(np.quantile(size, SPIKE_QUANTILE))
    if usual > 0.0 and size.max() > SPIKE_RATIO * usual:
        half = 2.0 * usual
        return half, int(np.count_nonzero(size > half))
    return 1.1 * float(size.max()), 0


def spikes(beyond: int, half: float, shown: Display) -> str:
    """The remark that some of the residual leaves the plot."""
    reach = f"±{half:.3g}" if shown.unit in ("", "1") else f"±{half:.3g} {shown.unit}"
    return f"{beyond} sample{'s' if beyond > 1 else ''} beyond {reach}"


def _mark_stalls(panels: tuple[Axes, ...], simulation: Simulation) -> list[Artist]:
    """Hatch the stretches between segments."""
    at = [k for k in simulation.segment_starts if k > 0]
    if not at:
        return []
    time_s = simulation.time_s
    spans = [(float(time_s[k - 1]), float(time_s[k] - time_s[k - 1])) for k in at]
    for axes in panels:
        axes.broken_barh(
            spans,
            (0.0, 1.0),
            transform=axes.get_xaxis_transform(),
            facecolor="none",
            edgecolor=FAINT,
            hatch="////",
            lw=0.0,
            zorder=0,
        )
    return [Patch(facecolor="none", edgecolor=FAINT, hatch="////", lw=0.0, label="stall")]
