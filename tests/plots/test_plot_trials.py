"""Panels of trials and the phase portrait: what they hold, and when they are drawn."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from softid.identification import fit
from softid.models.equilibrium import Equilibrium
from softid.plots import Display, Trial, draw_phase_portrait, draw_trials, figures
from softid.plots.equilibrium_trials import (
    damping_trials,
    mass_trials,
    phase_curves,
    subject_of,
)
from softid.readers import load
from softid.results import FitResult
from softid.synthesis import bundled_datasets

DATA = bundled_datasets() / "data"
DEGREES = Display("angle", "deg", 180 / np.pi)


@pytest.fixture(scope="module")
def fitted() -> FitResult:
    return fit(load(DATA / "equilibrium_20.csv"), model="equilibrium")


def shown(figure: Figure) -> list[str]:
    return [text.get_text() for axes in figure.axes for text in axes.texts]


@pytest.mark.parametrize("count", [2, 4])
def test_panels_share_axes_that_hold_the_record(count: int) -> None:
    """A runaway of ten spans is cut at one span above the record, with a sixth to spare."""
    time_s = np.linspace(0.0, 1.0, 50)
    measured = np.linspace(0.0, 0.5, 50)
    trials = [Trial(f"trial {k}", measured * (10.0 if k == 0 else 1.0)) for k in range(count)]
    figure = draw_trials(time_s, measured, trials, output=DEGREES, title="Trials")
    assert len(figure.axes) == count
    limits = {axes.get_ylim() for axes in figure.axes}
    assert len(limits) == 1
    low, high = next(iter(limits))
    assert high == pytest.approx(np.rad2deg(0.5 + 0.5 + 0.15 * 0.5))
    assert low == pytest.approx(np.rad2deg(-0.15 * 0.5))
    assert shown(figure)[0] == "(a) trial 0"


def test_the_trials_are_those_of_the_paper(fitted: FitResult) -> None:
    """No damping swings on, a quarter swings more, overdamped not at all, and all end alike; the
    last trial is the fit itself."""
    (simulation,) = fitted.simulations
    subject = subject_of(Equilibrium(), fitted, simulation, "angle")
    assert subject is not None
    none, small, large, best = (trial.simulated for trial in damping_trials(subject))
    np.testing.assert_allclose(best, simulation.outputs["angle"], atol=1e-12)
    late = slice(-200, None)
    assert np.ptp(none[late]) > 0.5 * np.ptp(none)
    assert np.ptp(best[late]) < np.ptp(small[late]) < np.ptp(none[late])
    assert large.max() < best[-1] + 0.01
    assert large[-1] == pytest.approx(best[-1], abs=0.01)
    plain, compensated = (trial.simulated for trial in mass_trials(subject))
    left = [np.nanstd(subject.measured - y) for y in (plain, compensated)]
    assert left[0] > 5.0 * left[1]


def test_the_phase_portrait_is_the_motion(fitted: FitResult) -> None:
    """From rest to rest, and the measured rate within a few per cent of the largest simulated."""
    (simulation,) = fitted.simulations
    subject = subject_of(Equilibrium(), fitted, simulation, "angle")
    assert subject is not None
    angle, rate, measured, slope = phase_curves(subject)
    assert rate[0] == pytest.approx(0.0, abs=0.05)
    assert abs(rate[-1]) < 0.05
    assert slope.max() == pytest.approx(rate.max(), rel=0.06)
    assert measured.max() == pytest.approx(angle.max(), rel=0.02)
    figure = draw_phase_portrait(angle, rate, measured, slope, output=DEGREES, title="Phase")
    assert figure.axes[0].get_xlabel() == "angle (deg)"
    assert figure.axes[0].get_ylabel() == "angle rate (deg/s)"


def test_they_come_with_an_equilibrium_fit_only(fitted: FitResult) -> None:
    """Other models have no C_d and no C_m."""
    names = {"damping_trials", "mass_trials", "phase_portrait"}
    assert names <= set(figures(fitted))
    other = fit(load(DATA / "oscillator_steps.csv"), model="oscillator")
    assert not names & set(figures(other))
