"""Refits to parts of logs, from where a model stands and from a guess."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.parts_of_logs import refitted, refitted_to_changed
from softid.errors import IdentificationError
from softid.log import Log


def standing_at(log: Log, values: Mapping[str, float]) -> Candidate:
    problem = linear_problem([log])
    return standing(problem, problem.unknowns({**TRUTH, **values}))


@pytest.mark.parametrize("values", [{}, {"N": 1e-9}, {"M": 40.0, "Q": 5.0}])
def test_a_part_is_fitted_wherever_the_model_stands(values: dict[str, float]) -> None:
    """Also where a term has vanished, or all of them are far off: the truth within 3 %."""
    log = linear_log(noise=0.001, samples=1500)
    part = log.with_masked(np.arange(1500) >= 750)
    found = refitted(standing_at(log, values), SIGMA, [part], 40)
    assert found.problem.n_samples == 750
    for name in ("N", "Q"):
        assert found.parameters[name] == pytest.approx(TRUTH[name], rel=0.03)
    left = found.squares * SIGMA["angle"] ** 2 / 750
    assert np.sqrt(left) == pytest.approx(0.001, rel=0.1)


def test_too_few_samples_are_refused() -> None:
    log = linear_log(noise=0.001)
    with pytest.raises(IdentificationError, match="3 samples cannot tell"):
        refitted(standing_at(log, {}), SIGMA, [log.with_masked(np.arange(1000) >= 3)], 40)


def test_a_model_follows_its_log_after_a_change() -> None:
    """Twice the angle asks for half of all forces, and a log of two parts for other unknowns."""
    log = linear_log(noise=0.0)
    known, angle = standing_at(log, {}), log.channels["angle"]
    twice = replace(angle, values=2.0 * angle.values)
    again = refitted_to_changed(
        known, SIGMA, [replace(log, channels={**log.channels, "angle": twice})], 40
    )
    assert again is not None
    for name in ("M", "N", "Q"):
        assert again.parameters[name] == pytest.approx(0.5 * TRUTH[name], rel=1e-3)
    assert refitted_to_changed(known, SIGMA, [log, linear_log(seed=1)], 40) is None
