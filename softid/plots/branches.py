"""Measured points of a static model by branch, its curve, and what is left."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from softid.excitation.motion import turning_points
from softid.plots.canvas import (
    ACCENT,
    BOTTOM,
    INK,
    LEFT,
    RIGHT,
    SIMULATED,
    TOP,
    Display,
    add_note,
    add_panel,
    finish,
    new_figure,
)
from softid.plots.response import residual_reach, spikes
from softid.plots.traces import padded_limits, thinned_points

Array = npt.NDArray[np.float64]

REVERSAL_SHARE = 0.05
FEW_POINTS = 200
_RISING = "#6a6a6a"
_BUCKETS = 600


def rising_samples(input_values: Array) -> npt.NDArray[np.bool_]:
    """Which samples lie on the way up, blind to reversals below 5 % of the range.

    Parameters
    ----------
    input_values
        Samples in the order recorded, shape (n,).

    Examples
    --------
    >>> rising_samples(np.array([0.0, 1.0, 0.99, 2.0, 1.0, 0.0])).tolist()
    [True, True, True, True, False, False]
    """
    reversal = REVERSAL_SHARE * float(np.ptp(input_values))
    turns = turning_points(input_values, reversal)
    edges = [0, *turns.tolist(), input_values.size - 1]
    swings = [float(input_values[stop] - input_values[start]) for start, stop in pairwise(edges)]
    rising = np.ones(input_values.size, bool)
    # The ends may be plateaus: the first joins the branch it leads to, the last stays on its own.
    way = next((swing > 0 for swing in swings if abs(swing) > reversal), True)
    rising[0] = way
    for (start, stop), swing in zip(pairwise(edges), swings, strict=True):
        way = swing > 0 if abs(swing) > reversal else way
        rising[start + 1 : stop + 1] = way
    return rising


def draw_branches(
    points_input: Array,
    points_output: Array,
    points_model: Array,
    rising: npt.NDArray[np.bool_],
    curve_input: Array,
    curve_output: Array,
    *,
    input: Display,
    output: Display,
    held_out: npt.NDArray[np.bool_] | None = None,
    curve_label: str = "model",
    title: str = "Static curve",
) -> Figure:
    """Draw measured points by branch with the fitted curve, and the residual below.

    Parameters
    ----------
    points_input, points_output
        Measured samples, shape (n,); NaN where not used.
    points_model
        The model at the same samples, shape (n,).
    rising
        Which samples lie on the way up, shape (n,).
    curve_input, curve_output
        The fitted curve over its range, shape (g,); it is not extrapolated.
    input, output
        How the two axes are shown.
    held_out
        Which samples were not fitted, shape (n,); by default none.
    curve_label, title
        Texts.

    Returns
    -------
    Figure
    """
    figure = new_figure()
    main = add_panel(figure, (LEFT, 0.36, RIGHT, TOP), y_label=output.label, y_ticks=7)
    below = add_panel(
        figure,
        (LEFT, BOTTOM, RIGHT, 0.33),
        x_label=input.label,
        y_label=output.named("residual"),
        share_x=main,
    )
    x = points_input * input.factor
    y = points_output * output.factor
    residual = y - points_model * output.factor
    held = np.zeros(x.size, bool) if held_out is None else held_out
    handles: list[Artist] = []
    groups = (
        (rising & ~held, "^", _RISING, "rising"),
        (~rising & ~held, "v", ACCENT, "falling"),
        (held, "x", INK, "held out"),
    )
    for chosen, marker, colour, label in groups:
        if (chosen & np.isfinite(y)).any():
            handles += _draw_points(main, x[chosen], y[chosen], marker, colour, label)
            _draw_points(below, x[chosen], residual[chosen], marker, colour, label)
    handles += main.plot(
        curve_input * input.factor,
        curve_output * output.factor,
        color=SIMULATED,
        lw=2.2,
        zorder=4,
        label=curve_label,
    )
    below.axhline(0.0, color=SIMULATED, lw=1.2, zorder=4)
    half, beyond = residual_reach(residual)
    below.set_ylim(-half, half)
    if beyond:
        add_note(below, spikes(beyond, half, output))
    limits = padded_limits(x, curve_input * input.factor, margin=0.03)
    if limits:
        main.set_xlim(*limits)
    finish(figure, title, handles)
    return figure


def _draw_points(
    axes: Axes, x: Array, y: Array, marker: str, colour: str, label: str
) -> list[Artist]:
    few = x.size <= FEW_POINTS
    filling = "none" if marker == "v" else colour
    axes.plot(
        *thinned_points(x, y, buckets=_BUCKETS),
        ls="none",
        marker=marker,
        ms=7 if few else 3.5,
        mfc=filling,
        mec=colour,
        mew=1.2 if few else 0.6,
        zorder=2 if marker == "^" else 3,
    )
    return [Line2D([], [], ls="none", marker=marker, ms=7, mfc=filling, mec=colour, label=label)]
