"""Guess-free start values of the muscle law: near enough that the fit needs no help."""

from __future__ import annotations

import numpy as np
import pytest

from softid.log import Log
from softid.models.muscle import Muscle
from softid.models.muscle_law import NAMES
from softid.models.starts import N_STARTS
from softid.models.stretches import MAX_SAMPLES, WINDOWS, thinned
from softid.synthesis import muscle_log, random_muscle_truth
from softid.synthesis.waveforms import Steps

LEVELS = (0.0, 60.0, 120.0, 180.0, 240.0, 300.0, 210.0, 150.0, 90.0, 30.0, 0.0)


def staircase(truth: dict[str, float], seed: int = 0) -> Log:
    made = muscle_log(truth, Steps(LEVELS, 1.0), seed=seed, noise_mm=0.005 / truth["a1"])
    return made.to_log()


@pytest.mark.parametrize("seed", [1, 2])
def test_best_start_explains_most_of_the_motion(seed: int) -> None:
    """Coarse grid with a linear gain: 97 % of the variance before any optimisation."""
    truth = random_muscle_truth(np.random.default_rng(seed))
    (segment,) = staircase(truth).segments()
    starts = Muscle().guess([segment], "contraction")
    y = segment.outputs["contraction"]
    x = Muscle().response(
        starts[0].values_vector(), segment, ("contraction",), start=None, derivatives=False
    )
    residual = y - x.outputs["contraction"]
    assert np.var(residual) < 0.03 * np.var(y)
    assert 1 <= len(starts) <= N_STARTS
    assert len({s["b1"].value for s in starts} | {s["b2"].value for s in starts}) > 1


@pytest.mark.parametrize("order", ["second", "first", "static"])
@pytest.mark.parametrize("damping", ["exponential", "constant"])
def test_starts_respect_the_options(order, damping) -> None:
    """What the options hold stays at zero; all else is finite and inside its bounds."""
    truth = random_muscle_truth(np.random.default_rng(1))
    model = Muscle(order=order, damping=damping)
    declared = model.parameters()
    starts = model.guess(staircase(truth).segments(), "contraction")
    assert starts
    for start in starts:
        assert start.names == NAMES
        for p in start.values():
            assert p.lower <= p.value <= p.upper
            assert p.fixed == declared[p.name].fixed
            assert not (p.fixed and p.value != 0.0)
            assert p.fixed or p.scale == "linear" or p.value > 0.0


def test_starts_do_not_depend_on_the_sensor_zero() -> None:
    """A zero of 50 mm is projected out: the same starts, to the rounding of 6 written digits."""
    truth = random_muscle_truth(np.random.default_rng(1))
    log = staircase(truth)
    moved = Log.from_arrays(
        log.time_s,
        {"pressure": log.pressure_kpa, "contraction": log.channels["contraction"].values + 50.0},
    )
    one = Muscle().guess(log.segments(), "contraction")
    two = Muscle().guess(moved.segments(), "contraction")
    for a, b in zip(one, two, strict=True):
        np.testing.assert_allclose(a.values_vector(), b.values_vector(), rtol=1e-8)


@pytest.mark.parametrize("output", ["angle", "length", "distance"])
def test_starts_from_any_output(output: str) -> None:
    """The geometry turns the output back to a contraction: x_max within 30 %, b1 within 60 %."""
    truth = random_muscle_truth(np.random.default_rng(3))
    log = staircase(truth)
    model = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
    arc = model.geometry
    assert arc is not None
    x = log.channels["contraction"].values
    made = {"angle": arc.angle_rad, "length": arc.length_mm, "distance": arc.distance_mm}[output](x)
    other = Log.from_arrays(log.time_s, {"pressure": log.pressure_kpa, output: made})
    best = model.guess(other.segments(), output)[0]
    assert 1 / best["a1"].value == pytest.approx(1 / truth["a1"], rel=0.3)
    assert best["b1"].value == pytest.approx(truth["b1"], rel=0.6)


@pytest.mark.parametrize("gap", ["masked", "nan"])
def test_unused_samples_do_not_matter(gap: str) -> None:
    """A spike of 1e6 that is masked, or NaN, changes no start by more than the lost samples do."""
    truth = random_muscle_truth(np.random.default_rng(1))
    log = staircase(truth)
    x = log.channels["contraction"].values.copy()
    x[200:210] = 1e6 if gap == "masked" else np.nan
    spoilt = Log.from_arrays(log.time_s, {"pressure": log.pressure_kpa, "contraction": x})
    mask = np.zeros(len(log), bool)
    mask[200:210] = True
    clean = Muscle().guess(log.with_masked(mask).segments(), "contraction")
    found = Muscle().guess(spoilt.with_masked(mask).segments(), "contraction")
    for a, b in zip(clean, found, strict=True):
        np.testing.assert_allclose(a.values_vector(), b.values_vector(), rtol=1e-10)


def test_nothing_moves() -> None:
    """Constant output: no start is made up, and no warning."""
    time_s = np.arange(100) * 0.02
    log = Log.from_arrays(
        time_s, {"pressure": np.where(time_s < 1, 0.0, 50.0), "contraction": np.full(100, 3.0)}
    )
    assert all(
        np.isfinite(s.values_vector()).all() for s in Muscle().guess(log.segments(), "contraction")
    )


def test_constant_pressure() -> None:
    """No span of pressure to scale the grid with: still no crash and nothing that is not finite."""
    time_s = np.arange(100) * 0.02
    log = Log.from_arrays(time_s, {"pressure": np.full(100, 80.0), "contraction": np.sin(time_s)})
    starts = Muscle().guess(log.segments(), "contraction")
    assert all(np.isfinite(s.values_vector()).all() for s in starts)


def test_a_fast_input_is_looked_at_in_windows() -> None:
    """A 2 Hz sine over 500 s would vanish in 1,000 blocks: windows of finer blocks, a fifth unused.

    The blocks of the same log with one slow sine cover it all.
    """
    time_s = np.arange(50_000) * 0.01
    found = []
    for frequency_hz in (2.0, 0.01):
        u = 100.0 + 80.0 * np.sin(2.0 * np.pi * frequency_hz * time_s)
        log = Log.from_arrays(time_s, {"pressure": u, "contraction": 0.1 * u})
        found.append(thinned(log.segments(), [0.1 * u], "contraction"))
    fast, slow = found
    assert (len(fast), len(slow)) == (WINDOWS, 1)
    assert sum(s.time_s.size for s in fast) <= MAX_SAMPLES
    assert min(np.ptp(s.input) for s in fast) > 140.0
    assert [int((~s.used).sum()) for s in fast[1:]] == [fast[0].time_s.size // 5] * 3
    assert fast[0].used.all()
    assert slow[0].time_s[-1] > 499.0
