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
    add_header,
    add_panel,
    new_figure,
)
from softid.residuals import Autocorrelation, CrossCorrelation, autocorrelation, cross_correlation
from softid.results import Simulation

Array = npt.NDArray[np.float64]

MOST_LAGS = 400
LAG_SHARE = 0.25
_STEMS = 60
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
    lag_label: str = "lag (s)",
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
    lag_label, input_name, title
        Texts.

    Returns
    -------
    Figure
    """
    figure = new_figure()
    above = add_panel(
        figure, (LEFT, 0.545, RIGHT, TOP), x_label="", y_label="autocorrelation", y_ticks=6
    )
    below = add_panel(
        figure,
        (LEFT, BOTTOM, RIGHT, 0.465),
        x_label=lag_label,
        y_label=f"correlation with {input_name.replace('_', ' ')}",
        y_ticks=6,
    )
    handles = _draw_values(above, auto_lags, auto_values)
    handles.append(_draw_band(above, auto_lags, auto_band))
    handles.append(_draw_white(above, white_band))
    low = min(float(np.nanmin(auto_values)), -float(np.nanmax(auto_band)))
    above.set_ylim(max(1.15 * low, -1.05), 1.08)
    above.set_xlim(auto_lags[0], auto_lags[-1])
    _draw_values(below, cross_lags, cross_values)
    _draw_band(below, cross_lags, np.full(cross_lags.size, cross_band))
    _draw_white(below, white_band)
    half = 1.15 * max(float(np.nanmax(np.abs(cross_values))), cross_band)
    below.set_ylim(-min(half, 1.08), min(half, 1.08))
    below.set_xlim(cross_lags[0], cross_lags[-1])
    below.axvline(0.0, color=FAINT, lw=1.0, zorder=0)
    below.text(
        0.985,
        0.94,
        "residual follows the input →",
        transform=below.transAxes,
        ha="right",
        va="top",
        fontsize=11,
    )
    add_header(figure, title, handles)
    return figure


def residual_correlation(
    simulations: Sequence[Simulation], channel: str
) -> tuple[Autocorrelation, CrossCorrelation, float]:
    """Correlations of the residuals of several logs taken together.

    The logs are joined with missing samples between them, so that no pair of samples spans two
    segments, and each residual is taken about its own log's mean.

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
    samples = sum(s.time_s.size for s in simulations)
    longest = max(s.time_s.size for s in simulations)
    max_lag = max(1, min(MOST_LAGS, int(LAG_SHARE * longest)))
    gap = np.full(max_lag, np.nan)
    residuals: list[Array] = []
    inputs: list[Array] = []
    for simulation in simulations:
        edges = [*simulation.segment_starts, simulation.time_s.size]
        residual = simulation.residual(channel)
        for start, stop in zip(edges[:-1], edges[1:], strict=True):
            residuals += [residual[start:stop], gap]
            inputs += [simulation.input[start:stop], gap]
    del samples
    e, u = np.concatenate(residuals), np.concatenate(inputs)
    period_s = float(np.median(np.concatenate([np.diff(s.time_s) for s in simulations])))
    return autocorrelation(e, max_lag), cross_correlation(e, u, max_lag), period_s


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
