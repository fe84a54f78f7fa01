"""Residual and motion at every sample."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.residual.motion import heard, muted_samples, residual_context
from softid.effects import EFFECTS


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


def test_a_clipped_reading_is_muted_at_its_limit() -> None:
    """Closed form: noise of 0.01 rad is clipped with a reading within three deviations of 1 rad.

    A rest at the lower end looks like a limit, too. Without clipping in the model nothing does.
    """
    limit, log = 1.0, linear_log(noise=0.01)
    noisy = log.channels["angle"].values
    clipped = replace(log.channels["angle"], values=np.minimum(noisy, limit))
    base = linear_problem([replace(log, channels={**log.channels, "angle": clipped})], fixed=True)
    z = linear_problem([log], fixed=True).unknowns(TRUTH)
    clipping = EFFECTS["sensor_clipping"]()
    problem = extend(base, (clipping,), scale_of(base, z))
    at_limit = start_unknowns(problem, base, z, {"sensor_clipping_upper": limit})
    model = replace(standing(problem, at_limit), effects=(clipping,))
    (part,) = residual_context(model)
    (muted,) = muted_samples(model, [part])
    near = (part.x > limit - 0.03) | (part.x < 0.03)
    assert np.sum(muted != near) < 0.05 * muted.size
    assert 0.2 * muted.size < np.sum(muted) < 0.8 * muted.size
    assert np.nanstd(part.residual[~muted]) == pytest.approx(0.01, rel=0.1)
    (audible,) = heard(model, [part])
    assert np.array_equal(np.isnan(audible.residual), muted | np.isnan(part.residual))
    alone = standing(base, z)
    (none,) = muted_samples(alone, residual_context(alone))
    assert not none.any()
