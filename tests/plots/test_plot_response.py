"""Measured against simulated over time."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from handmade import DEGREE, simulation, statistics, step_log
from legends import labels
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softid.plots.canvas import png_bytes
from softid.plots.response import draw_response, residual_reach
from softid.results import FitStatistics, Simulation

Array = np.ndarray


def panels(figure: Figure) -> tuple[Axes, Axes, Axes]:
    top, main, below = figure.axes
    return top, main, below


def line(axes: Axes, start: str) -> tuple[Array, Array]:
    """Points of the only line whose legend label starts so."""
    (found,) = [drawn for drawn in axes.lines if str(drawn.get_label()).startswith(start)]
    return np.asarray(found.get_xdata()), np.asarray(found.get_ydata())


@pytest.fixture
def drawn() -> tuple[Simulation, FitStatistics, Figure]:
    sim, score = simulation(step_log("step_1")), statistics("step_1", in_sample=True)
    return sim, score, draw_response(sim, score)


def test_outputs_are_shown_in_the_unit_of_the_file(
    drawn: tuple[Simulation, FitStatistics, Figure],
) -> None:
    """Definition: 1 rad is 180/π deg; the arrays hold rad, the file recorded deg."""
    sim, _, figure = drawn
    _, main, below = panels(figure)
    assert np.allclose(line(main, "measured")[1], sim.measured["angle"] / DEGREE)
    assert np.allclose(line(main, "simulated")[1], sim.outputs["angle"] / DEGREE)
    residual = below.lines[-1].get_ydata()
    assert np.allclose(residual, -0.01 / DEGREE)


def test_axes_name_quantity_and_unit(drawn: tuple[Simulation, FitStatistics, Figure]) -> None:
    """What a reader needs on paper."""
    top, main, below = panels(drawn[2])
    assert top.get_ylabel() == "pressure\n(kPa)"
    assert main.get_ylabel() == "angle (deg)"
    assert below.get_ylabel() == "residual (deg)"
    assert below.get_xlabel() == "time (s)"


def test_legend_and_title_say_fit_and_role(
    drawn: tuple[Simulation, FitStatistics, Figure],
) -> None:
    """91.25 % and 0.01 rad = 0.573 deg, from the handmade statistics."""
    sim, _, figure = drawn
    assert labels(figure) == ["measured", "simulated, fit 91.2 %"]
    assert figure.texts[0].get_text() == "step_1, fitted: fit 91.2 %, rmse 0.573 deg"
    held = draw_response(sim, statistics("step_1", in_sample=False), fitted_range=(0.0, 60.0))
    assert ", held out: " in held.texts[0].get_text()
    assert "range of the fitted input" in labels(held)


def test_a_held_out_log_is_dashed(drawn: tuple[Simulation, FitStatistics, Figure]) -> None:
    """The role must survive a grey print, so it is a line style."""
    sim, _, figure = drawn
    held = draw_response(sim, statistics("step_1", in_sample=False))
    styles = [panels(f)[1].lines[-1].get_linestyle() for f in (figure, held)]
    assert styles == ["-", "--"]


def test_the_residual_lies_below_its_cause(
    drawn: tuple[Simulation, FitStatistics, Figure],
) -> None:
    """All panels share the time axis, input on top, residual at the bottom."""
    top, main, below = panels(drawn[2])
    assert top.get_xlim() == main.get_xlim() == below.get_xlim()
    heights = [axes.get_position().y0 for axes in (top, main, below)]
    assert heights == sorted(heights, reverse=True)
    assert below.get_ylim()[0] == -below.get_ylim()[1]


def with_stall(sim: Simulation) -> Simulation:
    """The same log with a stall of 5 s before sample 30."""
    shifted = sim.time_s + np.where(np.arange(sim.time_s.size) >= 30, 5.0, 0.0)
    return replace(sim, time_s=shifted, segment_starts=(0, 30))


def test_lines_break_at_a_stall_which_is_marked(
    drawn: tuple[Simulation, FitStatistics, Figure],
) -> None:
    """One NaN in every line, and a hatched band from sample 29 to sample 30 in every panel."""
    sim = with_stall(drawn[0])
    figure = draw_response(sim, drawn[1])
    for axes in panels(figure):
        assert int(np.isnan(np.asarray(axes.lines[-1].get_ydata())).sum()) == 1
        (band,) = axes.collections
        spots = band.get_paths()[0].vertices[:, 0]
        assert (spots.min(), spots.max()) == pytest.approx((sim.time_s[29], sim.time_s[30]))
    assert "stall" in labels(figure)


def test_missing_and_left_out_samples(drawn: tuple[Simulation, FitStatistics, Figure]) -> None:
    """NaN is not drawn; a masked sample is drawn, marked, and out of the residual."""
    sim = drawn[0]
    measured = sim.measured["angle"].copy()
    measured[:5] = np.nan
    used = np.isfinite(measured)
    used[20:23] = False
    sim = replace(sim, measured={"angle": measured}, used={"angle": used})
    figure = draw_response(sim, drawn[1])
    _, main, below = panels(figure)
    assert line(main, "measured")[1].size == measured.size - 5
    marked = line(main, "left out")
    assert np.allclose(marked[0], sim.time_s[20:23])
    assert np.asarray(below.lines[-1].get_ydata()).size == measured.size - 8
    png_bytes(figure)


def test_a_log_that_holds_nothing_is_drawn(
    drawn: tuple[Simulation, FitStatistics, Figure],
) -> None:
    """All output samples missing: input and simulation are still worth a look."""
    sim = drawn[0]
    nothing = np.full(sim.time_s.size, np.nan)
    empty = replace(
        sim, measured={"angle": nothing}, used={"angle": np.zeros(sim.time_s.size, bool)}
    )
    score = replace(drawn[1], fit_percent=float("nan"))
    figure = draw_response(empty, score)
    assert "undefined" in figure.texts[0].get_text()
    png_bytes(figure)


def test_a_simulation_that_runs_away_does_not_flatten_the_measurement(
    drawn: tuple[Simulation, FitStatistics, Figure],
) -> None:
    """The plot widens by at most one span of the measurement (30 deg), and says so."""
    sim = drawn[0]
    wild = replace(sim, outputs={"angle": sim.outputs["angle"] * 1e6})
    figure = draw_response(wild, drawn[1])
    low, high = panels(figure)[1].get_ylim()
    assert high - low < 3.5 * 30.0
    assert any("runs out of the plot" in text for text in labels(figure))


def test_spikes_do_not_hide_the_residual() -> None:
    """Two drop-outs of 100 in noise of 1: the plot shows ± a few, and counts them."""
    residual = np.random.default_rng(3).standard_normal(1000)
    assert residual_reach(residual)[1] == 0
    residual[[10, 700]] = -100.0
    half, beyond = residual_reach(residual)
    assert 3.0 < half < 10.0
    assert beyond == 2
    assert residual_reach(np.array([np.nan])) == (1.0, 0)


def test_a_hundred_thousand_samples_draw_within_a_second() -> None:
    """The aim is 1 s of processor time; thinned lines have at most four points a pixel column."""
    n = 100_000
    time_s = np.arange(n) * 0.001
    measured = np.sin(time_s) + 0.1 * np.random.default_rng(4).standard_normal(n)
    measured[500] = 7.0
    sim = Simulation(
        log="long",
        time_s=time_s,
        input_name="pressure",
        input=measured,
        input_unit="kPa",
        outputs={"angle": np.sin(time_s)},
        measured={"angle": measured},
        used={"angle": np.ones(n, bool)},
        units={"angle": "rad"},
    )
    begin = time.process_time()
    figure = draw_response(sim, statistics("long", in_sample=True))
    png_bytes(figure)
    assert time.process_time() - begin < 1.0
    y = line(panels(figure)[1], "measured")[1]
    assert y.size <= 4000
    assert y.max() == pytest.approx(7.0 / DEGREE)
