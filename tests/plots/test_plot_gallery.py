"""The set of plots of a result, and the residual plots that come from it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade import DEGREE, fit_result, simulation, step_log, validation
from noise import ar1

from softid.plots import draw_all, figures, png_bytes, png_files
from softid.plots.drawings import file_name
from softid.plots.residual_correlation import residual_correlation
from softid.plots.residual_scatter import binned_medians, residual_points, usual_limits
from softid.results import FitResult, ModelSpec, Simulation


def noisy(sim: Simulation, *, sigma: float = 0.01, seed: int = 1) -> Simulation:
    """The same simulation with white residuals."""
    noise = sigma * np.random.default_rng(seed).standard_normal(sim.time_s.size)
    return replace(sim, outputs={"angle": sim.measured["angle"] + noise})


def noisy_fit() -> FitResult:
    result = fit_result()
    sims = tuple(noisy(s, seed=k) for k, s in enumerate(result.simulations))
    return replace(result, simulations=sims)


def test_a_fit_has_its_plots() -> None:
    """One response a log; the step never comes down again, so there are no loops."""
    drawn = figures(noisy_fit())
    assert list(drawn) == [
        "response_step_1",
        "response_step_2",
        "static_curve",
        "damping",
        "residual_correlation",
        "residual_scatter",
        "parameter_correlation",
    ]
    assert all(png_bytes(figure)[:4] == b"\x89PNG" for figure in drawn.values())


def test_titles_name_model_and_logs() -> None:
    """A plot that is passed on without its file name must still say what it shows."""
    drawn = figures(noisy_fit())
    assert drawn["static_curve"].texts[0].get_text() == "Static curve, muscle model: step_1, step_2"
    assert drawn["residual_scatter"].texts[0].get_text() == "Residual, muscle model: step_1"
    assert ", held out" in drawn["response_step_2"].texts[0].get_text()


def test_nothing_held_out() -> None:
    """Only fitted logs: no open markers, no held-out response."""
    result = noisy_fit()
    alone = replace(
        result,
        simulations=result.simulations[:1],
        statistics=result.statistics[:1],
        nuisances=result.nuisances[:1],
    )
    drawn = figures(alone)
    assert [name for name in drawn if name.startswith("response")] == ["response_step_1"]
    legend = [t.get_text() for t in drawn["static_curve"].legends[0].get_texts()]
    assert not any("held out" in text for text in legend)


def test_a_fit_that_failed_has_no_plots() -> None:
    """No simulations, no parameters: an empty table, not an error."""
    empty = replace(
        fit_result(), simulations=(), statistics=(), parameters=(), nuisances=(), correlation=None
    )
    assert figures(empty) == {}


def test_a_perfect_fit_has_no_residual_correlation() -> None:
    """A residual of zero has no correlation; the other plots are drawn."""
    result = fit_result()
    sims = tuple(replace(s, outputs=s.measured) for s in result.simulations)
    drawn = figures(replace(result, simulations=sims))
    assert "residual_correlation" not in drawn
    assert "residual_scatter" in drawn
    assert all(png_bytes(figure) for figure in drawn.values())


def test_a_validation_has_responses_only() -> None:
    """Scores of a fixed model come without covariance."""
    assert list(figures(validation())) == ["response_step_2"]


def test_a_static_model_is_shown_by_branch() -> None:
    """The quartic's plot has a residual panel, and nothing is said about damping."""
    result = noisy_fit()
    values = dict(zip(("p1", "p2", "p3", "p4", "p5"), (0.0, 0.0, 0.0, 0.006, 0.0), strict=True))
    polynomial = replace(
        result,
        model=ModelSpec("polynomial", {"order": 4, "output_unit": "rad", "input_unit": "kPa"}),
        parameters=tuple(
            replace(result.parameters[0], name=name, value=v) for name, v in values.items()
        ),
        free=("p4", "p5"),
    )
    drawn = figures(polynomial)
    assert "damping" not in drawn
    assert len(drawn["static_curve"].axes) == 2
    assert drawn["static_curve"].axes[1].get_xlabel() == "pressure (kPa)"


def test_figures_come_one_by_one() -> None:
    """With hundreds of logs only one figure may be in memory."""
    first, figure = next(draw_all(noisy_fit()))
    assert first == "response_step_1"
    assert figure.axes


def test_files_are_the_plots() -> None:
    """Whoever draws them, in the same order."""
    files = png_files(noisy_fit())
    drawn = figures(noisy_fit())
    assert list(files) == [f"{name}.png" for name in drawn]
    assert files == {f"{name}.png": png_bytes(figure) for name, figure in drawn.items()}


