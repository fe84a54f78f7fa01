"""What is left against output, speed, input and time, over what the base model left."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from softid.plots.before_after import AFTER, BEFORE, BEFORE_DASHES
from softid.plots.canvas import (
    BOTTOM,
    INK,
    LEFT,
    RIGHT,
    TOP_BELOW_TWO,
    Display,
    add_panel,
    finish,
    new_figure,
)
from softid.plots.residual_scatter import ResidualPoints, usual_limits
from softid.plots.response import residual_reach, spikes
from softid.plots.traces import thinned_points

Array = npt.NDArray[np.float64]

WINDOW_SHARE = 1.0 / 16.0
"""Width of the window of the running mean, as a share of the axis."""
FEWEST_IN_WINDOW = 10
_STATIONS = 97
_BUCKETS = 1200
_BEFORE_CLOUD, _AFTER_CLOUD = "#ecd3bf", "#8e9bb0"


def draw_what_is_left(
    before: ResidualPoints,
    after: ResidualPoints | None,
    *,
    input: Display,
    output: Display,
    title: str = "What is left",
) -> Figure:
    """Draw the residual of the extended model over that of the base in four panels.

    A running mean that leaves zero shows what the model still lacks: against the output a wrong
    static curve, against the speed friction or damping, against time drift or ageing.

    Parameters
    ----------
    before, after
        Samples of the base and of the extended model, in canonical units; ``after`` is None when
        there is no extended model.
    input, output
        How input and output are shown; the residual is in the output's unit.
    title
        Heading.

    Returns
    -------
    Figure
    """
    figure = new_figure()
    plain = output.name.replace("_", " ")
    speed = f"simulated speed ({output.unit}/s)" if output.unit not in ("", "1") else "speed (1/s)"
    labels = (
        output.named(f"simulated {plain}"),
        speed,
        input.label,
        "time since the start of the log (s)",
    )
    half, beyond = residual_reach(before.residual * output.factor)
    middle = 0.5 * (LEFT + RIGHT)
    rows = ((0.53, TOP_BELOW_TWO), (BOTTOM, 0.415))
    for k, label in enumerate(labels):
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
        _draw_panel(axes, k, before, after, input=input, output=output)
    handles = _handles(after is not None)
    if beyond:
        handles.append(Line2D([], [], ls="none", label=spikes(beyond, half, output)))
    finish(figure, title, handles, rows=2)
    return figure


def _draw_panel(
    axes: Axes,
    k: int,
    before: ResidualPoints,
    after: ResidualPoints | None,
    *,
    input: Display,
    output: Display,
) -> None:
    factor = (output.factor, output.factor, input.factor, 1.0)[k]
    looks = (
        (before, BEFORE, BEFORE_DASHES, _BEFORE_CLOUD, 2),
        (after, AFTER, "-", _AFTER_CLOUD, 3),
    )
    shown = []
    for points, colour, dashes, cloud, depth in looks:
        if points is None:
            continue
        x = (points.output, points.speed, points.input, points.time_s)[k] * factor
        y = points.residual * output.factor
        shown.append(x)
        axes.plot(
            *thinned_points(x, y, buckets=_BUCKETS),
            ls="none",
            marker=".",
            ms=3.0,
            mew=0,
            color=cloud,
            zorder=depth,
        )
        limits = usual_limits(x)
        inside = (x >= limits[0]) & (x <= limits[1]) if limits else np.ones(x.size, bool)
        where, mean = running_mean(x[inside], y[inside])
        # A pale rim keeps the line apart from the cloud when printed in grey.
        axes.plot(where, mean, color="white", lw=4.0, zorder=depth + 3)
        axes.plot(where, mean, color=colour, ls=dashes, lw=2.0, zorder=depth + 4)
    axes.axhline(0.0, color=INK, lw=0.8, zorder=5)
    limits = usual_limits(np.concatenate(shown))
    if limits:
        axes.set_xlim(*limits)


def _handles(extended: bool) -> list[Artist]:
    found: list[Artist] = []
    looks = (("base", BEFORE, BEFORE_DASHES, _BEFORE_CLOUD), ("extended", AFTER, "-", _AFTER_CLOUD))
    for name, colour, dashes, cloud in looks[: 1 + extended]:
        found += [
            Line2D([], [], ls="none", marker="o", ms=6, mew=0, color=cloud, label=f"{name} model"),
            Line2D([], [], color=colour, ls=dashes, lw=2.0, label=f"{name} model, running mean"),
        ]
    return found


def running_mean(x: Array, y: Array) -> tuple[Array, Array]:
    """Mean of ``y`` in a window that runs along ``x``.

    Parameters
    ----------
    x, y
        Points in any order, shape (n,).

    Returns
    -------
    tuple of ndarray
        Stations along ``x`` and means, each of shape (m,); NaN where the window holds too few.

    Examples
    --------
    >>> x = np.linspace(0.0, 1.0, 1000)
    >>> where, mean = running_mean(x, np.full(1000, 2.0))
    >>> bool(np.allclose(mean, 2.0))
    True
    """
    there = np.isfinite(x) & np.isfinite(y)
    x, y = x[there], y[there]
    if x.size == 0 or float(np.ptp(x)) == 0.0:
        return np.empty(0), np.empty(0)
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    where = np.linspace(x[0], x[-1], _STATIONS)
    half = 0.5 * WINDOW_SHARE * (x[-1] - x[0])
    first = np.searchsorted(x, where - half, side="left")
    last = np.searchsorted(x, where + half, side="right")
    total = np.concatenate(([0.0], np.cumsum(y)))
    count = last - first
    sums = total[last] - total[first]
    mean = np.where(count >= FEWEST_IN_WINDOW, sums / np.maximum(count, 1), np.nan)
    return where, mean
