"""Several curves and point sets on one pair of axes, told apart without colour."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from softid.plots.canvas import (
    BOTTOM,
    BY_ORDER,
    LEFT,
    RIGHT,
    TOP,
    TOP_BELOW_TWO,
    Display,
    add_panel,
    finish,
    new_figure,
)
from softid.plots.traces import padded_limits

Array = npt.NDArray[np.float64]

_MARKERS = ("o", "s", "^", "x")
_IN_ONE_ROW = 3


@dataclass(frozen=True, eq=False)
class Series:
    """One curve or set of points.

    Attributes
    ----------
    label
        For the legend.
    x, y
        Shape (n,).
    points
        Drawn as points instead of a line.
    """

    label: str
    x: npt.ArrayLike
    y: npt.ArrayLike
    points: bool = False


def draw_series(
    series: Sequence[Series],
    *,
    x: Display,
    y: Display,
    title: str,
    log_y: bool = False,
    from_zero: bool = False,
    vertical: Sequence[float] = (),
) -> Figure:
    """Draw curves and points, each in a style of its own.

    Parameters
    ----------
    series
        What to draw, up to four curves and four sets of points.
    x, y
        How the axes are shown.
    title
        Heading.
    log_y
        Whether the y axis is logarithmic.
    from_zero
        Whether the y axis starts at zero.
    vertical
        Places of thin vertical lines, in the unit of the arrays.

    Returns
    -------
    Figure
    """
    figure = new_figure()
    rows = 1 if len(series) <= _IN_ONE_ROW else 2
    top = TOP if rows == 1 else TOP_BELOW_TWO
    axes = add_panel(
        figure, (LEFT, BOTTOM, RIGHT, top), x_label=x.label, y_label=y.label, y_ticks=7
    )
    if log_y:
        axes.set_yscale("log")
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    handles = []
    counts = {True: 0, False: 0}
    for one in series:
        colour, dashes = BY_ORDER[counts[one.points] % len(BY_ORDER)]
        marker = _MARKERS[counts[one.points] % len(_MARKERS)]
        counts[one.points] += 1
        shown = np.asarray(one.x) * x.factor, np.asarray(one.y) * y.factor
        if one.points:
            handles += axes.plot(
                *shown,
                ls="none",
                marker=marker,
                ms=8,
                mfc="white",
                mec=colour,
                mew=1.8,
                zorder=4,
                label=one.label,
            )
        else:
            handles += axes.plot(*shown, color=colour, ls=dashes, lw=2.0, label=one.label)
    for place in vertical:
        axes.axvline(place * x.factor, color="#7a7a7a", lw=1.0, ls=(0, (1.5, 2.5)), zorder=1)
    limits = padded_limits(*(np.asarray(s.x, float) * x.factor for s in series), margin=0.03)
    if limits:
        axes.set_xlim(*limits)
    if from_zero:
        axes.set_ylim(bottom=0.0)
    finish(figure, title, handles, rows=rows)
    return figure
