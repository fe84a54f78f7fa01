"""Candidates that begin at start values of the base, where its fit is no place to begin."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import (
    RATE_HZ,
    SIGMA,
    TRUTH,
    Bow,
    linear_angle,
    linear_log,
    linear_problem,
    pressure_course,
    standing,
)

from softid.diagnosis.refit.candidates import Candidate, advance, prior_about
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search import racing
from softid.diagnosis.search.multistart import has_vanished, is_astray, multistart_candidates
from softid.effects import effect_of
from softid.effects.scale import Scale
from softid.log import Log

DRIFT, DEAD_ZONE = effect_of("sensor_drift"), effect_of("dead_zone")
THRESHOLD_KPA, SOFTNESS = 40.0, 0.1
ASTRAY = {name: 1e9 * value for name, value in TRUTH.items()}
"""Too stiff to move at all: no step along a slope leads back from there."""


def looked_at(problem_log: Log, values: dict[str, float]) -> tuple[Candidate, Scale]:
    """The base as it stands at some values, with the normal equations there."""
    problem = linear_problem([problem_log])
    z = problem.unknowns(values)
    placed = standing(problem, z)
    variance = placed.squares / max(problem.n_samples - problem.size, 1)
    prior = prior_about(problem, z, problem.free, variance)
    base = advance(Candidate((), problem, placed.minimum, prior), SIGMA, 1)
    assert base.parameters["M"] == pytest.approx(values["M"])
    return base, scale_of(problem, z)


def dead_zone_log() -> Log:
    """The linear actuator behind S(p) − S(−p), S(p) = w ln(1 + exp((p − p0)/w)), w = 0.1 p0."""
    time_s = np.arange(1000) / RATE_HZ
    pressure, w = pressure_course(time_s), SOFTNESS * THRESHOLD_KPA
    arriving = w * (
        np.logaddexp(0.0, (pressure - THRESHOLD_KPA) / w)
        - np.logaddexp(0.0, (-pressure - THRESHOLD_KPA) / w)
    )
    noise = 0.01 * np.random.default_rng(0).standard_normal(time_s.size)
    angle = linear_angle(time_s, arriving) + noise
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}, name="dead zone")


@pytest.mark.parametrize("samples", [1000, 250])
@pytest.mark.parametrize(("mass", "vanished"), [(TRUTH["M"], False), (1e-6, True)])
def test_a_term_that_changes_nothing_has_vanished(
    mass: float, vanished: bool, samples: int
) -> None:
    """A misfit of 0.2 rad rms. An inertia of 0.4 delays by 40 ms, one of 1e-6 by 0.1 µs.

    A factor of e in the first changes the angle by about 0.1 rad after every jump, which is more
    than 1e-3 of the misfit's power; in the second by nothing. A log of 250 samples is no different.
    """
    bent = 0.2 * np.sin(2.0 * np.pi * np.arange(samples) / (3.0 * RATE_HZ))
    base, _ = looked_at(linear_log(samples=samples, added=bent), TRUTH | {"M": mass})
    assert has_vanished(base) is vanished


@pytest.mark.parametrize(("factor", "astray"), [(1.0, False), (1e5, True)])
def test_a_base_far_from_all_starts_is_astray(factor: float, astray: bool) -> None:
    """The starts are near the truth, and 1e5 is more than e⁷ = 1100."""
    values = {name: factor * value for name, value in TRUTH.items()}
    base, _ = looked_at(linear_log(noise=0.01), values)
    assert is_astray(base) is astray


def test_the_hidden_effect_leads_from_elsewhere() -> None:
    """Known truth: a dead zone of 40 kPa, seen from a base that went far astray.

    From the start values the threshold comes back within 1 kPa and the noise of 0.01 is all that is
    left, 1000 within four times √2000. What is no cause stays behind, but moves again: the base
    leaves all of the motion. One candidate each, the best first.
    """
    base, scale = looked_at(dead_zone_log(), ASTRAY)
    found = multistart_candidates(base, [DRIFT, DEAD_ZONE, Bow()], scale, SIGMA)
    keys = [candidate.keys for candidate in found]
    assert keys[0] == ("dead_zone",)
    assert sorted(keys) == [("bow",), ("dead_zone",), ("sensor_drift",)]
    squares = [candidate.squares for candidate in found]
    assert squares == sorted(squares)
    assert found[0].parameters["dead_zone_p0"] == pytest.approx(THRESHOLD_KPA, abs=1.0)
    assert squares[0] == pytest.approx(1000.0, abs=180.0)
    assert squares[1] > 2.0 * squares[0]
    assert squares[-1] < 0.2 * base.squares


def test_so_many_are_handed_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """The best of them, whatever their number: here two of three."""
    monkeypatch.setattr(racing, "MULTISTART_SURVIVORS", 2)
    base, scale = looked_at(dead_zone_log(), ASTRAY)
    found = multistart_candidates(base, [DRIFT, DEAD_ZONE, Bow()], scale, SIGMA)
    assert len(found) == 2
    assert found[0].keys == ("dead_zone",)
