"""Residual against what might explain it: simulated output, its speed, the input and time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from softid.plots.canvas import (
    BOTTOM,
    INK,
    LEFT,
    RIGHT,
    TOP,
    Display,
    add_panel,
    finish,
    new_figure,
)
from softid.plots.response import residual_reach, spikes
from softid.plots.traces import padded_limits, segment_spans, thinned_points
from softid.results import Simulation

Array = npt.NDArray[np.float64]

BINS = 24
FEWEST_PER_BIN = 5
FAR_OFF = 0.3
_CLOUD = "#a8a8a8"
_BUCKETS = 1500


@dataclass(frozen=True, eq=False)
class ResidualPoints:
    """The residual and its possible causes, sample by sample over all logs.

    Attributes
    ----------
    residual
        Measured minus simulated, shape (n,).
    output, speed
        Simulated output and its derivative per second.
    input
        The driving channel.
    time_s
        Time since the start of the log.
    """

    residual: Array
    output: Array
    speed: Array
    input: Array
    time_s: Array


def residual_points(simulations: Sequence[Simulation], channel: str) -> ResidualPoints:
    """Gather the used samples of several logs, in canonical units."""
    columns: list[list[Array]] = [[], [], [], [], []]
    for simulation in simulations:
        residual = simulation.residual(channel)
        output = simulation.outputs[channel]
        speed = np.full(output.size, np.nan)
        for span in segment_spans(simulation.segment_starts, output.size):
            speed[span] = np.gradient(output[span], simulation.time_s[span])
        there = np.isfinite(residual)
        since_start = simulation.time_s - simulation.time_s[0]
        for column, values in zip(
            columns, (residual, output, speed, simulation.input, since_start), strict=True
        ):
            column.append(values[there])
    return ResidualPoints(*(np.concatenate(column) for column in columns))


def draw_residual_scatter(
    points: ResidualPoints,
    *,
    input: Display,
    output: Display,
    title: str = "Residual against its possible causes",
) -> Figure:
    """Draw four clouds of the residual, each with the median in bins.

    A median that leaves zero by more than its bar shows what the model lacks: against the output a
    wrong static curve, against the speed friction or damping, against time drift or ageing.

    Parameters
    ----------
    points
        The samples, in canonical units.
    input, output
        How input and output are shown; the residual is in the output's unit.
    title
        Heading.

    Returns
    -------
    Figure
    """
    figure = new_figure()
    residual = points.residual * output.factor
    rate = "" if output.unit in ("", "1") else output.unit
    plain = output.name.replace("_", " ")
    panels = (
        (points.output * output.factor, output.named(f"simulated {plain}")),
        (points.speed * output.factor, f"simulated speed ({rate}/s)" if rate else "speed (1/s)"),
        (points.input * input.factor, input.label),
        (points.time_s, "time since the start of the log (s)"),
    )
    half, beyond = residual_reach(residual)
    handles: list[Artist] = []
    middle = 0.5 * (LEFT + RIGHT)
    rows = ((0.54, TOP), (BOTTOM, 0.425))
    for k, (x, label) in enumerate(panels):
        bottom, top = rows[k // 2]
        left, right = ((LEFT, middle - 0.015), (middle + 0.015, RIGHT))[k % 2]
        axes = add_panel(
            figure,
            (left, bottom, right, top),
            x_label=label,
            y_label=output.named("residual") if k % 2 == 0 else None,
            x_ticks=5,
        )
        axes.set_ylim(-half, half)
        drawn = _draw_cloud(axes, x, residual)
        handles = handles or drawn
    if beyond:
        handles.append(Line2D([], [], ls="none", label=spikes(beyond, half, output)))
    finish(figure, title, handles)
    return figure


def _draw_cloud(axes: Axes, x: Array, residual: Array) -> list[Artist]:
    handles: list[Artist] = []
    axes.plot(
        *thinned_points(x, residual, buckets=_BUCKETS),
        ls="none",
        marker=".",
        ms=3.5,
        mew=0,
        color=_CLOUD,
        zorder=1,
    )
    handles.append(Line2D([], [], ls="none", marker="o", ms=5, color=_CLOUD, label="sample"))
    axes.axhline(0.0, color=INK, lw=0.8, zorder=2)
    limits = usual_limits(x)
    inside = (x >= limits[0]) & (x <= limits[1]) if limits else np.ones(x.size, bool)
    centre, median, lower, upper = binned_medians(x[inside], residual[inside])
    axes.vlines(centre, lower, upper, color=INK, lw=1.2, zorder=3)
    handles += axes.plot(
        centre,
        median,
        color=INK,
        lw=1.2,
        marker="s",
        ms=4.5,
        zorder=4,
        label="median in bins, bar: middle half",
    )
    if limits:
        axes.set_xlim(*limits)
    return handles


def usual_limits(x: Array) -> tuple[float, float] | None:
    """Limits that hold all values but the last half per cent on either side when those lie far off.

    A single jump of the input gives a speed that would squeeze everything else together.
    """
    whole = padded_limits(x, margin=0.02)
    if whole is None:
        return None
    low, high = np.quantile(x[np.isfinite(x)], [0.005, 0.995]).tolist()
    room = FAR_OFF * (high - low)
    if room == 0.0:
        return whole
    return max(whole[0], low - room), min(whole[1], high + room)


def binned_medians(x: Array, y: Array) -> tuple[Array, Array, Array, Array]:
    """Median and quartiles of ``y`` in bins of equal width in ``x``.

    Returns
    -------
    tuple of ndarray
        Median ``x``, median, lower and upper quartile of ``y``, of the bins with enough samples.

    Examples
    --------
    >>> x = np.linspace(0.0, 1.0, 1000)
    >>> centre, median, _, _ = binned_medians(x, 2.0 * x)
    >>> bool(np.allclose(median, 2.0 * centre))
    True
    """
    there = np.isfinite(x) & np.isfinite(y)
    x, y = x[there], y[there]
    if x.size == 0 or float(np.ptp(x)) == 0.0:
        empty = np.empty(0)
        return empty, empty, empty, empty
    edges = np.linspace(float(x.min()), float(x.max()), BINS + 1)[1:-1]
    place = np.searchsorted(edges, x, side="right")
    order = np.argsort(place, kind="stable")
    stops = np.cumsum(np.bincount(place, minlength=BINS))[:-1]
    rows = [
        (float(np.median(a)), *np.quantile(b, [0.5, 0.25, 0.75]).tolist())
        for a, b in zip(np.split(x[order], stops), np.split(y[order], stops), strict=True)
        if a.size >= FEWEST_PER_BIN
    ]
    table = np.array(rows, dtype=np.float64).reshape(-1, 4)
    return table[:, 0], table[:, 1], table[:, 2], table[:, 3]
