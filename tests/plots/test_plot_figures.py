"""What the figures over all logs show: curves, levels, loops, residuals, parameters."""

from __future__ import annotations

import numpy as np
import pytest
from legends import labels
from matplotlib.figure import Figure

from softid.plots.branches import draw_branches
from softid.plots.canvas import Display, png_bytes
from softid.plots.damping import draw_damping
from softid.plots.loops import Loop, draw_loops
from softid.plots.parameter_correlation import draw_parameter_correlation
from softid.plots.profile import draw_profile
from softid.plots.static_curve import Levels, draw_static_curve

PRESSURE = Display("pressure", "kPa")
ANGLE = Display("angle", "deg", 180.0 / np.pi)


def levels(name: str, *, in_sample: bool) -> Levels:
    x = np.array([0.0, 40.0, 80.0, 40.0])
    return Levels(name, in_sample, x, 0.01 * x, np.array([0, 1, 1, -1], np.int8), x, 0.01 * x)


def drawn_static(*logs: Levels) -> Figure:
    x = np.linspace(0.0, 120.0, 121)
    return draw_static_curve(
        x, 0.01 * x, logs, fitted_range=(10.0, 80.0), input=PRESSURE, output=ANGLE
    )


def test_static_curve_is_solid_where_fitted_and_dashed_beyond() -> None:
    """Fitted 10 to 80 kPa of a curve over 0 to 120: every point is in one of the two lines."""
    figure = drawn_static(levels("a", in_sample=True))
    (axes,) = figure.axes
    solid, dashed = (
        next(line for line in axes.lines if line.get_label() == name)
        for name in ("model at rest", "extrapolated")
    )
    y, beyond = np.asarray(solid.get_ydata()), np.asarray(dashed.get_ydata())
    x = np.asarray(solid.get_xdata())
    assert np.array_equal(np.isfinite(y), (x >= 10) & (x <= 80))
    assert (np.isfinite(y) | np.isfinite(beyond)).all()
    assert y[50] == pytest.approx(0.5 * 180 / np.pi)
    assert dashed.get_linestyle() == "--"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("pressure (kPa)", "angle (deg)")


def test_levels_differ_by_shape_and_filling() -> None:
    """Grey print: up, down and first by marker; fitted and held out by filling."""
    figure = drawn_static(levels("a", in_sample=True), levels("b", in_sample=False))
    marked = [line for line in figure.axes[0].lines if line.get_marker() in "^vo"]
    looks = {(line.get_marker(), line.get_markerfacecolor() == "white") for line in marked}
    assert looks == {(m, open_) for m in "^vo" for open_ in (False, True)}
    assert labels(figure).count("open: held out") == 1
    png_bytes(figure)


def test_static_curve_without_logs_is_drawn() -> None:
    """The curve alone, as from a saved model."""
    assert "settled after a rise" not in labels(drawn_static())


def test_a_curve_that_explodes_does_not_flatten_the_levels() -> None:
    """exp(p/3) reaches e⁴⁰ at 120 kPa; levels reach 0.8 rad = 46 deg."""
    x = np.linspace(0.0, 120.0, 121)
    figure = draw_static_curve(
        x,
        np.exp(x / 3),
        [levels("a", in_sample=True)],
        fitted_range=(0.0, 80.0),
        input=PRESSURE,
        output=ANGLE,
    )
    assert figure.axes[0].get_ylim()[1] < 110.0


def test_a_curve_far_from_all_levels_is_said_to_be_elsewhere() -> None:
    """At 1e9 rad it is on no readable axis: the levels fill the plot, and the legend says why."""
    x = np.linspace(0.0, 120.0, 121)
    figure = draw_static_curve(
        x,
        1e9 + x,
        [levels("a", in_sample=True)],
        fitted_range=(0.0, 80.0),
        input=PRESSURE,
        output=ANGLE,
    )
    assert figure.axes[0].get_ylim()[1] < 60.0
    assert "model at rest, out of the plot" in labels(figure)
    assert "extrapolated" not in labels(figure)


@pytest.mark.parametrize(
    ("factor", "scale"), [(1.2, "linear"), (30.0, "log"), (1e9, "log"), (np.inf, "log")]
)
def test_damping_band_chooses_its_axis(factor: float, scale: str) -> None:
    """A band of ±20 % is read on a linear axis, one of several decades on a logarithmic one."""
    p = np.linspace(0.0, 300.0, 61)
    n = 0.3 + 0.01 * np.exp(p / 100)
    figure = draw_damping(
        p, n, (n / factor, n * factor), fitted_range_kpa=(0.0, 280.0), unit="s/mm"
    )
    (axes,) = figure.axes
    assert axes.get_yscale() == scale
    assert axes.get_ylabel() == "damping N (s/mm)"
    assert ("95 % band, wider than the plot" in labels(figure)) is (factor > 1e3)
    low, high = axes.get_ylim()
    assert low <= n.min()
    assert high >= n[p <= 280].max()
    assert high < 1e4 * n.max()
    png_bytes(figure)


def test_damping_without_band_says_so() -> None:
    """An unknown band must not look like a perfect one."""
    p = np.linspace(0.0, 300.0, 61)
    figure = draw_damping(p, 0.3 + 0 * p, None, fitted_range_kpa=(0.0, 280.0), unit="s/mm")
    assert any("no band" in text for text in labels(figure))
    assert "95 % band" not in labels(figure)


