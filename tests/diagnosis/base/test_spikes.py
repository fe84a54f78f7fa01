"""Readings that are far off those beside them are no misfit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from softid.diagnosis import diagnose
from softid.diagnosis.base.spikes import SPIKES
from softid.diagnosis_results import Verdict
from softid.log import Log
from softid.synthesis import hidden_pair


def spiked(log: Log) -> Log:
    """The log with nine readings a third of the output's deviation off, where it moves quickly.

    Two of them are side by side.
    """
    (name,) = log.outputs
    values = log.channels[name].values.copy()
    quick = np.argsort(-np.abs(np.diff(values)))[:400:50]
    values[[*quick.tolist(), int(quick[0]) + 1]] += 0.3 * np.std(values)
    channels = {**log.channels, name: replace(log.channels[name], values=values)}
    return replace(log, channels=channels)


@pytest.mark.parametrize("hidden", ["", pytest.param("creep", marks=pytest.mark.slow)])
def test_they_are_left_out_and_told(hidden: str) -> None:
    """Known truth: too small to be seen without a fit, beside the quick motion of an oscillator."""
    names = [hidden] if hidden else []
    train, hold_out = hidden_pair(names, seed=610, model="oscillator").logs
    logs = [spiked(log) for log in (train, hold_out)]
    found = diagnose(logs[0], hold_out=[logs[1]], model="oscillator")
    assert [cause.effect for cause in found.causes] == names
    assert found.verdict is (Verdict.NAMED if hidden else Verdict.ADEQUATE)
    told = [issue.message for issue in found.issues if issue.code == SPIKES]
    assert len(told) == 2
    assert told[0].startswith("train: ")


def test_noise_has_none() -> None:
    train, hold_out = hidden_pair([], seed=611).logs
    found = diagnose(train, hold_out=[hold_out], model="muscle")
    assert SPIKES not in {issue.code for issue in found.issues}
