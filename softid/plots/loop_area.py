"""Area of the loop of output over input against the rate of the input."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from softid.plots.before_after import AFTER, BEFORE, BEFORE_DASHES
from softid.plots.canvas import (
    BOTTOM,
    INK,
    LEFT,
    RIGHT,
    TOP_BELOW_TWO,
    Display,
    add_note,
    add_panel,
    finish,
    new_figure,
)
from softid.plots.cycles import SAME_RATE

Array = npt.NDArray[np.float64]

WIDE = 3.0
"""Rates that differ by this factor are drawn on a logarithmic axis."""
FEWEST = 8
READING = "towards slow: hysteresis and dry friction keep their loop, a lag's goes to zero"
ONE_RATE = "one rate only: the area alone cannot split hysteresis from a lag"


@dataclass(frozen=True)
class _Look:
    label: str
    marker: str
    colour: str
    dashes: str | tuple[int, tuple[float, ...]] = "-"


_LOOKS = (
    _Look("measured", "o", "#7a7a7a"),
    _Look("residual of the base", "^", BEFORE, BEFORE_DASHES),
    _Look("residual of the extended model", "s", AFTER),
)


@dataclass(frozen=True)
class LoopWidth:
    """How wide the loops of one cycle are: their area over the span of the input.

    Attributes
    ----------
    rate_hz
        Rate of the cycle.
    measured, before, after
        Width in the output's unit of the measured loop and of the residual's loop without and with
        the extension; positive when the output comes after the input; None without an extension.
    """

    rate_hz: float
    measured: float
    before: float
    after: float | None


def loop_width(input_values: Array, output_values: Array) -> float | None:
    r"""Mean distance between the falling and the rising branch, ∮ u dy / (max u − min u).

    Parameters
    ----------
    input_values, output_values
        One cycle in order, shape (n,); missing outputs are bridged, the ends are joined.

    Returns
    -------
    float or None
        Positive when the falling branch lies above; None for too few samples or a still input.

    Examples
    --------
    >>> phase = np.linspace(0.0, 2 * np.pi, 1001)
    >>> round(loop_width(np.sin(phase), np.sin(phase - 0.1)) / (np.pi / 2 * np.sin(0.1)), 4)
    1.0
    """
    there = np.isfinite(output_values)
    u, y = input_values[there], output_values[there]
    if u.size < FEWEST or float(np.ptp(u)) == 0.0:
        return None
    twice = float(np.dot(u, np.roll(y, -1)) - np.dot(np.roll(u, -1), y))
    return 0.5 * twice / float(np.ptp(u))


def draw_loop_area(
    widths: Sequence[LoopWidth],
    *,
    output: Display,
    title: str = "Loop area over span of the input, against rate",
) -> Figure:
    """Draw the width of every cycle's loop by rate, measured and of the residuals.

    Hysteresis and dry friction keep their loop as the rate goes to zero; the loop of a lag or of
    damping shrinks with the rate.

    Parameters
    ----------
    widths
        The cycles, at least one.
    output
        How the output is shown.
    title
        Heading.

    Returns
    -------
    Figure
    """
    figure = new_figure()
    above = add_panel(
        figure, (LEFT, 0.485, RIGHT, TOP_BELOW_TWO), y_label=output.named("loop width, measured")
    )
    below = add_panel(
        figure,
        (LEFT, BOTTOM, RIGHT, 0.455),
        x_label="rate of the input (Hz)",
        y_label=output.named("loop width, residual"),
        share_x=above,
    )
    rates = np.array([w.rate_hz for w in widths])
    spread = float(rates.max() / rates.min())
    _set_rates(below, rates, logarithmic=spread >= WIDE)
    handles = [
        _draw_family(above, rates, [w.measured for w in widths], output, _LOOKS[0]),
        _draw_family(below, rates, [w.before for w in widths], output, _LOOKS[1]),
    ]
    after = [w.after for w in widths if w.after is not None]
    if len(after) == len(widths):
        handles.append(_draw_family(below, rates, after, output, _LOOKS[2]))
    for axes in (above, below):
        axes.axhline(0.0, color=INK, lw=0.8, zorder=1)
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, 0.0), high)
    add_note(above, ONE_RATE if spread < SAME_RATE else READING)
    finish(figure, title, handles)
    return figure


def _set_rates(axes: Axes, rates_hz: Array, *, logarithmic: bool) -> None:
    low, high = float(rates_hz.min()), float(rates_hz.max())
    if not logarithmic:
        axes.set_xlim(0.0, 1.1 * high)
        return
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xlim(low / 1.15, high * 1.15)


def _draw_family(
    axes: Axes, rates_hz: Array, values: Sequence[float], output: Display, look: _Look
) -> Artist:
    """Every cycle as a small open marker, their medians by rate as a line; returns the line."""
    y = np.array(values, dtype=np.float64) * output.factor
    axes.plot(
        rates_hz,
        y,
        ls="none",
        marker=look.marker,
        ms=5,
        mfc="white",
        mec=look.colour,
        mew=1.0,
        zorder=2,
    )
    (line,) = axes.plot(
        *medians_by_rate(rates_hz, y),
        color=look.colour,
        ls=look.dashes,
        lw=2.0,
        marker=look.marker,
        ms=8,
        zorder=3,
        label=look.label,
    )
    return line


def medians_by_rate(rates_hz: Array, values: Array) -> tuple[Array, Array]:
    """Median of groups of similar rate, slowest first.

    Examples
    --------
    >>> medians_by_rate(np.array([1.0, 0.1, 1.1]), np.array([4.0, 1.0, 6.0]))[1].tolist()
    [1.0, 5.0]
    """
    order = np.argsort(rates_hz, kind="stable")
    groups: list[list[int]] = []
    for k in order.tolist():
        if groups and rates_hz[k] <= SAME_RATE * rates_hz[groups[-1][0]]:
            groups[-1].append(k)
        else:
            groups.append([k])
    return (
        np.array([float(np.median(rates_hz[g])) for g in groups]),
        np.array([float(np.median(values[g])) for g in groups]),
    )
