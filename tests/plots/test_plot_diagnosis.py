"""Plots of a diagnosis: which there are, what they say, and the numbers behind them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_rig import cause, diagnosis, rmse

from softid.diagnosis_results import Alternative, Diagnosis, Evidence, Verdict
from softid.plots import png_bytes, png_files
from softid.plots.canvas import Display
from softid.plots.chain import draw_chain
from softid.plots.diagnosis_gallery import (
    chain_figure,
    diagnosis_figures,
    taken_candidates,
    tied_candidates,
)
from softid.plots.evidence import draw_evidence, row_order
from softid.plots.loop_area import loop_width, medians_by_rate
from softid.plots.what_is_left import running_mean


@pytest.fixture(scope="module")
def named() -> Diagnosis:
    """Hysteresis hidden and named."""
    return diagnosis()


def test_a_named_cause_has_its_plots(named: Diagnosis) -> None:
    """Seven at most, the held-out log first; each renders."""
    drawn = dict(diagnosis_figures(named))
    assert list(drawn) == [
        "before_after_cycles_2",
        "before_after_cycles_1",
        "what_is_left",
        "loop_area",
        "evidence",
        "chain",
    ]
    assert png_files(named) == {f"{name}.png": png_bytes(f) for name, f in drawn.items()}


def test_nothing_named(named: Diagnosis) -> None:
    """Without an extension there is no chain, and the rest shows the base alone."""
    alone = replace(named, verdict=Verdict.ADEQUATE, extended=None, causes=(), alternatives=())
    drawn = dict(diagnosis_figures(alone))
    assert "chain" not in drawn
    labels = [t.get_text() for t in drawn["what_is_left"].legends[0].get_texts()]
    assert labels[:2] == ["base model", "base model, running mean"]
    assert not any("extended" in label for label in labels)


def test_no_cycles_no_loops(named: Diagnosis) -> None:
    """An input that only rises makes no loop, so that plot is left out."""
    rising = [replace(s, input=np.sort(s.input)) for s in named.base.simulations]
    base = replace(named.base, simulations=tuple(rising))
    assert "loop_area" not in dict(diagnosis_figures(replace(named, base=base)))


def test_at_most_seven(named: Diagnosis) -> None:
    """Ten logs give three plots of logs, not ten: a reader looks at few pictures."""
    sims, scores = named.base.simulations[:1] * 10, named.base.statistics[:1] * 10
    base = replace(
        named.base,
        simulations=tuple(replace(s, log=f"log_{k}") for k, s in enumerate(sims)),
        statistics=tuple(replace(s, log=f"log_{k}") for k, s in enumerate(scores)),
    )
    assert len(list(diagnosis_figures(replace(named, base=base, extended=None)))) <= 7


def test_legend_tells_the_fits(named: Diagnosis) -> None:
    """The numbers are those of the scores, to one decimal."""
    assert named.extended is not None
    figure = dict(diagnosis_figures(named))["before_after_cycles_2"]
    labels = [t.get_text() for t in figure.legends[0].get_texts()]
    before, after = (
        next(s.fit_percent for s in fit.statistics if not s.in_sample)
        for fit in (named.base, named.extended)
    )
    assert labels[1:] == [f"base, fit {before:.1f} %", f"with hysteresis, fit {after:.1f} %"]


def test_extended_fit_shrinks_the_loop(named: Diagnosis) -> None:
    """The rig hides a loop that the base cannot make: the residual's spread falls below half."""
    assert named.extended is not None
    assert rmse(named.extended) < 0.6 * rmse(named.base)


def test_marks_of_the_evidence(named: Diagnosis) -> None:
    """The link is marked in its round, its rival there too, and nothing in the round after."""
    chosen = taken_candidates(named)
    assert chosen == {(1, "hysteresis")}
    assert tied_candidates(named, chosen) == {(1, "delay")}


def test_of_a_tied_name_the_best_variant_is_marked(named: Diagnosis) -> None:
    """An alternative is a name without variant; a variant far behind is no rival."""
    tie = Alternative(("hysteresis", "sensor_clipping"), {}, "")
    evidence = (
        Evidence(1, "hysteresis", 100.0, 0.9),
        Evidence(1, "sensor_clipping", 98.0, 0.9),
        Evidence(1, "sensor_clipping.both", 20.0, 0.3),
    )
    found = replace(named, evidence=evidence, alternatives=(tie,))
    assert tied_candidates(found, taken_candidates(found)) == {(1, "sensor_clipping")}


def test_rows_out_of_the_race_come_last() -> None:
    """A share of the drop is no BIC: whatever raced stands above it, even when it lost."""
    evidence = [
        Evidence(1, "a", None, 0.9),
        Evidence(1, "b", -40.0, 0.0),
        Evidence(1, "c", 30.0, 0.5),
        Evidence(1, "d", -60.0, 0.0),
        Evidence(2, "b", 50.0, 0.1),
    ]
    assert row_order(evidence, [1, 2]) == ["b", "c", "d", "a"]


def test_ticks_of_a_round_end_before_the_next_one() -> None:
    """Two rounds side by side; the room for a bar's number has no ticks."""
    figure = draw_evidence([Evidence(k, key, 300.0, 0.5) for k in (1, 2) for key in ("a", "b")])
    for axes in figure.axes:
        assert max(axes.get_xticks()) <= 300.0 < axes.get_xlim()[1]


