"""Damping against pressure, with its band."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from softid.plots.canvas import (
    BOTTOM,
    FAINT,
    INK,
    LEFT,
    PALE,
    RIGHT,
    TOP,
    Display,
    add_header,
    add_note,
    add_panel,
    new_figure,
)
from softid.plots.static_curve import draw_split_curve

Array = npt.NDArray[np.float64]

TALLEST = 4.0
"""The plot reaches this many times the largest damping in the fitted range, whatever the band."""

_BAND = "#d3d3d3"


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
    if band is not None:
        axes.fill_between(x, band[0], band[1], color=_BAND, lw=0, zorder=1)
        for edge in band:
            axes.plot(x, edge, color=INK, lw=0.8, ls=(0, (1, 2)), zorder=2)
        handles.insert(0, Patch(facecolor=_BAND, edgecolor=INK, ls=":", label="95 % band"))
    handles[:0] = draw_split_curve(axes, x, damping, inside, label="N(p)")
    axes.set_xlim(x[0], x[-1])
    known = damping[inside] if inside.any() else damping
    reach = TALLEST * float(np.nanmax(known))
    highest = float(np.nanmax(damping if band is None else band[1]))
    axes.set_ylim(0.0, min(1.05 * highest, reach))
    if band is None:
        add_note(axes, "no band: the logs do not determine every parameter of N")
    elif highest > reach:
        add_note(axes, "the band runs out of the plot: the logs do not say more")
    add_header(figure, title, handles)
    return figure
