"""The paper of every plot: figure, panels, header, styles that survive a grey print, and PNG bytes."""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, ScalarFormatter
from PIL import Image

WIDTH_IN, HEIGHT_IN, DPI = 12.0, 8.0, 100
LEFT, RIGHT, BOTTOM = 0.08, 0.985, 0.08
TITLE_AT, LEGEND_TOP, TOP, TOP_BELOW_TWO = 0.96, 0.934, 0.885, 0.858
LABEL_OFFSET = 0.047
TITLE_SIZE, LABEL_SIZE, TICK_SIZE, NOTE_SIZE = 15, 13, 12, 12
PNG_LEVEL = 3
LONGEST_NAME = 60

INK = "#000000"
MEASURED = "#9a9a9a"
SIMULATED = "#003f7f"
ACCENT = "#b03a00"
PALE = "#ececec"
FAINT = "#c9c9c9"
"""Lightness falls from `PALE` to `INK`; blue and vermilion differ for colour-blind eyes too."""

BY_ORDER: tuple[tuple[str, str | tuple[int, tuple[float, ...]]], ...] = (
    (INK, "-"),
    ("#0072b2", (0, (6, 2))),
    ("#d55e00", (0, (6, 2, 1.5, 2))),
    ("#7a7a7a", (0, (1.5, 1.5))),
)
"""Colour and dashes of the first, second, … member of a family of lines."""


@dataclass(frozen=True)
class Display:
    """How a quantity is shown: ``shown = factor · value``.

    Attributes
    ----------
    name
        Channel or symbol.
    unit
        Unit shown; ``"1"`` when there is none.
    factor
        From the unit of the array to ``unit``.
    """

    name: str
    unit: str
    factor: float = 1.0

    @property
    def label(self) -> str:
        """Name and unit for an axis."""
        return self.named(self.name)

    @property
    def two_lines(self) -> str:
        """Name above unit, for a panel too thin for one line."""
        return self.label.replace(" (", "\n(")

    def named(self, name: str) -> str:
        """Another name in the same unit: ``named("residual")`` → ``"residual (deg)"``."""
        plain = name.replace("_", " ")
        return plain if self.unit in ("", "1") else f"{plain} ({self.unit})"


def new_figure(*, width_in: float = WIDTH_IN, height_in: float = HEIGHT_IN) -> Figure:
    """An empty figure that belongs to no window and no global list."""
    figure = Figure(figsize=(width_in, height_in), dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def add_panel(
    figure: Figure,
    rectangle: tuple[float, float, float, float],
    *,
    x_label: str | None = None,
    y_label: str | None = None,
    share_x: Axes | None = None,
    share_y: Axes | None = None,
    x_ticks: int = 7,
    y_ticks: int = 5,
) -> Axes:
    """Axes at a fixed place, with few ticks: each tick costs five artists.

    Parameters
    ----------
    figure
        The figure to draw on.
    rectangle
        Left, bottom, right and top edge, as shares of the figure.
    x_label, y_label
        What the axes show; without a label an x axis shows no numbers.
    share_x, share_y
        Axes whose limits are shared.
    x_ticks, y_ticks
        Largest number of intervals.
    """
    left, bottom, right, top = rectangle
    axes = figure.add_axes(
        (left, bottom, right - left, top - bottom), sharex=share_x, sharey=share_y
    )
    if share_x is None:
        axes.xaxis.set_major_locator(MaxNLocator(nbins=x_ticks, steps=[1, 2, 2.5, 5, 10]))
    if share_y is None:
        axes.yaxis.set_major_locator(MaxNLocator(nbins=y_ticks, steps=[1, 2, 2.5, 5, 10]))
    for axis in (axes.xaxis, axes.yaxis):
        formatter = axis.get_major_formatter()
        if isinstance(formatter, ScalarFormatter):
            formatter.set_useOffset(False)
    axes.tick_params(labelsize=TICK_SIZE, labelbottom=x_label is not None)
    if x_label is not None:
        axes.set_xlabel(x_label, fontsize=LABEL_SIZE, parse_math=False)
    if y_label is not None:
        axes.set_ylabel(y_label, fontsize=LABEL_SIZE, parse_math=False)
        axes.yaxis.set_label_coords(-LABEL_OFFSET / (right - left), 0.5)
    return axes


def add_header(
    figure: Figure, title: str, handles: Iterable[Artist] = (), *, rows: int = 1
) -> None:
    """Title and legend above the panels, where no curve can run into them.

    Parameters
    ----------
    figure
        The figure to draw on.
    title
        Heading, shown as it is.
    handles
        Artists with labels.
    rows
        Rows of the legend; panels below end at `TOP`, or at `TOP_BELOW_TWO` with two rows.
    """
    figure.text(
        LEFT, TITLE_AT, title, fontsize=TITLE_SIZE, fontweight="bold", va="center", parse_math=False
    )
    shown = list(handles)
    if shown:
        figure.legend(
            handles=shown,
            loc="upper left",
            bbox_to_anchor=(LEFT, LEGEND_TOP),
            ncols=-(-len(shown) // rows),
            labelspacing=0.35,
            frameon=False,
            fontsize=NOTE_SIZE,
            handlelength=3.2,
            columnspacing=2.2,
            borderpad=0.0,
            borderaxespad=0.0,
        )


def add_note(axes: Axes, text: str) -> None:
    """A remark just above the upper right corner of a panel."""
    axes.text(
        1.0,
        1.015,
        text,
        transform=axes.transAxes,
        ha="right",
        va="bottom",
        fontsize=NOTE_SIZE,
        parse_math=False,
    )


def shortened(name: str, *, longest: int = LONGEST_NAME) -> str:
    """A name that fits into a title, its middle left out when it is long."""
    if len(name) <= longest:
        return name
    half = (longest - 1) // 2
    return f"{name[:half]}…{name[-half:]}"


def listed(names: Sequence[str], *, longest: int = LONGEST_NAME) -> str:
    """Names in one line, or the first and how many more."""
    joined = ", ".join(names)
    if len(joined) <= longest:
        return joined
    return f"{shortened(names[0], longest=longest - 12)} and {len(names) - 1} more"


def png_bytes(figure: Figure) -> bytes:
    """Render a figure.

    Parameters
    ----------
    figure
        A figure made by any function of `softid.plots`.

    Returns
    -------
    bytes
        A PNG file without alpha channel, the same bytes for the same figure.

    Examples
    --------
    >>> png_bytes(new_figure())[1:4]
    b'PNG'
    """
    canvas = figure.canvas
    if not isinstance(canvas, FigureCanvasAgg):
        canvas = FigureCanvasAgg(figure)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")  # shown as boxes, said once
        canvas.draw()
    size = canvas.get_width_height()
    # Without alpha and at a low level this takes half the time of savefig.
    image = Image.frombuffer("RGBA", size, canvas.buffer_rgba(), "raw", "RGBA", 0, 1)
    out = io.BytesIO()
    dpi = figure.get_dpi()
    image.convert("RGB").save(out, "PNG", compress_level=PNG_LEVEL, dpi=(dpi, dpi))
    return out.getvalue()
