"""Damping against pressure, with its band."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
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
    TOP,
    Display,
    add_panel,
    finish,
    new_figure,
)
from softid.plots.static_curve import draw_split_curve

Array = npt.NDArray[np.float64]

TALLEST = 1.3
"""Height of a plot in units of the largest value in the fitted range."""

WIDE_BAND, WIDEST_BAND, FEW_DECADES = 5.0, 1e3, 200.0
"""From the first ratio of its limits on a band needs a logarithmic axis; the second is cut off."""

_BAND = "#d3d3d3"
_ENDLESS = 1e9


def draw_damping(
    pressure_kpa: Array,
    damping: Array,
    band: tuple[Array, Array] | None,
    *,
    fitted_range_kpa: tuple[float, float],
    unit: str,
    pressure: Display | None = None,
    title: str = "Damping N(p)",
) -> Figure:
    """Draw damping against pressure with its 95 % band.

    Parameters
    ----------
    pressure_kpa
        Pressures, shape (g,), rising.
    damping
        N at each, in ``unit``, shape (g,).
    band
        Lower and upper limit at each, or None when it is not known.
    fitted_range_kpa
        Pressures that the fitted logs reached: solid inside, dashed beyond.
    unit
        Of the damping.
    pressure
        How the pressure axis is shown; kPa by default.
    title
        Heading.

    Returns
    -------
    Figure
    """
    shown = pressure or Display("pressure", "kPa")
    figure = new_figure()
    axes = add_panel(
        figure,
        (LEFT, BOTTOM, RIGHT, TOP),
        x_label=shown.label,
        y_label=Display("damping N", unit).label,
        y_ticks=7,
    )
    x = pressure_kpa * shown.factor
    low, high = fitted_range_kpa
    inside = (pressure_kpa >= low) & (pressure_kpa <= high)
    handles: list[Artist] = [Patch(facecolor=PALE, edgecolor=FAINT, label="fitted range")]
    axes.axvspan(low * shown.factor, high * shown.factor, color=PALE, lw=0, zorder=0)
    handles[:0] = draw_split_curve(axes, x, damping, inside, label="N(p)")
    axes.set_xlim(x[0], x[-1])
    if band is None:
        axes.set_ylim(0.0, TALLEST * float(np.nanmax(damping[inside])))
        handles.append(
            Line2D([], [], ls="none", label="no band: N is not determined by these logs")
        )
    else:
        # A limit that overflowed to infinity would not be drawn at all.
        lower = np.maximum(band[0], damping / _ENDLESS)
        upper = np.minimum(band[1], damping * _ENDLESS)
        axes.fill_between(x, lower, upper, color=_BAND, lw=0, zorder=1)
        for edge in (lower, upper):
            axes.plot(x, edge, color=INK, lw=0.8, ls=(0, (1, 2)), zorder=2)
        cut = _set_limits(axes, damping[inside], lower[inside], upper[inside])
        label = "95 % band, wider than the plot" if cut else "95 % band"
        handles.append(Patch(facecolor=_BAND, edgecolor=INK, ls=":", label=label))
    finish(figure, title, handles)
    return figure


def _set_limits(axes: Axes, damping: Array, lower: Array, upper: Array) -> bool:
    """Hold N and its band in the fitted range, on a logarithmic axis where the band is wide.

    Returns whether the band leaves the plot all the same.
    """
    if float(np.nanmax(upper / lower)) <= WIDE_BAND:
        axes.set_ylim(0.0, TALLEST * float(np.nanmax(upper)))
        return False
    axes.set_yscale("log")
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    low = max(float(np.nanmin(lower)), float(np.nanmin(damping)) / WIDEST_BAND)
    high = min(float(np.nanmax(upper)), float(np.nanmax(damping)) * WIDEST_BAND)
    axes.set_ylim(low / TALLEST, high * TALLEST)
    fine = (1.0, 2.0, 5.0) if high < FEW_DECADES * low else (1.0,)
    axes.yaxis.set_major_locator(LogLocator(subs=fine, numticks=9))
    return bool(np.nanmin(lower) < low or np.nanmax(upper) > high)
