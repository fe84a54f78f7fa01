"""A command of which the logs do not tell how it is held, and what hangs on that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade_diagnosis import diagnosis
from linear_motion import TRUTH
from scipy import signal

from softid.diagnosis import diagnose
from softid.diagnosis.report.open_intersample import OPEN_INTERSAMPLE
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis_results import Verdict
from softid.errors import Issue
from softid.log import Log

RATE_HZ = 25.0


def ramps(seed: int, name: str = "pressure_command") -> Log:
    """Triangles of random height that a controller holds at every sample, under noise of 0.01."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(1500) / RATE_HZ
    heights = np.concatenate(([0.0, 0.0], 100.0 * rng.random(40)))
    command = np.interp(time_s, 1.5 * np.arange(heights.size), heights)
    system = ([1.0], [TRUTH["M"], TRUTH["N"], TRUTH["Q"]])
    angle = signal.lsim(system, command, time_s, interp=False)[1]
    channels = {name: command, "angle": angle + 0.01 * rng.standard_normal(time_s.size)}
    return Log.from_arrays(time_s, channels, input=name, name=f"ramps-{seed}")


def test_what_hangs_on_an_open_intersample_is_weakly_identified() -> None:
    """Straight lines are half an interval of 40 ms early, so N takes up about Q · 20 ms of the
    truth; the remark has the value that the true behaviour gives, within 3 %."""
    found = diagnose(ramps(0), hold_out=[ramps(1)], model="oscillator", effects=["creep"])
    (told,) = (issue for issue in found.issues if issue.code == OPEN_INTERSAMPLE)
    damping = found.base.parameter("N")
    assert damping.value > TRUTH["N"] + 0.5 * 0.02 * TRUTH["Q"]
    assert damping.verdict == "weakly identified"
    assert "pressure_command held at every sample explains these logs as well" in told.message
    other = float(told.message.split(" N ")[1].split(" in place of ")[0])
    assert other == pytest.approx(TRUTH["N"], rel=0.03)
    assert told.message[1:] in found.summary


@pytest.mark.parametrize("how", ["declared", "measured"])
def test_a_behaviour_that_is_known_is_not_asked(how: str) -> None:
    """One that is declared, and that of a gauge, which is smooth unless the logs say otherwise."""
    logs = [ramps(k, "pressure" if how == "measured" else "pressure_command") for k in (0, 1)]
    if how == "declared":
        logs = [log.with_intersample("zoh") for log in logs]
    found = diagnose(logs[0], hold_out=logs[1:], model="oscillator", effects=["creep"])
    assert OPEN_INTERSAMPLE not in {issue.code for issue in found.issues}


def test_what_is_assumed_is_told_behind_the_cause() -> None:
    """A reader wants to know first what is missing, and what it hangs on then."""
    message = "p held at every sample explains these logs as well, and makes N 2 in place of 3"
    remark = Issue(OPEN_INTERSAMPLE, "warning", message, "say how it is held")
    told = write_summary(replace(diagnosis(Verdict.NAMED), issues=(remark,))).summary
    assert told.index("The cause: ") < told.index(message[1:])
