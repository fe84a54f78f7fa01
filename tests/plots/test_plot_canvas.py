"""Figure, header and PNG."""

from __future__ import annotations

import io
import subprocess
import sys

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D

from softid.plots.canvas import (
    DPI,
    LEFT,
    RIGHT,
    TOP,
    Display,
    add_panel,
    finish,
    names_and_count,
    new_figure,
    png_bytes,
    shortened,
)


def panel(figure: Figure, **labels: str) -> Axes:
    return add_panel(figure, (LEFT, 0.1, RIGHT, TOP), **labels)


def test_plots_never_import_pyplot() -> None:
    """pyplot keeps a global list of figures and may open windows; the set of modules tells."""
    code = (
        "import sys; from softid.plots import draw_all, new_figure, png_bytes;"
        "f = new_figure(); f.add_axes((0.1, 0.1, 0.8, 0.8)).plot([0, 1]); png_bytes(f);"
        "heavy = ('matplotlib.pyplot', 'scipy.signal', 'scipy.stats', 'lmfit', 'pandas');"
        "print([m for m in heavy if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_png_shows_what_was_drawn() -> None:
    """matplotlib's own reader gives back the renderer's pixels, bit by bit."""
    figure = new_figure()
    panel(figure, x_label="x", y_label="y").plot([0, 1, 0.5], color="#d55e00")
    pixels = imread(io.BytesIO(png_bytes(figure)), format="png")
    assert pixels.shape == (800, 1200, 3)
    drawn = np.asarray(figure.canvas.buffer_rgba())[:, :, :3]  # type: ignore[attr-defined]
    assert np.array_equal(np.round(pixels * 255).astype(np.uint8), drawn)
    assert drawn.min() < 100


def test_png_is_the_same_for_the_same_figure() -> None:
    """No time stamp, no version: two renderings are equal byte by byte."""
    figures = [new_figure(), new_figure()]
    for figure in figures:
        panel(figure, x_label="x", y_label="y").plot([0, 1])
    assert png_bytes(figures[0]) == png_bytes(figures[1])
    assert figures[0].get_dpi() == DPI


def test_axes_without_label_are_not_drawn() -> None:
    """Ticks that a neighbour shows anyway cost time and space."""
    figure = new_figure()
    axes = panel(figure, y_label="y")
    assert not axes.xaxis.get_visible()
    assert axes.yaxis.get_visible()


def test_a_dollar_in_a_name_is_no_formula() -> None:
    """Between two `$` matplotlib reads a formula, and raises on a broken one when drawn."""
    figure = new_figure()
    panel(figure, x_label="a$\\frac{$", y_label="b$\\frac{$").plot([0, 1])
    finish(figure, "run$\\frac{$", [Line2D([], [], label="measured")])
    assert len(png_bytes(figure)) > 1000


def test_a_name_without_glyphs_gives_no_warning(recwarn: pytest.WarningsRecorder) -> None:
    """The bundled font has no Chinese; the picture shows boxes, the terminal stays quiet."""
    figure = new_figure()
    panel(figure, x_label="气动", y_label="y").plot([0, 1])
    png_bytes(figure)
    assert not list(recwarn)


@pytest.mark.parametrize("values", [[-0.0052, 0.0047], [0, 1], [-12_345.0, 67_890.0]])
def test_labels_touch_neither_numbers_nor_the_edge(values: list[float]) -> None:
    """Measured with matplotlib's own text boxes, which the fast placement does without."""
    figure = new_figure()
    axes = panel(figure, x_label="time (s)", y_label="residual (rad)")
    axes.plot(values)
    finish(figure, "title")
    png_bytes(figure)
    label = axes.yaxis.label.get_window_extent()
    low, high = axes.get_ylim()
    ticks = [t for t in axes.yaxis.get_major_ticks() if low <= t.get_loc() <= high]
    numbers = [t.label1.get_window_extent() for t in ticks]
    assert label.x0 >= 0.0
    assert label.x1 <= min(box.x0 for box in numbers)
    below = axes.xaxis.label.get_window_extent()
    assert below.y0 >= 0.0
    assert below.y1 <= min(t.get_window_extent().y0 for t in axes.xaxis.get_ticklabels())


def test_labels_name_quantity_and_unit() -> None:
    """Plain text; a raw channel without unit has none."""
    assert Display("pressure_command", "kPa").label == "pressure command (kPa)"
    assert Display("flex", "1").label == "flex"
    assert Display("angle", "deg", 57.3).named("residual") == "residual (deg)"
    assert Display("pressure", "kPa").two_lines == "pressure\n(kPa)"


def test_long_names_are_shortened_in_the_middle() -> None:
    """60 characters fit into a title 1,200 pixels wide; both ends tell logs apart."""
    name = "run_" + 100 * "x" + "_7"
    assert len(shortened(name)) <= 60
    assert shortened(name).startswith("run_")
    assert shortened(name).endswith("_7")
    assert names_and_count(["a", "b"]) == "a, b"
    assert names_and_count([name, name, name]).endswith(" and 2 more")
