"""Profile of one parameter: what it costs to move it while the others follow."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from softid.plots.canvas import (
    BOTTOM,
    FAINT,
    INK,
    LEFT,
    PALE,
    RIGHT,
    SIMULATED,
    TOP_BELOW_TWO,
    Display,
    add_panel,
    finish,
    new_figure,
)
from softid.sentences import listed

Array = npt.NDArray[np.float64]

HIGHEST = 3.0
"""The plot ends at this many thresholds."""

POINTS_BETWEEN = 16
"""Points of the curve from one point of the profile to the next."""

LOG_RATIO = 10.0
"""Positive values that span more than this factor get a logarithmic axis."""


def draw_profile(
    values: Array,
    cost_rise: Array,
    *,
    name: str,
    unit: str,
    threshold: float,
    estimate: float | None = None,
    ci95: tuple[float | None, float | None] | None = None,
) -> Figure:
    """Draw the points of a profile with the threshold of its 95 % interval.

    Parameters
    ----------
    values
        Values of the parameter, rising, shape (m,).
    cost_rise
        Rise of the cost above the optimum at each, infinite where no fit was found, shape (m,).
    name, unit
        The parameter.
    threshold
        Rise at the limits of the interval.
    estimate
        The fitted value.
    ci95
        Limits of the interval, None on a side that has no end.

    Returns
    -------
    Figure
    """
    figure = new_figure()
    axes = add_panel(
        figure,
        (LEFT, BOTTOM, RIGHT, TOP_BELOW_TWO),
        x_label=Display(name, unit).label,
        y_label="rise of the cost",
    )
    there = np.isfinite(values) & np.isfinite(cost_rise)
    tried, rise = values[there], cost_rise[there]
    logarithmic = bool(tried.size and tried.min() > 0 and np.ptp(np.log(tried)) > np.log(LOG_RATIO))
    if logarithmic:
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(numticks=8))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.plot(tried, rise, color=SIMULATED, ls="none", marker="o", ms=5.5, zorder=3)
    axes.plot(*_between(tried, rise, logarithmic=logarithmic), color=SIMULATED, lw=1.6, zorder=3)
    handles: list[Artist] = [
        Line2D([], [], color=SIMULATED, lw=1.6, marker="o", ms=5.5, label="others refitted")
    ]
    handles.append(
        axes.axhline(threshold, color=INK, lw=1.2, ls=(0, (5, 3)), label="95 % threshold")
    )
    if estimate is not None:
        handles.append(axes.axvline(estimate, color=INK, lw=1.0, ls=(0, (1, 2)), label="estimate"))
    axes.set_ylim(-0.05 * threshold, HIGHEST * threshold)
    if ci95 is not None:
        left, right = axes.get_xlim()
        axes.axvspan(
            left if ci95[0] is None else ci95[0],
            right if ci95[1] is None else ci95[1],
            color=PALE,
            lw=0,
            zorder=0,
        )
        axes.set_xlim(left, right)
        handles.append(Patch(facecolor=PALE, edgecolor=FAINT, label="95 % interval"))
        open_sides = [w for w, end in zip(("below", "above"), ci95, strict=True) if end is None]
        if open_sides:
            remark = f"open {listed(open_sides)}: the logs set no limit there"
            handles.append(Line2D([], [], ls="none", label=remark))
    finish(figure, f"Profile of {name}", handles, rows=2)
    return figure


def _between(values: Array, rise: Array, *, logarithmic: bool) -> tuple[Array, Array]:
    """The curve through the points of a profile.

    The root of the rise, negative before the least point, is straight for a parabola and nearly so
    for any other valley.
    """
    if values.size < 2:
        return values, rise
    at = np.log(values) if logarithmic else values
    root = np.sqrt(np.maximum(rise, 0.0))
    root[: int(np.argmin(rise))] *= -1.0
    shares = np.linspace(0.0, 1.0, POINTS_BETWEEN, endpoint=False)
    fine = np.append((at[:-1, None] + shares * np.diff(at)[:, None]).ravel(), at[-1])
    curve = np.interp(fine, at, root) ** 2
    return (np.exp(fine) if logarithmic else fine), curve
