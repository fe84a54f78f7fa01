"""One record against simulations with other parameters, panel by panel, and in the phase plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from softid.plots.canvas import (
    BOTTOM,
    FAINT,
    INK,
    LEFT,
    MEASURED,
    RIGHT,
    SIMULATED,
    TOP,
    TOP_BELOW_TWO,
    Display,
    add_note,
    add_panel,
    finish,
    new_figure,
)
from softid.plots.traces import decimate

Array = npt.NDArray[np.float64]

GAP_X, GAP_Y = 0.06, 0.09
SPARE = 0.15
"""Room above and below the measurement, as a share of its span; wilder simulations are cut."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A simulation of the record with some parameters changed.

    Attributes
    ----------
    label
        What was changed.
    simulated
        Response in the unit of the record, shape (n,).
    """

    label: str
    simulated: Array


def draw_trials(
    time_s: Array,
    measured: Array,
    trials: Sequence[Trial],
    *,
    output: Display,
    title: str,
) -> Figure:
    """Draw the record in two or four panels, each with one simulation.

    The panels share their axes, which hold the measurement and as much again above it, so that a
    swing without damping can be told from one with.

    Parameters
    ----------
    time_s, measured
        The record, each of shape (n,); NaN where a sample does not count.
    trials
        Two or four simulations.
    output
        How the output is shown.
    title
        Heading.

    Source: DEE 2022, the arrangement of Figures 5 and 6.
    """
    figure = new_figure()
    shape = (2, 2) if len(trials) > 2 else (1, 2)
    low, high = _limits(measured, [t.simulated for t in trials], output.factor)
    first = None
    for k, trial in enumerate(trials):
        row, column = divmod(k, shape[1])
        last_row = row == shape[0] - 1
        axes = add_panel(
            figure,
            _place(row, column, shape),
            x_label="time (s)" if last_row else None,
            y_label=output.label if column == 0 else None,
            share_x=first,
            share_y=first,
        )
        first = first or axes
        axes.plot(*decimate(time_s, measured * output.factor), color=MEASURED, lw=2.4)
        axes.plot(*decimate(time_s, trial.simulated * output.factor), color=SIMULATED, lw=1.2)
        axes.set_xlim(time_s[0], time_s[-1])
        axes.set_ylim(low, high)
        add_note(axes, f"({'abcd'[k]}) {trial.label}")
    finish(figure, title, _legend())
    return figure


def draw_phase_portrait(
    angle: Array,
    velocity: Array,
    measured_angle: Array,
    measured_velocity: Array,
    *,
    output: Display,
    title: str,
) -> Figure:
    """Draw velocity against angle: a spiral into the equilibrium.

    Parameters
    ----------
    angle, velocity
        Simulated θ and θ̇, each of shape (m,).
    measured_angle, measured_velocity
        Smoothed record and its slope, each of shape (n,).
    output
        How the angle is shown.
    title
        Heading.
    """
    figure = new_figure()
    speed = Display(f"{output.name} rate", f"{output.unit}/s", output.factor)
    axes = add_panel(
        figure, (LEFT, BOTTOM, RIGHT, TOP), x_label=output.label, y_label=speed.label, y_ticks=7
    )
    axes.axhline(0.0, color=FAINT, lw=0.8, zorder=0)
    axes.plot(
        measured_angle * output.factor,
        measured_velocity * output.factor,
        color=MEASURED,
        lw=0,
        marker=".",
        ms=4,
    )
    axes.plot(angle * output.factor, velocity * output.factor, color=SIMULATED, lw=1.4)
    ends = ((0, "o", "start"), (-1, "s", "end"))
    handles = _legend(dots=True)
    for at, marker, label in ends:
        place = ([angle[at] * output.factor], [velocity[at] * output.factor])
        (drawn,) = axes.plot(*place, color=INK, marker=marker, ms=8, lw=0, label=label)
        handles.append(drawn)
    finish(figure, title, handles)
    return figure


def _legend(*, dots: bool = False) -> list[Artist]:
    style = {"marker": ".", "lw": 0.0} if dots else {"lw": 2.4}
    return [
        Line2D([], [], color=MEASURED, label="measured", **style),
        Line2D([], [], color=SIMULATED, lw=1.4, label="simulated"),
    ]


def _place(row: int, column: int, shape: tuple[int, int]) -> tuple[float, float, float, float]:
    rows, columns = shape
    width = (RIGHT - LEFT - (columns - 1) * GAP_X) / columns
    height = (TOP_BELOW_TWO - BOTTOM - (rows - 1) * GAP_Y) / rows
    left = LEFT + column * (width + GAP_X)
    top = TOP_BELOW_TWO - row * (height + GAP_Y)
    return left, top - height, left + width, top


def _limits(measured: Array, simulated: Sequence[Array], factor: float) -> tuple[float, float]:
    """Limits that hold the record, and simulations up to one span of it beyond either end."""
    low, high = float(np.nanmin(measured)), float(np.nanmax(measured))
    span = (high - low) or 1.0
    joined = np.concatenate([s[np.isfinite(s)] for s in simulated])
    if joined.size:
        low = min(low, max(float(joined.min()), low - span))
        high = max(high, min(float(joined.max()), high + span))
    spare = SPARE * span
    ends = sorted(((low - spare) * factor, (high + spare) * factor))
    return ends[0], ends[1]
