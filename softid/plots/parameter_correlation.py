"""Which parameters the logs cannot tell apart: their correlation as a table of shades."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from softid.plots.canvas import LABEL_SIZE, NOTE_SIZE, finish, new_figure

Array = npt.NDArray[np.float64]

DARKEST = 0.25
_WHITE_TEXT_FROM = 0.62
_LARGEST_WRITTEN = 16


def draw_parameter_correlation(
    correlation: Array,
    names: Sequence[str],
    *,
    relative_errors: Sequence[float | None] | None = None,
    title: str = "Correlation of the parameters",
) -> Figure:
    """Draw a correlation matrix: the darker, the closer to ±1; the sign is written.

    Parameters
    ----------
    correlation
        Shape (K, K).
    names
        The K parameters.
    relative_errors
        Standard error over value of each, written on the diagonal; None where unknown.
    title
        Heading.

    Returns
    -------
    Figure
    """
    size = len(names)
    figure = new_figure(width_in=9.5, height_in=8.0)
    axes = figure.add_axes((0.13, 0.06, 0.84, 0.83))
    strength = np.where(np.tri(size, k=-1, dtype=bool), np.abs(correlation), np.nan)
    shades = ListedColormap(np.repeat(np.linspace(1.0, DARKEST, 64)[:, None], 3, axis=1))
    edges = np.arange(size + 1) - 0.5
    axes.pcolormesh(
        edges, edges, strength, vmin=0.0, vmax=1.0, cmap=shades, edgecolors="white", lw=2.0
    )
    text_size = min(13.0, 110.0 / size)
    for row in range(size if size <= _LARGEST_WRITTEN else 0):
        for column in range(row):
            r = float(correlation[row, column])
            axes.text(
                column,
                row,
                f"{r:+.2f}".replace("-", "−") if np.isfinite(r) else "?",
                ha="center",
                va="center",
                fontsize=text_size,
                color="white" if abs(r) > _WHITE_TEXT_FROM else "black",
            )
        error = relative_errors[row] if relative_errors else None
        axes.text(
            row,
            row,
            _relative(error),
            ha="center",
            va="center",
            fontsize=text_size,
        )
    if relative_errors:
        axes.text(
            size - 0.5,
            -0.5,
            "shade: size of the correlation\ndiagonal: standard error\nrelative to the value",
            ha="right",
            va="top",
            fontsize=NOTE_SIZE,
        )
    axes.set_xlim(-0.5, size - 0.5)
    axes.set_ylim(size - 0.5, -0.5)
    axes.set_xticks(range(size), names, fontsize=LABEL_SIZE, parse_math=False)
    axes.set_yticks(range(size), names, fontsize=LABEL_SIZE, parse_math=False)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    finish(figure, title)
    return figure


def _relative(error: float | None) -> str:
    if error is None:
        return "±?"
    if error >= 10.0:
        return "> ±1000 %"
    return f"±{100.0 * error:.0f} %" if error >= 0.1 else f"±{100.0 * error:.2g} %"
