"""The inspection as a whole: silence on clean logs, one record that JSON can hold, its speed."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from drawn_logs import draw, staircase_log

from softid.errors import Issue
from softid.log import Log
from softid.quality import inspect
from softid.records import to_jsonable

TRUE_OF_THE_DRAW = {
    "coarse-quantisation",
    "irregular-sampling",
    "input-at-rest",
    "little-signal",
    "close-samples",
    "moving-at-start",
}
"""Properties that drawn logs do have."""


@pytest.mark.parametrize("seed", range(60))
def test_no_false_alarm(seed: int) -> None:
    """A fault-free log has no fault: 60 draws, after 0 false alarms in 400 of a like generator."""
    found = inspect(draw(seed).log)
    assert {issue.code for issue in found.issues} <= TRUE_OF_THE_DRAW
    for report in found.channels:
        assert (report.dropouts, report.frozen, report.saturation) == ((), (), ())
        assert (report.hold, report.dead_band, report.hum) == (None, None, None)


@pytest.mark.parametrize("seed", range(12))
def test_sizes_of_a_draw(seed: int) -> None:
    """Noise within 15 % where it exceeds 0.6 steps; the grid as drawn within 1e-6."""
    drawn = draw(seed)
    found = inspect(drawn.log)
    for name, noise, step in (
        ("pressure", drawn.pressure_noise, drawn.pressure_step),
        ("angle", drawn.angle_noise, drawn.angle_step),
    ):
        report = found.channel(name)
        if step > 0.0:
            assert report.quantisation is not None
            assert report.quantisation.step * report.display_factor == pytest.approx(step, 1e-6)
        if noise > 0.6 * step and noise > 0.0:
            assert report.noise_std is not None
            assert report.noise_std * report.display_factor == pytest.approx(noise, rel=0.15)


def test_roles_and_order() -> None:
    """Input, outputs, command, others; numbers in canonical units with the factor back."""
    found = inspect(staircase_log())
    assert [(c.name, c.role) for c in found.channels] == [
        ("pressure", "input"),
        ("angle", "output"),
        ("pressure_command", "command"),
    ]
    angle = found.channel("angle")
    assert angle.high is not None
    assert angle.high * angle.display_factor == pytest.approx(40.0, abs=0.2)
    with pytest.raises(KeyError):
        found.channel("torque")


def test_what_the_reader_said_is_kept() -> None:
    """Issues of the log stand among those found, ordered by severity."""
    told = Issue("duplicate-times", "warning", "3 samples were repeated", "check the logger")
    found = inspect(replace(staircase_log(), issues=(told,)))
    assert told in found.issues
    order = ["error", "warning", "info"]
    ranks = [order.index(i.severity) for i in found.issues]
    assert ranks == sorted(ranks)


def test_json() -> None:
    """All of it becomes plain values; a log with NaN too."""
    log = staircase_log()
    document = to_jsonable(inspect(log))
    assert isinstance(document, dict)
    assert document["input"] == "pressure"
    assert document["excitation"][0]["kind"] == "staircase"  # type: ignore[index, call-overload]


def test_an_input_at_rest() -> None:
    """Noise about a level is a rest; the user is told that nothing else can be learnt."""
    rng = np.random.default_rng(0)
    log = Log.from_arrays(
        np.arange(1000) * 0.02,
        {"pressure": 5.0 + rng.standard_normal(1000), "angle": 0.01 * rng.standard_normal(1000)},
    )
    found = inspect(log)
    assert [s.kind for s in found.excitation] == ["rest"]
    assert "input-at-rest" in {i.code for i in found.issues}
    assert found.ability("static curve").possible == "no"
    with pytest.raises(KeyError):
        found.ability("beauty")


def test_a_pressure_as_output() -> None:
    """Command to pressure: the pneumatics alone, with the command as input."""
    log = staircase_log().with_roles(input="pressure_command", outputs=["pressure"])
    found = inspect(log)
    assert found.command_excitation is None
    assert found.excitation[0].levels == (0.0, 20.0, 40.0, 60.0, 80.0, 100.0)
    assert found.responses[0].output_t63_s == pytest.approx(0.1, abs=0.03)


def test_10000_samples_in_time() -> None:
    """0.3 s on an idle core; processor time, and the best of three, so that neighbours do not
    count."""
    log = staircase_log(rate_hz=230.0)
    assert len(log) > 10_000
    spent = []
    for _ in range(3):
        start = time.process_time()
        inspect(log)
        spent.append(time.process_time() - start)
    assert min(spent) < 0.3