def test_loops_are_styled_by_rate() -> None:
    """Two rates: two colours and two dash patterns, the same in both panels; NaN is dropped."""
    phase = np.linspace(0.0, 2 * np.pi, 200)
    u = 50.0 - 50.0 * np.cos(phase)
    y = 0.01 * u + 0.1 * np.sin(phase)
    y[:10] = np.nan
    loops = [Loop(rate, u, y, 0.01 * u) for rate in (0.1, 0.1, 0.5)]
    figure = draw_loops(loops, input=PRESSURE, output=ANGLE)
    assert labels(figure) == ["0.1 Hz, 2 cycles", "0.5 Hz, 1 cycle"]
    left, right = figure.axes
    assert left.get_ylabel() == "angle (deg)"
    looks = [{(ln.get_color(), ln.get_linestyle()) for ln in axes.lines} for axes in (left, right)]
    assert len(looks[0]) == 2
    assert looks[0] < looks[1]
    assert all(np.isfinite(np.asarray(ln.get_ydata())).all() for ln in left.lines)
    assert left.get_xlim() == right.get_xlim()
    assert left.get_ylim() == right.get_ylim()
    png_bytes(figure)


def test_branches_show_points_curve_and_residual() -> None:
    """Rising points 0.1 rad above, falling 0.1 below the curve: so are the residuals, in deg."""
    u = np.concatenate([np.linspace(0, 80, 50), np.linspace(80, 0, 50)])
    model = 0.02 * u
    rising = np.arange(100) < 50
    measured = model + np.where(rising, 0.1, -0.1)
    measured[3] = np.nan
    grid = np.linspace(0, 80, 21)
    figure = draw_branches(
        u, measured, model, rising, grid, 0.02 * grid, input=PRESSURE, output=ANGLE
    )
    main, below = figure.axes
    assert labels(figure) == ["rising", "falling", "model"]
    up, down = (np.asarray(line.get_ydata()) for line in below.lines[:2])
    assert up == pytest.approx(np.full(49, 0.1 * ANGLE.factor))
    assert down == pytest.approx(np.full(50, -0.1 * ANGLE.factor))
    assert below.get_ylabel() == "residual (deg)"
    curve = main.lines[-1]
    assert np.asarray(curve.get_xdata()).max() == 80.0
    png_bytes(figure)


def test_parameter_correlation_writes_sign_and_error() -> None:
    """The numbers as given: −0.98, and errors of 33 % and unknown."""
    matrix = np.array([[1.0, -0.98], [-0.98, 1.0]])
    figure = draw_parameter_correlation(matrix, ("a2", "b2"), relative_errors=(0.33, None))
    written = [text.get_text() for text in figure.axes[0].texts]
    assert "−0.98" in written
    assert "±33 %" in written
    assert "±?" in written
    names = [t.get_text() for t in figure.axes[0].get_yticklabels()]
    assert names == ["a2", "b2"]
    png_bytes(figure)


def test_shades_grow_darker_with_the_correlation() -> None:
    """Grey print: strength is lightness, whatever the sign."""
    matrix = np.array([[1.0, -0.9, 0.2], [-0.9, 1.0, 0.5], [0.2, 0.5, 1.0]])
    figure = draw_parameter_correlation(matrix, ("a", "b", "c"))
    png_bytes(figure)
    mesh = figure.axes[0].collections[0]
    shades = mesh.get_facecolor().reshape(3, 3, 4)[:, :, 0]
    assert shades[1, 0] < shades[2, 1] < shades[2, 0]


def test_between_its_points_a_profile_is_a_parabola() -> None:
    """Three points of (v − 3)²: straight lines would be off by 1 half-way to either side."""
    figure = draw_profile(
        np.array([1.0, 3.0, 5.0]), np.array([4.0, 0.0, 4.0]), name="b2", unit="", threshold=4.0
    )
    drawn = max(figure.axes[0].lines, key=lambda line: len(line.get_xdata()))
    v, rise = np.asarray(drawn.get_xdata()), np.asarray(drawn.get_ydata())
    assert v.size > 20
    np.testing.assert_allclose(rise, (v - 3.0) ** 2, atol=1e-12)


def test_profile_shows_threshold_and_interval() -> None:
    """A parabola over a log-scaled parameter; the lower side has no end and says so."""
    values = np.geomspace(1e-5, 1e-2, 13)
    rise = np.where(values > 1e-4, np.log(values / 1e-4) ** 2, 0.2)
    rise[-1] = np.inf
    figure = draw_profile(
        values,
        rise,
        name="M",
        unit="s²/mm",
        threshold=3.84,
        estimate=1e-4,
        ci95=(None, 7e-4),
    )
    (axes,) = figure.axes
    assert axes.get_xlabel() == "M (s²/mm)"
    assert axes.get_xscale() == "log"
    assert np.asarray(axes.lines[0].get_ydata()).size == 12
    assert any(np.allclose(line.get_ydata(), 3.84) for line in axes.lines[1:])
    assert any("open below" in text for text in labels(figure))
    assert axes.get_ylim()[1] > 3.84
    png_bytes(figure)
