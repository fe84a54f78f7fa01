"""Which parameters the logs cannot tell apart: their correlation as a table of shades."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from softid.plots.canvas import LABEL_SIZE, TICK_SIZE, add_header, new_figure

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
    axes = figure.add_axes((0.13, 0.06, 0.70, 0.83))
    strength = np.where(np.tri(size, k=-1, dtype=bool), np.abs(correlation), np.nan)
    shades = ListedColormap(np.repeat(np.linspace(1.0, DARKEST, 64)[:, None], 3, axis=1))
    image = axes.imshow(strength, vmin=0.0, vmax=1.0, cmap=shades, aspect="auto")
    text_size = min(13.0, 110.0 / size)
    for row in range(size if size <= _LARGEST_WRITTEN else 0):
        for column in range(row):
            r = float(correlation[row, column])
            axes.text(
                column,
                row,
                f"{r:+.2f}".replace("-", "−"),
                ha="center",
                va="center",
                fontsize=text_size,
                color="white" if abs(r) > _WHITE_TEXT_FROM else "black",
            )
        error = relative_errors[row] if relative_errors else None
        axes.text(
            row,
            row,
            f"±{100.0 * error:.2g} %" if error is not None and error < 10 else "",
            ha="center",
            va="center",
            fontsize=text_size,
            fontstyle="italic",
        )
    axes.set_xticks(range(size), names, fontsize=LABEL_SIZE, parse_math=False)
    axes.set_yticks(range(size), names, fontsize=LABEL_SIZE, parse_math=False)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    bar_axes = figure.add_axes((0.87, 0.06, 0.025, 0.83))
    bar = figure.colorbar(image, cax=bar_axes, ticks=[0.0, 0.25, 0.5, 0.75, 1.0])
    bar.set_label("size of the correlation", fontsize=LABEL_SIZE)
    bar.ax.tick_params(labelsize=TICK_SIZE)
    add_header(figure, title)
    return figure
