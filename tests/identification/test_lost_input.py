"""Samples that depend on what the input did while samples were lost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import MODEL, TRUTH, Array
from lost_samples import JUMP_S, LEVEL_KPA, LOST, NOISE, fine, jump, recorded

from softid.identification.lost_input import MATTERS, MOST_LEFT_OUT, without_lost_input
from softid.identification.slow_outputs import SlowOutputLog, at_readings
from softid.log import Log

VALUES = dict(
    zip(
        MODEL.parameters().names, MODEL.parameters().with_values(TRUTH).values_vector(), strict=True
    )
)


def unknown_part(log: Log, at: int = LOST[0]) -> Array:
    """How far the angle can be off behind the gap, for the model at the truth.

    The input through the upper and through the lower end of the jump differ by a triangle of
    height H and half width w about the middle of the gap. With the poles −p and −q the response
    is H w (f(p) exp(−p t) − f(q) exp(−q t)) / (M (q − p)), f(p) = 2 (cosh p w − 1)/(p w)².
    """
    before = at - 1
    start_s, end_s = log.time_s[before], log.time_s[before + 1]
    w, t = 0.5 * (end_s - start_s), log.time_s - 0.5 * (start_s + end_s)
    mass, damping, spring = TRUTH["M"], TRUTH["N"], TRUTH["Q"]
    root = np.sqrt(damping**2 - 4.0 * mass * spring)
    p, q = (damping - root) / (2.0 * mass), (damping + root) / (2.0 * mass)

    def decays(rate: float) -> Array:
        share = 2.0 * (np.cosh(rate * w) - 1.0) / (rate * w) ** 2
        return np.where(t >= w, share * np.exp(-rate * t), 0.0)

    return LEVEL_KPA * w * (decays(p) - decays(q)) / (mass * (q - p))


def test_a_log_without_gaps_is_itself() -> None:
    """The same object, so that nothing is fitted again; a jump between two samples is no gap."""
    whole = recorded(jump(), lost=())
    assert without_lost_input(whole, MODEL, VALUES) is whole


def test_a_clock_that_trembles_has_lost_nothing() -> None:
    """Intervals of 20 ms ± 80 %, the longest about the jump: none beyond three of their spreads."""
    log = recorded(jump(), lost=())
    inner = 0.4 * log.period_s * np.random.default_rng(3).uniform(-1.0, 1.0, len(log))
    last = round(JUMP_S / log.period_s - 0.5)
    inner[last : last + 2] = (-0.4 * log.period_s, 0.4 * log.period_s)
    trembling = replace(log, time_s=np.arange(len(log)) * log.period_s + inner - inner[0])
    assert np.diff(trembling.time_s)[last] == pytest.approx(1.8 * log.period_s)
    assert without_lost_input(trembling, MODEL, VALUES) is trembling


def test_a_jump_in_a_gap_takes_the_memory_of_the_motion() -> None:
    """Closed form: masked is where the course of the input matters more than half of the noise.

    The noise is estimated to about 5 %, which moves the end of 0.6 s by 0.05/p = 7 ms, less than a
    sample; two are allowed. The angle itself stays, and the issue counts what is left out.
    """
    log = recorded(jump())
    kept = without_lost_input(log, MODEL, VALUES)
    assert kept.masked is not None
    masked = np.flatnonzero(kept.masked)
    expected = np.flatnonzero(unknown_part(log) > MATTERS * NOISE)
    assert expected.size > 25
    assert masked[0] == expected[0] == LOST[0]
    assert np.array_equal(masked, np.arange(masked[0], masked[-1] + 1))
    assert masked[-1] == pytest.approx(expected[-1], abs=2)
    (issue,) = kept.issues
    assert (issue.code, issue.severity) == ("lost-input", "info")
    assert f"{masked.size} samples, from 5.06 s" in issue.message
    for name, channel in log.channels.items():
        assert np.array_equal(kept.channels[name].values, channel.values)


@pytest.mark.parametrize("course", ["ramp", "sine"])
def test_an_input_that_goes_straight_on_is_known(course: str) -> None:
    """A ramp is straight in the gap; a sine of 0.2 Hz bends there by ω² A g²/2 = 0.15 kPa."""
    t = fine()
    slow = 60.0 * t if course == "ramp" else 30.0 * (1.0 - np.cos(0.4 * np.pi * t))
    log = recorded(slow)
    assert without_lost_input(log, MODEL, VALUES) is log


def test_a_gap_matters_as_much_to_a_slow_output() -> None:
    """A camera that reads every second row: of the same samples those that it read."""
    log = recorded(jump())
    seen = np.arange(len(log)) % 2 == 0
    angle = np.where(seen, log.channels["angle"].values, np.nan)
    channels = {**log.channels, "angle": replace(log.channels["angle"], values=angle)}
    camera = at_readings(replace(log, channels=channels))
    assert isinstance(camera, SlowOutputLog)
    masked, all_masked = (without_lost_input(one, MODEL, VALUES).masked for one in (camera, log))
    assert masked is not None
    assert all_masked is not None
    assert masked.sum() == pytest.approx(0.5 * all_masked.sum(), abs=2.0)
    ends_s = [one.time_s[rows][[0, -1]] for one, rows in ((camera, masked), (log, all_masked))]
    assert ends_s[0] == pytest.approx(ends_s[1], abs=1.5 * log.period_s)


def test_of_a_log_that_mostly_hangs_on_it_the_worst_is_left_out() -> None:
    """The same gap, and so the same samples, in a log of 20 s and in the 1.7 s about it.

    What depends on it decays with the motion, so those that depend most follow the gap.
    """
    log = recorded(jump())
    masked = without_lost_input(log, MODEL, VALUES).masked
    assert masked is not None
    short = log.between(4.5, 6.2)
    assert masked.sum() > MOST_LEFT_OUT * len(short)
    worst = without_lost_input(short, MODEL, VALUES).masked
    assert worst is not None
    expected = np.argsort(-unknown_part(short, at=short.time_s.searchsorted(5.0)))[: worst.sum()]
    assert worst.sum() == pytest.approx(MOST_LEFT_OUT * len(short), abs=1.0)
    assert np.array_equal(np.flatnonzero(worst), np.sort(expected))
