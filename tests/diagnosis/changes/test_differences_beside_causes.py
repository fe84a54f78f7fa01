"""A cause in all logs, and a number that differs from log to log."""

from __future__ import annotations

from dataclasses import replace

import pytest

from softid.diagnosis.report.changes import CHANGE_POINT
from softid.diagnosis.report.other_explanations import EVENT_BESIDE
from softid.diagnosis.workflow import diagnose
from softid.log import Log
from softid.synthesis import hidden_pair


def scaled(log: Log, factor: float) -> Log:
    """The log by a gauge of its output that reads so many times as much."""
    output = log.channels[log.outputs[0]]
    read = replace(output, values=factor * output.values)
    return replace(log, name="other", channels={**log.channels, output.name: read})


@pytest.mark.slow
def test_a_difference_beside_a_cause_is_told_as_one() -> None:
    """Creep in both logs, and 5 % in the gain of one: no moment, though a log begins at rest."""
    first, second = hidden_pair(["creep"], seed=3).logs
    found = diagnose([first, scaled(second, 1.05)], model="muscle", effects=("creep",))
    assert CHANGE_POINT not in [issue.code for issue in found.issues]
    (told,) = [issue for issue in found.issues if issue.code == EVENT_BESIDE]
    assert told.message.startswith("beside creep of the material the logs differ: against train ")
    assert "the gain of the reading" in told.message
    assert told.remedy == found.next_experiment
