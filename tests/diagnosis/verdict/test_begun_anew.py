"""Held-out logs that were recorded when the sensor was warm already."""

from __future__ import annotations

import numpy as np
import pytest
from wrong_readings import read_with

from softid.diagnosis import diagnose
from softid.diagnosis_results import Diagnosis, Verdict
from softid.log import Log
from softid.synthesis import hidden_pair


def warming_up(log: Log, within_s: float) -> Log:
    """The log of a sensor that reads a sixteenth of its range too much when it is warm."""
    (name,) = log.outputs
    span = float(np.ptp(log.channels[name].values))
    return read_with(log, name, span / 16.0 * (1.0 - np.exp(-log.time_s / within_s)))


def diagnosed(model: str, seed: int, within_s: float, *, is_warm: bool) -> Diagnosis:
    """The diagnosis of a log in which the sensor warms up, judged by one in which it is or does."""
    fitted, judge = hidden_pair(seed=seed, model=model).logs
    judge = judge if is_warm else warming_up(judge, within_s)
    return diagnose(warming_up(fitted, within_s), hold_out=[judge], model=model)


@pytest.mark.parametrize(
    ("model", "seed", "within_s"),
    [
        ("oscillator", 981021, 12.0),
        ("muscle", 981022, 5.0),
        *(pytest.param("muscle", 981023 + k, 5.0, marks=pytest.mark.slow) for k in range(4)),
        *(pytest.param("muscle", 981027 + k, 12.0, marks=pytest.mark.slow) for k in range(4)),
    ],
)
def test_what_warmed_up_before_it_was_held_out_is_told_and_nothing_in_its_place(
    model: str, seed: int, within_s: float
) -> None:
    """Two causes or a law in no catalogue follow the fitted log as well, and do not begin anew."""
    found = diagnosed(model, seed, within_s, is_warm=True)
    assert found.verdict is Verdict.UNKNOWN
    assert found.causes == ()
    assert "Warm-up of the sensor would take away" in found.summary
    assert "law in no catalogue" not in found.summary
    assert found.next_experiment is not None
    assert "hold out none" in found.next_experiment


def test_what_warms_up_in_every_log_is_named() -> None:
    found = diagnosed("muscle", 981022, 5.0, is_warm=False)
    assert [cause.effect for cause in found.causes] == ["sensor_warmup"]
