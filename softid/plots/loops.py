"""Output against input around each cycle, by rate: measured and simulated side by side."""

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
    BY_ORDER,
    FAINT,
    LABEL_SIZE,
    LEFT,
    RIGHT,
    TOP_BELOW_TWO,
    Display,
    add_panel,
    finish,
    new_figure,
)
from softid.plots.cycles import RateFamily, families_by_rate
from softid.plots.traces import decimate, padded_limits

Array = npt.NDArray[np.float64]

MOST_LOOPS = 12
"""Cycles drawn of one rate, spread from the first to the last."""

_MIDDLE = 0.5 * (LEFT + RIGHT)
_TOP = TOP_BELOW_TWO - 0.025
_BUCKETS = 300


@dataclass(frozen=True, eq=False)
class Loop:
    """One cycle.

    Attributes
    ----------
    rate_hz
        Its rate.
    input, measured, simulated
        Samples in order, shape (n,), NaN where missing.
    """

    rate_hz: float
    input: Array
    measured: Array
    simulated: Array


def draw_loops(
    loops: Sequence[Loop], *, input: Display, output: Display, title: str = "Loops by rate"
) -> Figure:
    """Draw the cycles of one or several logs, each family of rates in its own line style.

    The measured loops lie in pale grey behind the simulated ones too. Hysteresis keeps its loop
    as the rate falls; a lag does not.

    Parameters
    ----------
    loops
        The cycles, at least one.
    input, output
        How the two axes are shown.
    title
        Heading.

    Returns
    -------
    Figure
    """
    families = families_by_rate([loop.rate_hz for loop in loops])
    figure = new_figure()
    left = add_panel(
        figure,
        (LEFT, BOTTOM, _MIDDLE - 0.01, _TOP),
        x_label=input.label,
        y_label=output.label,
        x_ticks=5,
        y_ticks=7,
    )
    right = add_panel(
        figure,
        (_MIDDLE + 0.01, BOTTOM, RIGHT, _TOP),
        x_label=input.label,
        share_x=left,
        share_y=left,
    )
    _name_panel(left, "measured")
    _name_panel(right, "simulated, measured in grey")
    handles: list[Artist] = []
    for family, (colour, dashes) in zip(families, BY_ORDER, strict=False):
        for loop in _spread([loops[k] for k in family.members]):
            _draw_loop(right, loop.input, loop.measured, input, output, colour=FAINT, zorder=1)
            _draw_loop(left, loop.input, loop.measured, input, output, colour=colour, dashes=dashes)
            _draw_loop(
                right, loop.input, loop.simulated, input, output, colour=colour, dashes=dashes
            )
        handles.append(_key(family, colour, dashes))
    across = padded_limits(*(loop.input for loop in loops), margin=0.04)
    up = padded_limits(*(a for loop in loops for a in (loop.measured, loop.simulated)), margin=0.04)
    if across and up:
        left.set_xlim(across[0] * input.factor, across[1] * input.factor)
        left.set_ylim(up[0] * output.factor, up[1] * output.factor)
    finish(figure, title, handles, rows=2)
    return figure


Dashes = str | tuple[int, tuple[float, ...]]


def _spread(loops: Sequence[Loop]) -> list[Loop]:
    chosen = np.unique(np.linspace(0, len(loops) - 1, MOST_LOOPS).round().astype(int))
    return [loops[k] for k in chosen]


def _draw_loop(
    axes: Axes,
    x: Array,
    y: Array,
    input: Display,
    output: Display,
    *,
    colour: str,
    dashes: Dashes = "-",
    zorder: float = 2,
) -> None:
    there = np.isfinite(y)
    axes.plot(
        *decimate(x[there] * input.factor, y[there] * output.factor, buckets=_BUCKETS),
        color=colour,
        ls=dashes,
        lw=1.3,
        zorder=zorder,
    )


def _key(family: RateFamily, colour: str, dashes: Dashes) -> Artist:
    return Line2D([], [], color=colour, ls=dashes, lw=1.6, label=family.label)


def _name_panel(axes: Axes, name: str) -> None:
    axes.text(0.0, 1.012, name, transform=axes.transAxes, va="bottom", fontsize=LABEL_SIZE)
