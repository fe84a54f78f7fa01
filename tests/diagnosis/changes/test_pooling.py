"""Logs that one model nearly does for, though each asks for its own."""

from __future__ import annotations

from dataclasses import replace

import pytest

from softid.diagnosis.base.base_fit import Request
from softid.diagnosis.changes.pooling import own_parameters
from softid.diagnosis.report.changes import own_parameter_issues
from softid.diagnosis.report.difference_texts import LOG_DIFFERENCES
from softid.diagnosis.workflow import diagnose
from softid.diagnosis_results import Verdict
from softid.log import Log, LogSet
from softid.synthesis import hidden_pair

GAIN = 1.004


def two_logs(seed: int, gain: float) -> list[Log]:
    """Without any effect, the second by a gauge that reads a little more."""
    first, second = hidden_pair([], seed=seed).logs
    output = second.channels[second.outputs[0]]
    read = replace(output, values=gain * output.values)
    return [first, replace(second, channels={**second.channels, output.name: read})]


@pytest.mark.parametrize("seed", [1, 2])
def test_a_gain_that_the_noise_nearly_hides_is_seen(seed: int) -> None:
    """0.4 % where the noise is 0.5 %, and nothing without it."""
    request = Request("muscle", None, 0, lambda message, fraction: None)
    same, other = (
        request.fit_base(LogSet(tuple(two_logs(seed, gain))), (), thorough=False)
        for gain in (1.0, GAIN)
    )
    assert own_parameters(same) is None
    assert own_parameter_issues(same) == ()
    found = own_parameters(other)
    assert found is not None
    assert found.apart < found.together < 1.1 * found.apart
    (told,) = own_parameter_issues(other)
    assert told.code == LOG_DIFFERENCES
    assert "the logs differ: models of their own leave" in told.message


def test_a_model_that_follows_each_but_not_both_is_not_adequate() -> None:
    """What differs has no name in the catalogue; the report names what the gauge did."""
    found = diagnose(two_logs(1, GAIN), model="muscle", effects=("delay", "creep"))
    assert found.verdict is Verdict.UNKNOWN
    assert "the logs differ" in found.summary.lower()
    assert not found.causes
