"""Logs that stall, taken as one segment, and what is left out behind their stalls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import MODEL, TRUTH, linear_log, linear_problem
from slow_camera import slow

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.effects import effects_of
from softid.effects.extension.extended_model import ExtendedModel
from softid.identification.lost_input import MATTERS
from softid.identification.slow_outputs import SlowOutputLog, at_readings
from softid.identification.stalls import MOST_LEFT_OUT, across_stalls, as_remembered
from softid.log import Log
from softid.simulation import simulate

NOISE = 0.01
DECLARED = MODEL.parameters().with_values(TRUTH)
VALUES = dict(zip(DECLARED.names, DECLARED.values_vector(), strict=True))
SPAN_KPA = 90.0
"""That of `linear_motion.pressure_course`."""


def stalled(log: Log, *stalls_s: tuple[float, float]) -> Log:
    """The log without what lies strictly within some spans."""
    inside = [(log.time_s > a) & (log.time_s < b) for a, b in stalls_s]
    kept = ~np.any(inside, axis=0)
    channels = {k: replace(c, values=c.values[kept]) for k, c in log.channels.items()}
    return replace(log, time_s=log.time_s[kept], channels=channels, masked=None)


def forgotten_s(span_kpa: float, least: float) -> float:
    """When two rests that many kPa apart, left to one input, are that near: with poles −p and −q
    they differ by span/Q (q exp(−p t) − p exp(−q t))/(q − p)."""
    mass, damping, spring = TRUTH["M"], TRUTH["N"], TRUTH["Q"]
    root = np.sqrt(damping**2 - 4.0 * mass * spring)
    p, q = (damping - root) / (2.0 * mass), (damping + root) / (2.0 * mass)
    t = np.linspace(0.0, 10.0, 100_001)
    apart = span_kpa / spring * (q * np.exp(-p * t) - p * np.exp(-q * t)) / (q - p)
    return float(t[apart > least][-1])


def test_a_log_that_does_not_stall_is_itself() -> None:
    """The same object; so is one whose model has no effects, which begins anew."""
    whole = linear_log(noise=NOISE)
    assert across_stalls(whole, MODEL, VALUES) is whole
    cut = stalled(whole, (8.0, 10.0))
    assert as_remembered(cut, MODEL, VALUES) is cut
    assert len(cut.segments()) == 2


def test_what_the_motion_remembers_is_left_out() -> None:
    """Closed form, for an input at either end of its range throughout a stall of 2 s; the noise is
    estimated to about 5 %, which moves the end by 0.01 s, and a sample is 0.02 s."""
    cut = stalled(linear_log(noise=NOISE, samples=2000), (8.0, 10.0), (21.0, 23.5))
    bridged = across_stalls(cut, MODEL, VALUES)
    assert [(s.start, s.stop) for s in bridged.segments()] == [(0, len(cut))]
    assert bridged.masked is not None
    left_out = bridged.time_s[bridged.masked]
    first, second = left_out[left_out < 15.0], left_out[left_out > 15.0]
    memory_s = forgotten_s(SPAN_KPA, MATTERS * NOISE)
    assert (first[0], second[0]) == pytest.approx((10.0, 23.5))
    assert first[-1] - 10.0 == pytest.approx(memory_s, abs=0.04)
    assert second[-1] - 23.5 == pytest.approx(memory_s, abs=0.04)
    assert first.size + second.size == left_out.size
    (issue,) = bridged.issues
    assert (issue.code, issue.severity) == ("bridged-stalls", "info")
    assert "through 2 stalls of up to 2.5 s" in issue.message
    assert f"{left_out.size} samples" in issue.message


def test_behind_a_stall_of_a_slow_output_as_much_is_left_out() -> None:
    """A camera at a third of the rate of its gauge: its readings in the same spans; where the
    camera alone stalls, the course of the input is known."""
    whole = linear_log(noise=NOISE, samples=2000)
    cut = at_readings(slow(stalled(whole, (8.0, 10.0))))
    assert isinstance(cut, SlowOutputLog)
    bridged = across_stalls(cut, MODEL, VALUES)
    left_out = bridged.time_s[bridged.masked]
    memory_s = forgotten_s(SPAN_KPA, MATTERS * NOISE)
    assert left_out.size > 2
    period_s = cut.period_s
    assert left_out[0] == pytest.approx(10.0, abs=period_s)
    assert left_out[-1] - 10.0 == pytest.approx(memory_s, abs=period_s + 0.04)
    blind = slow(whole)
    dark = (blind.time_s > 8.0) & (blind.time_s < 10.0)
    seen = np.where(dark, np.nan, blind.channels["angle"].values)
    angle = replace(blind.channels["angle"], values=seen)
    kept = at_readings(replace(blind, channels={**blind.channels, "angle": angle}))
    assert len(kept.segments()) == 2
    assert not np.any(across_stalls(kept, MODEL, VALUES).masked)


@pytest.mark.parametrize("springless", [True, False], ids=["no spring", "many stalls"])
def test_where_too_much_hangs_on_stalls_every_stretch_begins_anew(springless: bool) -> None:
    """A drive without a spring never forgets; of 20 s, eight stalls would take 8 s."""
    spans = [(6.0, 8.0)] if springless else [(2.0 * k, 2.0 * k + 0.6) for k in range(1, 9)]
    cut = stalled(linear_log(noise=NOISE), *spans)
    assert 8.0 * forgotten_s(SPAN_KPA, MATTERS * NOISE) > MOST_LEFT_OUT * 20.0
    values = {**VALUES, "Q": 0.0} if springless else VALUES
    assert across_stalls(cut, MODEL, values) is cut


def extended(key: str, **values: float) -> tuple[ExtendedModel, dict[str, float]]:
    """The linear actuator with one effect, and its parameters."""
    problem = linear_problem((linear_log(),))
    scale = scale_of(problem, problem.unknowns(TRUTH))
    model = ExtendedModel(MODEL, effects_of([key]), scale)
    return model, {**VALUES, **{f"{key}_{name}": value for name, value in values.items()}}


def test_a_model_with_effects_remembers_through_a_stall() -> None:
    """A creep that nearly stands still in a stall at rest: with it the score is that of the whole
    log to a tenth, where the stretch would begin settled and err by 0.1 rad."""
    model, values = extended("creep", k=20.0, tau=6.0)
    time_s = np.arange(3000) / 50.0
    pressure = np.where((time_s > 2.0) & (time_s < 30.0), 60.0, 0.0)
    plain = Log.from_arrays(time_s, {"pressure": pressure, "angle": 0.0 * time_s}, name="hold")
    angle = simulate(model, values, plain).outputs["angle"]
    noise = NOISE * np.random.default_rng(4).standard_normal(time_s.size)
    channels = {"pressure": pressure, "angle": angle + noise}
    whole = Log.from_arrays(time_s, channels, name="hold")
    cut = stalled(whole, (8.0, 11.0), (40.0, 42.0))
    course = as_remembered(cut, model, values)
    found = simulate(model, values, course).outputs["angle"]
    kept = np.isin(time_s, cut.time_s)
    assert np.abs(found - angle[kept]).max() < 1e-4
    anew = simulate(model, values, cut).outputs["angle"]
    assert np.abs(anew - angle[kept]).max() > 0.1


def test_a_log_without_an_output_is_bridged() -> None:
    """As `softid simulate` has it: nothing tells the noise, and nothing is to be left out."""
    model, values = extended("creep", k=20.0, tau=6.0)
    cut = stalled(linear_log(), (8.0, 10.0))
    silent = replace(
        cut,
        channels={
            **cut.channels,
            "angle": replace(cut.channels["angle"], values=np.full(len(cut), np.nan)),
        },
    )
    assert len(as_remembered(silent, model, values).segments()) == 1