def test_file_names_are_safe_and_different() -> None:
    """No separators; names that differ in case only would collide on some file systems."""
    taken: set[str] = set()
    names = [file_name(n, taken) for n in ("response_a/b:c", "response_a_b_c", "response_A_b_c")]
    assert names == ["response_a_b_c", "response_a_b_c-2", "response_A_b_c-3"]
    assert len(file_name("x" * 500, taken)) <= 104


def test_white_residuals_stay_within_the_white_band() -> None:
    """95 % of the values of white noise lie inside; 85 % is five standard deviations away."""
    log = step_log(samples=3000)
    auto, cross, period_s = residual_correlation([noisy(simulation(log))], "angle")
    assert period_s == pytest.approx(0.02)
    assert auto.lags.size == 31
    assert np.mean(np.abs(auto.values[1:]) < auto.white_band) > 0.85
    assert np.mean(np.abs(cross.values) < cross.band) > 0.85


def test_a_slow_residual_is_shown_until_it_has_died_out() -> None:
    """AR(1) with φ = 0.98 stays correlated for over 100 samples; 30 lags would not show it."""
    log = step_log(samples=6000)
    noise = ar1(np.random.default_rng(2), 6000, 0.98)
    sim = simulation(log)
    sim = replace(sim, outputs={"angle": sim.measured["angle"] + 0.05 * noise})
    auto, _, _ = residual_correlation([sim], "angle")
    assert auto.lags.size > 150
    assert abs(auto.values[-1]) < 0.3


def test_no_pair_of_samples_spans_two_logs() -> None:
    """Offsets +0.1 and −0.1: all 300 pairs at lag 50 agree, and 1 − 50/400 = 0.875 is the taper;
    joined end to end, 50 more pairs would disagree and leave 0.625.
    """
    log = step_log(samples=200)
    up, down = (
        replace(sim, outputs={"angle": sim.outputs["angle"] + offset})
        for sim, offset in ((noisy(simulation(log), sigma=1e-3), 0.1), (simulation(log), -0.11))
    )
    joined, _, _ = residual_correlation([up, down], "angle")
    assert joined.n == 400
    assert joined.values[50] == pytest.approx(0.875, abs=0.01)


def test_scatter_gathers_used_samples_and_their_speed() -> None:
    """A simulated ramp of 0.5 rad/s; three samples are masked; no speed across the stall."""
    log = step_log(samples=100)
    sim = simulation(log)
    used = np.ones(100, bool)
    used[10:13] = False
    time_s = sim.time_s + np.where(np.arange(100) >= 50, 7.0, 0.0)
    ramp = 0.5 * sim.time_s
    sim = replace(
        sim, time_s=time_s, outputs={"angle": ramp}, used={"angle": used}, segment_starts=(0, 50)
    )
    points = residual_points([sim], "angle")
    assert points.residual.size == 97
    assert points.speed == pytest.approx(np.full(97, 0.5))
    assert points.time_s[-1] == pytest.approx(99 * 0.02 + 7.0)


def test_scatter_shows_the_unit_of_the_file() -> None:
    """rad in the arrays, deg and deg/s on the axes."""
    figure = figures(noisy_fit())["residual_scatter"]
    texts = [axes.get_xlabel() for axes in figure.axes]
    assert texts == [
        "simulated angle (deg)",
        "simulated speed (deg/s)",
        "pressure (kPa)",
        "time since the start of the log (s)",
    ]
    half = figure.axes[0].get_ylim()[1]
    assert 0.01 / DEGREE < half < 0.06 / DEGREE


def test_medians_follow_a_law_and_skip_thin_bins() -> None:
    """y = x² exactly, one far point: bins with fewer than five samples say nothing."""
    x = np.append(np.linspace(0.0, 1.0, 500), 10.0)
    centre, median, lower, upper = binned_medians(x, x**2)
    assert centre.max() <= 1.0
    assert median == pytest.approx(centre**2, abs=1e-3)
    assert np.all((lower <= median) & (median <= upper))
    assert binned_medians(np.ones(9), np.ones(9))[0].size == 0


def test_one_wild_speed_does_not_squeeze_the_rest() -> None:
    """999 values within ±1 and one of 1,000."""
    x = np.append(np.linspace(-1.0, 1.0, 999), 1000.0)
    limits = usual_limits(x)
    assert limits is not None
    assert limits[1] < 2.0
    assert usual_limits(np.array([np.nan])) is None
    assert usual_limits(np.ones(5)) is not None
