"""A load that is put on a muscle shifts its angle by another amount at every pressure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import excess_over, sizes_of, smoothed_levels, standing
from muscle_motion import MODEL, TRUTH, muscle_angle, muscle_log

from softid.diagnosis.changes.jump_search import seen_again, zero_jumps
from softid.diagnosis.changes.loads import by_load
from softid.diagnosis.changes.zero_jumps import without_jumps
from softid.diagnosis.refit.candidates import Candidate, advance
from softid.effects.scale import Scale
from softid.fitters.problem import Problem
from softid.log import Log

Array = npt.NDArray[np.float64]

N, NOISE, LOAD, AT_S = 1500, 0.003, 0.25, 17.3
TIME_S = np.arange(N) / 50.0


KPA = smoothed_levels(TIME_S, 0)
BARE, LOADED = (muscle_angle(TIME_S, KPA, load=load, put_on_s=AT_S) for load in (0.0, LOAD))
NOISES = NOISE * np.random.default_rng(0).standard_normal(N)


def fitted(log: Log) -> tuple[Candidate, Scale]:
    problem = Problem(MODEL, MODEL.parameters().with_values(TRUTH), [log])
    base = advance(standing(problem, problem.unknowns(TRUTH)), {"angle": NOISE}, 40)
    return base, sizes_of(base)


def test_what_a_load_does_is_as_an_integrator_has_it() -> None:
    """The law is linear in the load, so that its derivative is all of it."""
    model, scale = fitted(muscle_log("muscle", TIME_S, KPA, BARE + 1e-6 * NOISES))
    shifted = by_load(model, scale, AT_S) / scale.force * LOAD
    largest = np.abs(LOADED - BARE).max()
    assert np.abs(shifted - (LOADED - BARE)).max() < 0.01 * largest
    assert np.all(shifted[TIME_S <= AT_S] == 0.0)


def test_a_load_is_taken_out_at_every_pressure() -> None:
    """Known truth: moment, mean shift, and the log without it or with it from the start."""
    log = muscle_log("muscle", TIME_S, KPA, LOADED + NOISES)
    model, scale = fitted(log)
    jumps = zero_jumps(model, scale, excess_over(NOISE, model))
    for _ in range(3):
        model, scale = fitted(without_jumps(log, jumps))
        jumps = seen_again(model, scale, jumps)
    (jump,) = jumps
    assert jump.kind == "load"
    assert jump.time_s == pytest.approx(AT_S, abs=0.02)
    shift = float(np.mean((LOADED - BARE)[TIME_S > AT_S]))
    assert jump.size == pytest.approx(shift, rel=0.03)
    assert excess_over(NOISE, model) == pytest.approx(0.0, abs=0.1)
    throughout = muscle_angle(TIME_S, KPA, load=LOAD)
    for stays, truth in ((False, BARE), (True, throughout)):
        steady = without_jumps(log, [replace(jump, stays=stays)])
        off = steady.channels["angle"].values - NOISES - truth
        assert np.abs(off).max() < 0.05 * abs(shift)
        assert ("from the start" in steady.issues[-1].message) == stays


def test_a_slip_of_the_sensor_is_none() -> None:
    slipped = np.where(TIME_S > AT_S, 0.05, 0.0)
    model, scale = fitted(muscle_log("muscle", TIME_S, KPA, BARE + slipped + NOISES))
    (jump,) = zero_jumps(model, scale, excess_over(NOISE, model))
    assert jump.kind == "zero"
    assert jump.time_s == pytest.approx(AT_S, abs=0.03)


@pytest.mark.parametrize("kind", ["gain", "stiffness"])
def test_what_gives_way_is_no_jump(kind: str) -> None:
    """A gain of the reading changes, or the stiffness falls by a tenth."""
    softer = {**TRUTH, "a1": 0.9 * TRUTH["a1"], "c1": 0.9 * TRUTH["c1"]}
    later = 1.1 * BARE if kind == "gain" else muscle_angle(TIME_S, KPA, softer)
    angle = np.where(TIME_S > AT_S, later, BARE)
    model, scale = fitted(muscle_log("muscle", TIME_S, KPA, angle + NOISES))
    assert zero_jumps(model, scale, excess_over(NOISE, model)) == ()
