"""What the figure of a spread and the figure of several series show."""

from __future__ import annotations

import numpy as np
import pytest

from softid.plots.canvas import Display, png_bytes
from softid.plots.curves_and_points import Series, draw_series
from softid.plots.picture import Picture
from softid.plots.spread import draw_spread

PRESSURE = Display("pressure", "kPa")


def test_every_draw_is_a_point_and_the_numbers_are_told() -> None:
    """Estimates 1, 2, 3, −2 about a truth of 2: mean 1, sd √(14/3), one in four not positive."""
    figure = draw_spread(
        {"one way": np.array([1.0, 2.0, 3.0, -2.0]), "other": np.array([2.0, 2.1, 2.0, 2.0])},
        truth=2.0,
        quantity=Display("M", "s²", 10.0),
    )
    (axes,) = figure.axes
    clouds = [line for line in axes.lines if line.get_marker() == "o"]
    assert clouds[0].get_xdata().tolist() == [10.0, 20.0, 30.0, -20.0]
    means = [line.get_xdata()[0] for line in axes.lines if line.get_marker() == "D"]
    assert means == pytest.approx([10.0, 20.25])
    texts = [text.get_text() for text in axes.texts]
    assert texts[0] == "bias -10 ± 11 s², sd 22 s², 25 % not positive"
    assert "not positive" not in texts[1]
    assert axes.get_xlabel() == "M (s²)"


def test_series_keep_their_order_and_units() -> None:
    """Two curves in different dashes, points as markers, values times the factor of the axis."""
    series = [
        Series("a", [0.0, 100.0], [1.0, 2.0]),
        Series("b", [0.0, 100.0], [2.0, 3.0]),
        Series("c", [50.0], [1.5], points=True),
    ]
    figure = draw_series(
        series,
        x=Display("pressure", "bar", 0.01),
        y=Display("angle", "rad"),
        title="t",
        vertical=(80.0,),
        from_zero=True,
    )
    (axes,) = figure.axes
    first, second, points, border = axes.lines
    assert first.get_xdata().tolist() == [0.0, 1.0]
    assert first.get_linestyle() != second.get_linestyle()
    assert points.get_linestyle() == "None"
    assert border.get_xdata()[0] == pytest.approx(0.8)
    assert axes.get_ylim()[0] == 0.0
    assert [t.get_text() for t in figure.legends[0].get_texts()] == ["a", "b", "c"]


def test_the_label_of_a_logarithmic_axis_stays_on_the_paper() -> None:
    """Decades as plain numbers: their markup would push the label off the left edge."""
    figure = draw_series(
        [Series("a", [0.0, 1.0], [1e-3, 1e3])], x=PRESSURE, y=PRESSURE, title="t", log_y=True
    )
    png_bytes(figure)
    (axes,) = figure.axes
    box = axes.yaxis.label.get_window_extent()
    assert box.x0 >= 0.0


def test_a_picture_is_the_png_of_its_figure() -> None:
    """Stands on the signature of PNG."""
    figure = draw_series([Series("a", [0.0, 1.0], [0.0, 1.0])], x=PRESSURE, y=PRESSURE, title="t")
    assert Picture(figure)._repr_png_() == png_bytes(figure)