def test_interval_of_the_chain() -> None:
    """The bar spans before · (1 − gain): 2 rad, gain 0.42 to 0.55 in degrees times two."""
    figure = draw_chain([cause("delay", 2.0, 1.0)], output=Display("angle", "x", 2.0))
    (bar,) = figure.axes[0].collections
    ends = np.sort(bar.get_segments()[0][:, 1])
    np.testing.assert_allclose(ends, [2.0 * 2.0 * 0.45, 2.0 * 2.0 * 0.58], rtol=1e-12)


def test_a_bar_of_the_chain_ends_where_the_error_has_doubled() -> None:
    """An interval of few independent samples may reach hundreds of times the error."""
    unsure = replace(cause("delay", 2.0, 1.0), gain_ci95=(-259.2, 0.9))
    figure = draw_chain([unsure], output=Display("angle", "x", 1.0))
    (bar,) = figure.axes[0].collections
    np.testing.assert_allclose(np.sort(bar.get_segments()[0][:, 1]), [0.2, 4.0], rtol=1e-12)
    assert figure.axes[0].get_ylim()[1] < 6.0


def test_a_step_of_the_chain_names_all_that_it_may_be() -> None:
    """A tie is told where its link is, and descriptions are laws, not causes."""
    figure = draw_chain(
        [cause("creep", 2.0, 1.0), cause("delay", 1.0, 0.5)],
        output=Display("angle", "x", 1.0),
        tied={"creep": ("creep", "contact")},
        step="law",
    )
    (axes,) = figure.axes
    names = [" ".join(tick.get_text().split()) for tick in axes.get_xticklabels()]
    assert names == ["base model", "+ creep or contact", "+ delay"]
    assert axes.get_xlabel() == "model, one law more at each step"


def test_a_description_between_causes_has_its_step(named: Diagnosis) -> None:
    """The links stand in the order of the chain, and each falls from where the one before ended."""
    first = replace(cause("hysteresis", 2.0, 1.0), added_to=())
    creep = replace(cause("creep", 1.0, 0.5), added_to=("hysteresis",))
    last = replace(cause("ageing", 0.5, 0.25), added_to=("hysteresis", "creep"))
    links = replace(named, causes=(last, first), descriptive=(creep,), alternatives=())
    figure = chain_figure(links)
    assert figure is not None
    (axes,) = figure.axes
    names = [" ".join(tick.get_text().split()) for tick in axes.get_xticklabels()]
    assert names[1:] == ["+ hysteresis", "+ creep (description)", "+ ageing"]
    heights = np.asarray(axes.lines[0].get_ydata())
    np.testing.assert_allclose(heights / heights[0], [1.0, 0.5, 0.25, 0.125])
    assert png_bytes(figure)[:4] == b"\x89PNG"


def test_a_chain_goes_past_a_model_without_a_response() -> None:
    """The point is left out, its step says why, and the axis ends above the others."""
    lost = replace(cause("creep", 2.0, np.nan), gain_ci95=None)
    after = replace(cause("delay", np.nan, 0.5), gain_ci95=None)
    figure = draw_chain([lost, after], output=Display("angle", "x", 1.0))
    (axes,) = figure.axes
    assert [text.get_text() for text in axes.texts][1] == "no response"
    assert 2.0 < axes.get_ylim()[1] < 4.0
    assert png_bytes(figure)[:4] == b"\x89PNG"


@pytest.mark.parametrize("phase", [0.0, 0.3, -0.3])
def test_width_of_an_ellipse(phase: float) -> None:
    """∮ u dy of two sines is π sin φ, their span 2; the polygon errs by (2π/n)²/6, 2e-6."""
    turn = np.linspace(0.0, 2.0 * np.pi, 2001)
    width = loop_width(np.sin(turn), np.sin(turn - phase))
    assert width == pytest.approx(0.5 * np.pi * np.sin(phase), rel=1e-5, abs=1e-12)


def test_width_without_motion_or_samples() -> None:
    """A still input has no span, and a few samples have no loop."""
    assert loop_width(np.ones(50), np.arange(50.0)) is None
    assert loop_width(np.arange(50.0), np.full(50, np.nan)) is None


def test_medians_join_rates_within_a_quarter() -> None:
    """0.10 and 0.12 Hz are one rate, 0.13 Hz is beyond 1.25 times the slowest."""
    centre, median = medians_by_rate(np.array([0.13, 0.1, 0.12]), np.array([7.0, 1.0, 3.0]))
    np.testing.assert_allclose(centre, [0.11, 0.13])
    np.testing.assert_allclose(median, [2.0, 7.0])


def test_running_mean_of_a_line() -> None:
    """Inside, the mean of a line over a window is the line; where few samples are, nothing."""
    x = np.concatenate((np.linspace(0.0, 1.0, 2001), [2.0]))
    where, mean = running_mean(x, 3.0 * x)
    inside = (where > 0.1) & (where < 0.9)
    np.testing.assert_allclose(mean[inside], 3.0 * where[inside], atol=3e-3)
    assert np.isnan(mean[where > 1.2]).all()
