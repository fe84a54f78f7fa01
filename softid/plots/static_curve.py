"""The static curve of a model with the levels at which the logs settled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from softid.plots.canvas import (
    ACCENT,
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
from softid.plots.traces import decimate, padded_limits

Array = npt.NDArray[np.float64]

BEYOND_LABEL = "extrapolated"
BEYOND_DASHES = (0, (4, 3))
_MARKER = {1: "^", -1: "v", 0: "o"}
_MEANING = {1: "settled after a rise", -1: "settled after a fall", 0: "first level"}
_MIDDLE = "#8a8a8a"


@dataclass(frozen=True, eq=False)
class Levels:
    """Where one log settled, and the path that it took.

    Attributes
    ----------
    log
        Its name.
    in_sample
        Whether the parameters were fitted to it.
    input, output
        Mean over each settled window, shape (m,).
    direction
        1 where the input rose to the level, −1 where it fell, 0 for the first, shape (m,).
    path_input, path_output
        All samples in order, shape (n,), NaN where the line breaks.
    """

    log: str
    in_sample: bool
    input: Array
    output: Array
    direction: npt.NDArray[np.int8]
    path_input: Array
    path_output: Array


def draw_static_curve(
    curve_input: Array,
    curve_output: Array,
    levels: Sequence[Levels],
    *,
    fitted_range: tuple[float, float],
    input: Display,
    output: Display,
    title: str = "Static curve",
) -> Figure:
    """Draw a static curve, solid in the fitted range and dashed beyond, with measured levels.

    Levels point up where the input rose to them and down where it fell; they are filled for
    fitted logs and open for held-out ones. The paths of the logs lie behind in pale grey.

    Parameters
    ----------
    curve_input, curve_output
        The model at rest, sensor zero applied, shape (g,), input rising.
    levels
        Measured levels, one entry per log, on the same zero.
    fitted_range
        Smallest and largest input of the fitted logs; shaded.
    input, output
        How the two axes are shown.
    title
        Heading.

    Returns
    -------
    Figure
    """
    figure = new_figure()
    axes = add_panel(
        figure,
        (LEFT, BOTTOM, RIGHT, TOP_BELOW_TWO),
        x_label=input.label,
        y_label=output.label,
        y_ticks=7,
    )
    axes.axvspan(
        fitted_range[0] * input.factor, fitted_range[1] * input.factor, color=PALE, lw=0, zorder=0
    )
    for log in levels:
        x, y = decimate(log.path_input * input.factor, log.path_output * output.factor)
        axes.plot(x, y, color=FAINT, lw=0.8, zorder=1)
    handles = _draw_curve(axes, curve_input, curve_output, fitted_range, input, output)
    handles.append(Patch(facecolor=PALE, edgecolor=FAINT, label="fitted range"))
    if levels:
        handles.append(Line2D([], [], color=FAINT, lw=1.5, label="measured path"))
    handles += _draw_levels(axes, levels, input, output)
    if not _set_limits(axes, curve_input, curve_output, levels, input, output):
        handles[0].set_label("model at rest, out of the plot")
        handles = [handle for handle in handles if handle.get_label() != BEYOND_LABEL]
    finish(figure, title, handles, rows=2)
    return figure


def draw_split_curve(
    axes: Axes, x: Array, y: Array, inside: npt.NDArray[np.bool_], *, label: str
) -> list[Artist]:
    """Draw a curve solid where it was fitted and dashed beyond; returns the legend's handles."""
    (line,) = axes.plot(x, np.where(inside, y, np.nan), color=SIMULATED, lw=2.0, label=label)
    handles: list[Artist] = [line]
    if not inside.all():
        beyond = ~inside
        beyond[:-1] |= ~inside[1:]  # so that the dashes meet the solid line
        beyond[1:] |= ~inside[:-1]
        handles += axes.plot(
            x,
            np.where(beyond, y, np.nan),
            color=SIMULATED,
            lw=1.6,
            ls=BEYOND_DASHES,
            label=BEYOND_LABEL,
        )
    return handles


def _draw_curve(
    axes: Axes,
    x: Array,
    y: Array,
    fitted_range: tuple[float, float],
    input: Display,
    output: Display,
) -> list[Artist]:
    inside = (x >= fitted_range[0]) & (x <= fitted_range[1])
    return draw_split_curve(
        axes, x * input.factor, y * output.factor, inside, label="model at rest"
    )


def _draw_levels(
    axes: Axes, levels: Sequence[Levels], input: Display, output: Display
) -> list[Artist]:
    handles: list[Artist] = []
    for in_sample in (True, False):
        for direction, marker in _MARKER.items():
            chosen = [(log, log.direction == direction) for log in levels]
            chosen = [(log, at) for log, at in chosen if log.in_sample is in_sample and at.any()]
            if not chosen:
                continue
            filling = INK if direction > 0 else _MIDDLE
            handles += axes.plot(
                np.concatenate([log.input[at] for log, at in chosen]) * input.factor,
                np.concatenate([log.output[at] for log, at in chosen]) * output.factor,
                ls="none",
                marker=marker,
                ms=9,
                mew=1.3,
                color=INK if in_sample else ACCENT,
                mfc=filling if in_sample else "white",
                zorder=3,
                label=_MEANING[direction] if in_sample else "open: held out",
            )
    open_ones = [h for h in handles if h.get_label() == "open: held out"]
    return [h for h in handles if h not in open_ones[1:]]


def _set_limits(
    axes: Axes,
    x: Array,
    y: Array,
    levels: Sequence[Levels],
    input: Display,
    output: Display,
) -> bool:
    """Hold all that was measured and what of the curve is near it, if any is: whether it is."""
    across = padded_limits(x, *(log.path_input for log in levels), margin=0.02)
    own = padded_limits(*(log.path_output for log in levels), *(log.output for log in levels))
    both = padded_limits(y, *(log.path_output for log in levels))
    if across:
        axes.set_xlim(across[0] * input.factor, across[1] * input.factor)
    if own and both:
        room = own[1] - own[0]
        low, high = max(both[0], own[0] - room), min(both[1], own[1] + room)
        near = bool(np.any((y >= low) & (y <= high)))
        low, high = (low, high) if near else own
        axes.set_ylim(low * output.factor, high * output.factor)
        return near
    return True
