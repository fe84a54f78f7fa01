"""Residual and motion at every sample."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.residual.motion import residual_context


def test_a_residual_is_nan_where_masked() -> None:
    """NaN at masked samples; within 1e-6 rad of zero elsewhere, for the log has no noise."""
    log = linear_log()
    masked = np.zeros(len(log), bool)
    masked[300:340] = True
    problem = linear_problem([log.with_masked(masked)])
    (part,) = residual_context(standing(problem, problem.unknowns(TRUTH)))
    assert np.array_equal(np.isnan(part.residual), masked)
    assert np.nanmax(np.abs(part.residual)) < 1e-6
    assert part.x == pytest.approx(log.channels["angle"].values, abs=1e-6)
    assert np.max(np.abs(np.gradient(part.x, part.time_s)[5:-5] - part.v[5:-5])) < 0.5
    assert np.array_equal(part.u, log.pressure_kpa)
