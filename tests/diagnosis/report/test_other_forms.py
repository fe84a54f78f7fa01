"""Parameters that another form of a cause's law would make others."""

from __future__ import annotations

import re

import pytest

from softid.diagnosis import diagnose
from softid.diagnosis.report.other_forms import OTHER_FORM
from softid.synthesis import hidden_pair


@pytest.mark.parametrize("seed", [1, 2])
def test_a_linear_creep_does_not_tell_which_stiffness_is_meant(seed: int) -> None:
    """The truth of Q is among the two values, and Q is not called identified."""
    drawn = hidden_pair(["creep"], seed=seed, model="oscillator", protocol="levels")
    train, hold_out = drawn.logs
    effects = ("creep", "creep.series", "delay")
    found = diagnose(train, hold_out=[hold_out], model="oscillator", effects=effects)
    assert [cause.effect for cause in found.causes] == ["creep"]
    assert found.extended is not None
    (told,) = (issue for issue in found.issues if issue.code == OTHER_FORM)
    pair = re.search(r"Q (\S+) in place of (\S+) ", told.message)
    assert pair is not None
    assert min(abs(float(v) / drawn.actuator.values["Q"] - 1.0) for v in pair.groups()) < 0.02
    rows = {p.name: p for p in found.extended.parameters}
    assert rows["Q"].verdict == "weakly identified"
    assert rows["N"].verdict == "identified"


def test_where_the_stiffness_goes_with_the_pressure_the_logs_tell() -> None:
    """Known truth: a muscle whose material creeps. Nothing is said, and nothing taken back."""
    train, hold_out = hidden_pair(["creep"], seed=3).logs
    effects = ("creep", "creep.series", "delay")
    found = diagnose(train, hold_out=[hold_out], model="muscle", effects=effects)
    assert [cause.key for cause in found.causes] == ["creep"]
    assert OTHER_FORM not in {issue.code for issue in found.issues}
