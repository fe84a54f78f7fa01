"""The paper of every plot: figure, panels, header, styles that survive a grey print, and PNG."""

from __future__ import annotations

import struct
import warnings
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, ScalarFormatter

WIDTH_IN, HEIGHT_IN, DPI = 12.0, 8.0, 100
LEFT, RIGHT, BOTTOM = 0.092, 0.985, 0.08
TITLE_AT, LEGEND_TOP, TOP, TOP_BELOW_TWO = 0.96, 0.934, 0.885, 0.858
X_LABEL_BELOW_IN, LABEL_GAP_IN, DIGIT_IN = 0.31, 0.17, 0.106
CHARACTER_IN = {".": 0.053, "−": 0.140, "-": 0.06}
"""Widths of what a number on an axis is made of, at `TICK_SIZE`."""
TITLE_SIZE, LABEL_SIZE, TICK_SIZE, NOTE_SIZE = 15, 13, 12, 12
PNG_LEVEL = 3
LONGEST_NAME = 60

INK = "#000000"
MEASURED = "#9a9a9a"
SIMULATED = "#003f7f"
ACCENT = "#b03a00"
PALE = "#ececec"
FAINT = "#c9c9c9"
"""Colour of what stands behind the data. From `PALE` by this one to `INK` lightness falls; blue and
vermilion differ for colour-blind eyes too."""

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
        What the axes show; an axis without a label is not drawn, for a neighbour shows it.
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
    axes.tick_params(labelsize=TICK_SIZE)
    axes.xaxis.set_visible(x_label is not None)
    axes.yaxis.set_visible(y_label is not None)
    axes.set_xlabel(x_label or "", fontsize=LABEL_SIZE, parse_math=False)
    height_in = float(figure.get_size_inches()[1]) * (top - bottom)
    axes.xaxis.set_label_coords(0.5, -X_LABEL_BELOW_IN / height_in)
    axes.set_ylabel(y_label or "", fontsize=LABEL_SIZE, parse_math=False)
    return axes


def finish(figure: Figure, title: str, handles: Iterable[Artist] = (), *, rows: int = 1) -> None:
    """Put title and legend above the panels, where no curve runs into them, and place the y labels.

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
    _place_y_labels(figure)
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


def _place_y_labels(figure: Figure) -> None:
    """Leave just room for the longest number of the panels in one column.

    The automatic placement measures every text, which costs a second rendering.
    """
    labelled = [axes for axes in figure.axes if axes.get_ylabel()]
    lefts = [round(axes.get_position().x0, 3) for axes in labelled]
    widths_in = [_longest_number_in(axes) for axes in labelled]
    figure_in = float(figure.get_size_inches()[0])
    for axes, left, own in zip(labelled, lefts, widths_in, strict=True):
        # A label of two lines needs the room itself, so it does not line up with the others.
        alone = "\n" in axes.get_ylabel()
        column = [own] if alone else [w for w, x in zip(widths_in, lefts, strict=True) if x == left]
        offset_in = LABEL_GAP_IN + max(column)
        axes.yaxis.set_label_coords(-offset_in / (figure_in * axes.get_position().width), 0.5)


def _longest_number_in(axes: Axes) -> float:
    """Width of the longest number on the y axis, in inches."""
    low, high = sorted(axes.get_ylim())
    ticks = [t for t in axes.yaxis.get_majorticklocs() if low <= t <= high]
    texts = axes.yaxis.get_major_formatter().format_ticks(ticks)
    return max((sum(CHARACTER_IN.get(c, DIGIT_IN) for c in text) for text in texts), default=0.0)


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


def names_and_count(names: Sequence[str]) -> str:
    """Names in one line, or the first and how many more."""
    joined = ", ".join(names)
    if len(joined) <= LONGEST_NAME:
        return joined
    return f"{shortened(names[0], longest=LONGEST_NAME - 12)} and {len(names) - 1} more"


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
        canvas.draw()  # type: ignore[no-untyped-call]
    return _encoded(np.asarray(canvas.buffer_rgba()), figure.get_dpi())  # type: ignore[no-untyped-call]


def _encoded(pixels: npt.NDArray[np.uint8], dpi: float) -> bytes:
    """Pixels of shape (rows, columns, 4) as PNG without alpha, in half the time of savefig."""
    rows, columns, _ = pixels.shape
    lines = np.zeros((rows, 1 + 3 * columns), np.uint8)  # each line starts with its filter: none
    lines[:, 1:] = pixels[:, :, :3].reshape(rows, -1)
    per_metre = round(dpi / 0.0254)
    return b"".join(
        (
            b"\x89PNG\r\n\x1a\n",
            _chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)),
            _chunk(b"pHYs", struct.pack(">IIB", per_metre, per_metre, 1)),
            _chunk(b"IDAT", zlib.compress(lines.tobytes(), PNG_LEVEL)),
            _chunk(b"IEND", b""),
        )
    )


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
