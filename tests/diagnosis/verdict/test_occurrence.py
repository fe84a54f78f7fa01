"""Effects that do nothing in what is held out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import (
    RATE_HZ,
    TRUTH,
    linear_angle,
    linear_log,
    linear_problem,
    pressure_course,
    standing,
)

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.refit.held_out import HeldOutLogs
from softid.diagnosis.verdict.occurrence import occurs
from softid.effects import effect_of
from softid.log import Log

LIMIT = 1.2
"""rad; the whole course reaches 1.8, half of it 0.9."""


def held_out_log(share: float) -> Log:
    """A share of the usual course of the pressure, read by the sensor that clips."""
    time_s = np.arange(1000) / RATE_HZ
    pressure = share * pressure_course(time_s)
    trembling = 0.01 * np.random.default_rng(1).standard_normal(time_s.size)
    angle = np.minimum(linear_angle(time_s, pressure), LIMIT) + trembling
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})


@pytest.mark.parametrize(("share", "is_reached"), [(1.0, True), (0.8, True), (0.5, False)])
def test_a_limit_occurs_where_it_is_reached(share: float, is_reached: bool) -> None:
    """By hand: 80 % of the course reach 1.44 rad."""
    clipping = effect_of("sensor_clipping")
    problem = linear_problem([linear_log()])
    z = problem.unknowns(TRUTH)
    scale = scale_of(problem, z)
    extended = extend(problem, [clipping], scale)
    unknowns = start_unknowns(extended, problem, z, {"sensor_clipping_upper": LIMIT})
    final = replace(standing(extended, unknowns), effects=(clipping,))
    held_out = HeldOutLogs((held_out_log(share),))
    assert occurs(clipping, final, standing(problem, z), held_out, scale) is is_reached
