"""Faults put into fault-free logs are found where they are, and nowhere else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn_logs import draw, staircase_log, with_fault

from softid.log import Log
from softid.quality import dropout_mask, inspect
from softid.quality.dropouts import may_drop_out

SEEDS = range(8)


def position(seed: int, n: int) -> int:
    return int(np.random.default_rng(10_000 + seed).integers(n // 4, 3 * n // 4))


@pytest.mark.parametrize("seed", SEEDS)
def test_a_spike(seed: int) -> None:
    """One sample off by 40 % of the range."""
    log = draw(seed).log
    at = position(seed, len(log))

    def fault(values: np.ndarray) -> np.ndarray:
        values[at] += 0.4 * np.ptp(values)
        return values

    (found,) = inspect(with_fault(log, "angle", fault)).channel("angle").dropouts
    assert (found.start, found.stop) == (at, at + 1)
    assert found.expected is not None
    assert found.value is not None
    assert found.value > found.expected


@pytest.mark.parametrize("sentinel", [0.0, -999.0, 180.0])
def test_a_sentinel(sentinel: float) -> None:
    """Half a second of one value amid noise; 2 s is the longest that counts as a drop-out."""
    log = staircase_log()

    def fault(values: np.ndarray) -> np.ndarray:
        values += 5.0
        values[1500:1550] = sentinel
        values[2500] = sentinel
        return values

    found = inspect(with_fault(log, "angle", fault)).channel("angle").dropouts
    assert [(d.start, d.stop) for d in found] == [(1500, 1550), (2500, 2501)]
    assert {d.cause for d in found} == {"sentinel"}


@pytest.mark.parametrize("stands_at_zero", [False, True])
def test_a_code_is_one_where_the_channel_passes_it(stands_at_zero: bool) -> None:
    """A loose plug reads 0 in 1 of 50 samples of a swing through 0: all of them are drop-outs, near
    the crossings, too. Where the channel stands at 0 for half of the time, it is none there.
    """
    log = staircase_log()
    rng = np.random.default_rng(4)
    lost = rng.choice(len(log), len(log) // 50, replace=False)
    swing = np.sin(np.arange(len(log)) / 90.0) + 1e-3 * rng.standard_normal(len(log))
    stands = swing <= 0.0

    def fault(values: np.ndarray) -> np.ndarray:
        values[:] = np.where(stands, 0.0, swing) if stands_at_zero else swing
        values[lost] = 0.0
        return values

    found = dropout_mask(with_fault(log, "angle", fault))
    if stands_at_zero:
        assert not found[stands].any()
        assert found[lost[swing[lost] > 0.2]].all()
    else:
        assert np.abs(swing[lost]).min() < 0.06  # less than any spike that is told by itself
        assert found[lost].all()
        others = np.setdiff1d(np.flatnonzero(found), lost)  # one between two that are lost
        assert np.isin([others - 1, others + 1], lost).all()


def test_missing_samples() -> None:
    """NaN is a drop-out without a value, expected between its neighbours."""

    def fault(values: np.ndarray) -> np.ndarray:
        values[:2] = values[100:105] = np.nan
        return values

    log = with_fault(staircase_log(), "angle", fault)
    report = inspect(log).channel("angle")
    assert report.missing == 7
    assert [(d.start, d.stop, d.cause) for d in report.dropouts] == [
        (0, 2, "missing"),
        (100, 105, "missing"),
    ]
    assert report.dropouts[1].length_s == pytest.approx(0.05)
    assert np.flatnonzero(dropout_mask(log)).tolist() == [0, 1, 100, 101, 102, 103, 104]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_channel_that_cannot_drop_out_has_no_drop_outs(seed: int) -> None:
    """Where a quick look finds nothing, nor does the thorough one; a spike passes the quick one."""
    log = draw(seed).log
    for name in log.outputs:
        values = log.channels[name].values
        assert may_drop_out(values) or not inspect(log).channel(name).dropouts
        spiked = values.copy()
        spiked[position(seed, len(log))] += 0.4 * np.ptp(values)
        assert may_drop_out(spiked)


def test_a_lost_digit() -> None:
    """31.37 → 1.37: what a serial line makes of a number when it loses a byte."""

    def fault(values: np.ndarray) -> np.ndarray:
        values = np.round(values, 2)
        values[2300] = np.fmod(values[2299], 10.0)
        return values

    (found,) = inspect(with_fault(staircase_log(), "angle", fault)).channel("angle").dropouts
    assert found.cause == "lost digit"


def test_a_command_that_flickers() -> None:
    """Two samples of another level in a command held for seconds; a step change is none."""

    def fault(values: np.ndarray) -> np.ndarray:
        values[1650:1652] = 0.0
        return values

    found = inspect(with_fault(staircase_log(), "pressure_command", fault))
    (flicker,) = found.channel("pressure_command").dropouts
    assert (flicker.start, flicker.stop) == (1650, 1652)
    assert "command-flicker" in {i.code for i in found.issues}


def test_a_frozen_channel() -> None:
    """2.5 s of one value in a noisy channel, from 2 s into a rung to beyond it."""

    def fault(values: np.ndarray) -> np.ndarray:
        values[1000:1250] = values[1000]
        return values

    (found,) = inspect(with_fault(staircase_log(), "pressure", fault)).channel("pressure").frozen
    assert (found.start, found.stop, found.reason) == (1000, 1250, "stale")
    assert found.length_s == pytest.approx(2.49)


def test_a_channel_without_noise_that_stands_while_the_input_moves() -> None:
    """A noise-free output is stopped at 60 kPa while the pressure goes on to 100 and back."""
    log = staircase_log(noise_deg=0.0)

    def fault(values: np.ndarray) -> np.ndarray:
        values[1300:2700] = values[1300]
        return values

    (found,) = inspect(with_fault(log, "angle", fault)).channel("angle").frozen
    assert found.reason == "input moves"
    assert (found.start, found.stop) == (1300, 2700)


@pytest.mark.parametrize("noise_deg", [0.0, 0.1])
@pytest.mark.parametrize("side", ["high", "low"])
def test_saturation(side: str, noise_deg: float) -> None:
    """Tops cut off at 80 % of the range, with and without noise."""
    time_s = np.arange(4000) * 0.01
    rng = np.random.default_rng(0)
    pressure = 50.0 + 40.0 * np.sin(2 * np.pi * 0.2 * time_s) + rng.standard_normal(4000)
    angle = 20.0 * np.sin(2 * np.pi * 0.2 * time_s - 0.3) + noise_deg * rng.standard_normal(4000)
    limit = 12.0 if side == "high" else -12.0
    clipped = np.minimum(angle, limit) if side == "high" else np.maximum(angle, limit)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": clipped}, units={"angle": "deg"})
    report = inspect(log).channel("angle")
    (found,) = report.saturation
    assert found.side == side
    assert found.value * report.display_factor == pytest.approx(limit)
    assert found.times == 8
    clip_s = (np.pi - 2 * np.arcsin(0.6)) / (2 * np.pi * 0.2)
    assert found.longest_s == pytest.approx(clip_s, rel=0.1)


def test_a_dead_output() -> None:
    """A constant output beside a moving input is an error that names the way out."""
    log = with_fault(staircase_log(), "angle", lambda v: np.full(v.size, 3.0))
    found = inspect(log)
    assert found.channel("angle").dead
    (issue,) = [i for i in found.issues if i.code == "dead-channel"]
    assert issue.severity == "error"
    assert "--output" in (issue.remedy or "")
    assert found.issues[0] is issue


def test_a_dead_channel_beside_the_output() -> None:
    """Its name says that it measures something, so a constant is told, though nobody fits it."""
    log = staircase_log()
    torque = replace(log.channels["angle"], name="torque", values=np.full(len(log), 3.0))
    found = inspect(replace(log, channels={**log.channels, "torque": torque}))
    (issue,) = [i for i in found.issues if i.code == "dead-channel"]
    assert issue.severity == "info"
    assert issue.message.startswith("torque is constant at ")


@pytest.mark.parametrize("rate_hz", [50.0, 200.0])
@pytest.mark.parametrize("factor", [2, 3, 7])
def test_a_held_output(factor: int, rate_hz: float) -> None:
    """Every value k times: the effective rate is the k-th part, and its noise is not misjudged."""
    log = staircase_log(noise_deg=0.1, rate_hz=rate_hz)
    held = with_fault(log, "angle", lambda v: v[(np.arange(v.size) // factor) * factor])
    report = inspect(held).channel("angle")
    assert report.hold is not None
    assert report.hold.rate_hz == pytest.approx(rate_hz / factor, rel=0.05)
    assert report.noise_std is not None
    assert report.noise_std * report.display_factor == pytest.approx(0.1, rel=0.15)


def test_no_fault_is_reported_of_other_channels() -> None:
    """Raw channels are described, not judged: nobody fits them."""
    log = staircase_log()
    raw = replace(log.channels["angle"], name="adc", values=np.zeros(len(log)))
    found = inspect(replace(log, channels={**log.channels, "adc": raw}))
    assert found.channel("adc").dead
    assert found.channel("adc").role == "other"
    assert not [i for i in found.issues if "adc" in i.message]
