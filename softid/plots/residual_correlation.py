"""Memory of a residual and its tie to the input, with the bands of chance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softid.plots.canvas import (
    BOTTOM,
    FAINT,
    INK,
    LEFT,
    RIGHT,
    SIMULATED,
    TOP,
    add_note,
    add_panel,
    finish,
    new_figure,
)
from softid.plots.traces import segment_spans
from softid.residuals import Autocorrelation, CrossCorrelation, autocorrelation, cross_correlation
from softid.results import Simulation

Array = npt.NDArray[np.float64]

MOST_LAGS, FEWEST_LAGS = 4000, 30
LAG_SHARE = 0.3
"""Largest lag as a share of the longest segment."""

DECAYS_SHOWN = 3.0
"""The lags shown reach this many times as far as the autocorrelation takes to enter its band."""

_STEMS = 60
_LAG = "lag (s)"
_WHITE_DASHES = (0, (5, 3))


def draw_residual_correlation(
    auto_lags: Array,
    auto_values: Array,
    auto_band: Array,
    cross_lags: Array,
    cross_values: Array,
    cross_band: float,
    *,
    white_band: float,
    input_name: str = "input",
    title: str = "Residual correlation",
) -> Figure:
    """Draw the autocorrelation of a residual and its correlation with the input.

    Parameters
    ----------
    auto_lags, auto_values
        Lags from 0 and the autocorrelation there, shape (a,).
    auto_band
        95 % half-width that allows for the memory at shorter lags, shape (a,).
    cross_lags, cross_values
        Lags about 0 and the correlation with the input, shape (c,); at a positive lag the residual
        follows the input.
    cross_band
        95 % half-width that allows for the memory of both.
    white_band
        95 % half-width for white noise.
    input_name, title
        Texts.

    Returns
    -------
    Figure
    """
    figure = new_figure()
    above = add_panel(
        figure, (LEFT, 0.56, RIGHT, TOP), x_label=_LAG, y_label="autocorrelation", y_ticks=6
    )
    below = add_panel(
        figure,
        (LEFT, BOTTOM, RIGHT, 0.455),
        x_label=_LAG,
        y_label=f"correlation with {input_name.replace('_', ' ')}",
        y_ticks=6,
    )
    handles = _draw_values(above, auto_lags, auto_values)
    handles.append(_draw_band(above, auto_lags, auto_band))
    handles.append(_draw_white(above, white_band))
    low = min(float(np.nanmin(auto_values)), -float(np.nanmax(auto_band)))
    above.set_ylim(max(1.15 * low - 0.05, -1.08), 1.08)
    edge = 0.01 * float(auto_lags[-1])
    above.set_xlim(-edge, auto_lags[-1] + edge)
    _draw_values(below, cross_lags, cross_values)
    _draw_band(below, cross_lags, np.full(cross_lags.size, cross_band))
    _draw_white(below, white_band)
    half = 1.15 * max(float(np.nanmax(np.abs(cross_values))), cross_band)
    below.set_ylim(-min(half, 1.08), min(half, 1.08))
    below.set_xlim(cross_lags[0], cross_lags[-1])
    below.axvline(0.0, color=FAINT, lw=1.0, zorder=0)
    add_note(below, "residual follows the input →")
    finish(figure, title, handles)
    return figure


def residual_correlation(
    simulations: Sequence[Simulation], channel: str
) -> tuple[Autocorrelation, CrossCorrelation, float]:
    """Correlations of the residuals of several logs taken together.

    The logs are joined with missing samples between them, so that no pair of samples spans two
    segments.

    Parameters
    ----------
    simulations
        Simulated and measured responses, at least one.
    channel
        Output channel.

    Returns
    -------
    tuple
        Autocorrelation, correlation with the input, and the median sampling interval in s, by
        which lags in samples become lags in time.

    Raises
    ------
    InputError
        The residual or the input does not vary.
    """
    spans = [
        (sim, span)
        for sim in simulations
        for span in segment_spans(sim.segment_starts, sim.input.size)
    ]
    longest = max(span.stop - span.start for _, span in spans)
    most = max(1, min(MOST_LAGS, int(LAG_SHARE * longest)))
    gap = np.full(most, np.nan)
    e = np.concatenate([a for sim, span in spans for a in (sim.residual(channel)[span], gap)])
    u = np.concatenate([a for sim, span in spans for a in (sim.input[span], gap)])
    lags = _lags_to_show(autocorrelation(e, most))
    period_s = float(np.median(np.concatenate([np.diff(s.time_s) for s in simulations])))
    return autocorrelation(e, lags), cross_correlation(e, u, lags), period_s


def _lags_to_show(found: Autocorrelation) -> int:
    inside = np.abs(found.values) <= found.bartlett_band
    decay = int(np.argmax(inside)) if inside.any() else found.values.size
    wanted = max(FEWEST_LAGS, int(DECAYS_SHOWN * decay))
    return min(wanted, found.values.size - 1)


def _draw_values(axes: Axes, lags: Array, values: Array) -> list[Artist]:
    axes.axhline(0.0, color=INK, lw=0.8, zorder=1)
    if lags.size <= _STEMS:
        axes.vlines(lags, 0.0, values, color=SIMULATED, lw=1.5, zorder=2)
        return list(
            axes.plot(lags, values, ls="none", marker="o", ms=4, color=SIMULATED, label="residual")
        )
    return list(axes.plot(lags, values, color=SIMULATED, lw=1.8, zorder=2, label="residual"))


def _draw_band(axes: Axes, lags: Array, band: Array) -> Artist:
    return axes.fill_between(
        lags, -band, band, color="#dcdcdc", lw=0, zorder=0, label="95 % band, memory allowed for"
    )


def _draw_white(axes: Axes, band: float) -> Artist:
    line = axes.axhline(
        band, color=INK, lw=1.0, ls=_WHITE_DASHES, zorder=1, label="95 % band, white noise"
    )
    axes.axhline(-band, color=INK, lw=1.0, ls=_WHITE_DASHES, zorder=1)
    return line
