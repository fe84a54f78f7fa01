"""What a user is told about how a diagnosis was made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade_diagnosis import diagnosis
from linear_motion import linear_log

from softid.diagnoses import Verdict
from softid.diagnosis.remarks import rounding
from softid.log import Log

BASE = diagnosis(Verdict.ADEQUATE).base
"""Its angle is told in degrees."""


def rounded(step: float) -> Log:
    log = linear_log(noise=0.01)
    angle = log.channels["angle"]
    values = np.round(angle.values / step) * step
    return replace(log, channels=dict(log.channels) | {"angle": replace(angle, values=values)})


@pytest.mark.parametrize(("rms", "told"), [(0.0104, True), (0.0128, True), (0.0130, False)])
def test_rounding_that_makes_what_is_left_is_told(rms: float, told: bool) -> None:
    """By hand: steps of 0.0222 rad have an rms of 0.0064, a quarter of the power of 0.0128."""
    found = rounding([rounded(0.0222)], BASE, rms)
    assert bool(found) is told
    if told:
        assert "steps of 1.27 deg" in found[0].message
        assert found[0].remedy


def test_fine_samples_are_not_rounded() -> None:
    """No grid, or a fine one, is no remark; nor is a perfect fit."""
    assert not rounding([linear_log(noise=0.01), rounded(0.001)], BASE, 0.0128)
    assert not rounding([rounded(0.0222)], BASE, 0.0)
