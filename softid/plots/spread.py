"""How the estimates of one number scatter, method under method."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from softid.plots.canvas import (
    ACCENT,
    BOTTOM,
    FAINT,
    INK,
    MEASURED,
    NOTE_SIZE,
    RIGHT,
    SIMULATED,
    TOP,
    Display,
    add_panel,
    finish,
    new_figure,
)

Array = npt.NDArray[np.float64]

_LEFT = 0.17
_HALF_BOX = 0.13
_CLOUD = 0.2


def draw_spread(
    estimates: Mapping[str, Array],
    *,
    truth: float,
    quantity: Display,
    title: str = "Spread of the estimates",
) -> Figure:
    """Draw every estimate as a point, with quartiles and mean, one row per method.

    Parameters
    ----------
    estimates
        Method → estimates, each of shape (n,), in the order from top to bottom.
    truth
        The true value.
    quantity
        How the estimates are shown.
    title
        Heading.

    Returns
    -------
    Figure
    """
    rows = len(estimates)
    figure = new_figure()
    axes = add_panel(
        figure,
        (_LEFT, BOTTOM, RIGHT, TOP),
        x_label=quantity.label,
        y_label="",
        x_ticks=9,
    )
    axes.axvline(0.0, color=FAINT, lw=1.0, zorder=1)
    axes.axvline(truth * quantity.factor, color=INK, lw=1.4, ls=(0, (6, 3)), zorder=4)
    for row, values in enumerate(estimates.values()):
        shown = np.asarray(values) * quantity.factor
        low, middle, high = np.quantile(shown, [0.25, 0.5, 0.75])
        # Spread evenly in the order of the draws, which is random anyway.
        height = row + np.linspace(-_CLOUD, _CLOUD, shown.size)
        axes.plot(shown, height, ls="none", marker="o", ms=4, mfc=MEASURED, mec="none", zorder=2)
        axes.fill_between(
            [low, high], row - _HALF_BOX, row + _HALF_BOX, fc="none", ec=SIMULATED, lw=1.8, zorder=5
        )
        axes.plot(
            [middle] * 2, [row - _HALF_BOX, row + _HALF_BOX], color=SIMULATED, lw=2.6, zorder=5
        )
        axes.plot(float(shown.mean()), row, marker="D", ms=8, mfc=ACCENT, mec="white", zorder=6)
        axes.text(
            0.995,
            row - _CLOUD - 0.06,
            _summary(shown, truth * quantity.factor, quantity.unit),
            transform=axes.get_yaxis_transform(),
            ha="right",
            va="bottom",
            fontsize=NOTE_SIZE,
            parse_math=False,
        )
    axes.set_ylim(rows - 0.55, -0.6)
    axes.set_yticks(range(rows), [name.replace(" ", "\n") for name in estimates])
    axes.tick_params(axis="y", length=0)
    finish(figure, title, _handles())
    return figure


def _summary(values: Array, truth: float, unit: str) -> str:
    spread = float(values.std(ddof=1))
    tail = "" if unit in ("", "1") else f" {unit}"
    parts = [
        f"bias {values.mean() - truth:+.2g} ± {spread / np.sqrt(values.size):.2g}{tail}",
        f"sd {spread:.2g}{tail}",
    ]
    if np.any(values <= 0.0) and truth > 0.0:
        parts.append(f"{100.0 * np.mean(values <= 0.0):.0f} % not positive")
    return ", ".join(parts)


def _handles() -> list[Artist]:
    return [
        Line2D([], [], ls="none", marker="o", ms=5, mfc=MEASURED, mec="none", label="one draw"),
        Patch(fc="none", ec=SIMULATED, lw=1.8, label="quartiles, median"),
        Line2D([], [], ls="none", marker="D", ms=8, mfc=ACCENT, mec="white", label="mean"),
        Line2D([], [], color=INK, lw=1.4, ls=(0, (6, 3)), label="truth"),
    ]
