"""Fits that start with the beginnings of the logs."""

from __future__ import annotations

import numpy as np
import pytest

import softid.fitters.rivals as rivals
from softid.fitters.beginnings import beginning_of, informative_beginning, optima_by_beginnings
from softid.fitters.objective import Objective
from softid.fitters.output_error import output_error
from softid.fitters.problem import Problem
from softid.log import Log
from softid.models.muscle import Muscle
from softid.synthesis import muscle_log
from softid.synthesis.waveforms import Sine, Steps

LEVELS = (0.0, 60.0, 120.0, 180.0, 240.0, 300.0, 210.0, 150.0, 90.0, 30.0, 0.0)
HARDENING = {
    "M": 0.2162,
    "a1": 0.006285,
    "b1": 5.025,
    "c1": 0.1394,
    "a2": 0.2319,
    "b2": -1.234,
    "c2": 0.003835,
}
"""Damping ratio 0.66 at 0.13 Hz without pressure, 0.0002 at 24 Hz at 270 kPa."""


def hardening(frequency_hz: float) -> Problem:
    """The muscle over steps and a sine."""
    sine = Sine(0.0, 240.0, frequency_hz, 4)
    made = [
        muscle_log(HARDENING, excitation, seed=k, name=f"log_{k}", noise_mm=0.9).to_log()
        for k, excitation in enumerate((Steps(LEVELS, 2.0), sine))
    ]
    return Problem(Muscle(), Muscle().parameters(), made)


@pytest.fixture(scope="module")
def whole() -> Problem:
    return hardening(0.5)


def test_a_beginning_has_the_unknowns_of_the_whole(whole: Problem) -> None:
    """The first quarter of every segment, and the same residual there, to a hundred-thousandth of
    the range of 190 mm: how an interval is divided depends on the fastest motion of its segment."""
    part = beginning_of(whole, 0.25)
    assert part.size == whole.size
    z = whole.unknowns(HARDENING)
    for short, full in zip(
        part.blocks(z, derivatives=False), whole.blocks(z, derivatives=False), strict=True
    ):
        count = round(0.25 * full.residual.size)
        assert short.residual.size == count
        np.testing.assert_allclose(short.residual, full.residual[:count], atol=2e-3)


def test_a_beginning_of_a_short_log_is_all_of_it() -> None:
    """Fifty samples at least, or as many as there are."""
    log = muscle_log(HARDENING, Steps((0.0, 60.0), 0.2), seed=0, name="short").to_log()
    problem = Problem(Muscle(), Muscle().parameters(), [log])
    assert beginning_of(problem, 0.1).n_samples == min(50, problem.n_samples)


def test_a_beginning_that_tells_enough_is_no_longer_than_needed(whole: Problem) -> None:
    """Itself where there are no more samples than are asked for."""
    assert informative_beginning(whole, whole.n_samples) is whole
    part = informative_beginning(whole, 500)
    assert 500 <= part.n_samples < 0.6 * whole.n_samples


@pytest.mark.parametrize(("rest_s", "least"), [(0.0, 200), (12.0, 1200)])
def test_a_beginning_at_rest_tells_nothing(rest_s: float, least: int) -> None:
    """A log of 100 Hz that rests for so long, of which 200 samples would do elsewhere."""
    time_s = np.arange(0.0, 20.0, 0.01)
    pressure = 100.0 * (1.0 - np.cos(2.0 * np.pi * np.maximum(time_s - rest_s, 0.0)))
    data = {"pressure": pressure, "contraction": 0.1 * pressure}
    problem = Problem(Muscle(), Muscle().parameters(), [Log.from_arrays(time_s, data)])
    part = informative_beginning(problem, 200)
    assert least <= part.n_samples <= 1.4 * least


def test_the_beginning_leads_to_the_optimum(whole: Problem) -> None:
    """As good as a start at the truth, to a thousandth of its cost."""
    sigma = {"contraction": 1.0}
    known = Objective(whole, sigma).solve(whole.unknowns(HARDENING), 400).normal.cost
    costs = [ended.normal.cost for ended, _ in optima_by_beginnings(whole, sigma)]
    assert min(costs) == pytest.approx(known, rel=1e-3)


@pytest.mark.slow
def test_a_fit_without_beginnings_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """The starts from the whole logs end more than ten times above the noise: over a sine of 0.3 Hz
    they do, and over one of 0.5 Hz they did as long as initial states were held too near."""
    whole = hardening(0.3)
    guesses = whole.model.guess(whole.segments, "contraction")

    def cost() -> float:
        rng = np.random.default_rng(0)
        found = output_error(whole, [g.values_dict() for g in guesses], rng=rng)
        known = Objective(whole, found.sigma).solve(whole.unknowns(HARDENING), 400)
        return found.cost / known.normal.cost

    assert cost() == pytest.approx(1.0, abs=1e-4)
    monkeypatch.setattr(rivals, "optima_by_beginnings", lambda problem, sigma: iter(()))
    assert cost() > 10.0
